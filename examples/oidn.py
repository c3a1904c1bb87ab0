#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Open Image Denoise on a file in stein's names, as a candidate for stein denoise (docs/candidates.md).

    pip install numpy OpenEXR pyoidn
    oidn.py IN.exr OUT.exr
"""

import sys

import numpy as np
import OpenEXR
import pyoidn

LAYERS = {"color": ["R", "G", "B"], "albedo": [f"albedo.{c}" for c in "RGB"], "normal": [f"normal.{c}" for c in "XYZ"]}


def open_device(threads=0):
    device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)
    device.set_int("numThreads", threads)
    device.set_bool("setAffinity", False)
    device.commit()
    return device


def run_oidn(device, source, target):
    """Colour, noisy albedo and noisy normal in; writes R, G, B."""
    channels = OpenEXR.File(str(source), separate_channels=True).channels()
    images = {
        name: np.ascontiguousarray(np.stack([channels[c].pixels.astype(np.float32) for c in names], -1))
        for name, names in LAYERS.items()
        if all(c in channels for c in names)
    }
    out = np.empty_like(images["color"])
    oidn = pyoidn.Filter(device, "RT")
    for name, image in images.items():
        oidn.set_image(name, image, pyoidn.OIDN_FORMAT_FLOAT3)
    oidn.set_image("output", out, pyoidn.OIDN_FORMAT_FLOAT3)
    oidn.set_bool("hdr", True)
    oidn.commit()
    oidn.execute()
    error = device.get_error()
    if error is not None:
        raise RuntimeError(error)
    oidn.release()
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": out}).write(str(target))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    run_oidn(open_device(), sys.argv[1], sys.argv[2])
