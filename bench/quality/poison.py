#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What one poisoned pixel does to the rest of an image: a pixel that holds NaN, infinity, a negative variance or 1e38.

    poison.py FOLDER [FOLDER...]       each with s<samples>.exr in stein's names and ref.exr
    poison.py FOLDER -- --quality fast

For each render: places (the middle, the brightest pixel, the one with the largest variance) by values. Prints by how much the
relative MSE changes of all pixels but the poisoned one, and of those beyond --halo; and by how much the mean of the estimated
error of these does, in percent of the true one. Needs numpy and OpenEXR (pip). Options after -- go to `stein denoise`.
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

NO_COLOUR = (("G", np.nan), ("R", np.inf), ("variance.B", -1.0), ("B", 1e38))  # all the same to stein
FEATURES = (("albedo.G", np.nan), ("albedo.G", 1e38), ("depth.Z", np.inf), ("depth.Z", 1e38))
WEIGHT_FLOOR = 0.01


def channels_of(path):
    return {name: c.pixels for name, c in OpenEXR.File(str(path), separate_channels=True).channels().items()}


def image_of(path):
    channels = channels_of(path)
    return np.stack([channels[c] for c in "RGB"]).astype(np.float64)


def write(path, channels):  # copies: OpenEXR puts its own objects into what it is given
    header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, dict(channels)).write(str(path))


def denoise(args, noisy, folder):
    """R, G, B and the mean of the estimated errors."""
    out = folder / "clean.exr"
    command = [args.stein, "denoise", noisy, "-o", out, "--quiet", *args.options]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr}")
    planes = channels_of(out)
    error = np.mean([planes[f"error.{c}"] for c in "RGB"], axis=0, dtype=np.float64)
    return np.stack([*(planes[c] for c in "RGB"), error]).astype(np.float64)


def places_of(channels):
    light = channels["R"] + channels["G"] + channels["B"]
    noise = sum(channels[f"variance.{c}"].astype(np.float64) for c in "RGB")
    height, width = light.shape
    at = lambda plane: tuple(int(i) for i in np.unravel_index(np.argmax(plane), plane.shape))  # noqa: E731
    return {"middle": (height // 2, width // 2), "brightest": at(light), "noisiest": at(noise)}


def kept(shape, place, radius):
    y, x = np.indices(shape)
    return np.maximum(abs(y - place[0]), abs(x - place[1])) > radius


def study(args, noisy, reference, folder):
    channels = channels_of(noisy)
    weight = 1 / (reference**2 + WEIGHT_FLOOR)
    squares = lambda planes: np.mean(weight * (planes[:3] - reference) ** 2, axis=0)  # noqa: E731
    poisoned = folder / "poisoned.exr"
    write(poisoned, channels)
    sound = denoise(args, poisoned, folder)
    before = squares(sound)
    for where, place in places_of(channels).items():
        done = {}
        for name, value in (NO_COLOUR if where == "middle" else NO_COLOUR[:1]) + FEATURES:
            changed = dict(channels)
            changed[name] = channels[name].astype(np.float32)
            changed[name][place] = value
            write(poisoned, changed)
            planes = denoise(args, poisoned, folder)
            after = squares(planes)
            estimate = np.mean(weight, axis=0) * (planes[3] - sound[3])
            cells = []
            for radius in (0, args.halo):
                rest = kept(before.shape, place, radius)
                cells += [100 * part[rest].sum() / before[rest].sum() for part in (after - before, estimate)]
            text = " | ".join(f"{cell:+.4f} %" for cell in cells)
            same = next((n for n, other in done.items() if np.array_equal(other, planes)), None)
            done.setdefault(f"{name} = {value:g}", planes)
            print(f"| {noisy.parent.name} {noisy.stem[1:]} | {where} {place[::-1]} | {name} = {value:g} | "
                  + (f"as {same} | | | |" if same else text + " |"), flush=True)  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--stein", default="build/ci/examples/cli/stein")
    parser.add_argument("--halo", type=int, default=64, help="pixels on each side that the second figure leaves out")
    parser.add_argument("--samples", default=r"\d+", help="of the renders to take, as a regular expression")
    parser.add_argument("options", nargs="*")
    args = parser.parse_args()
    print("| render | pixel (x, y) | holds | relMSE of the rest | its estimate | relMSE beyond the halo | its estimate |")
    print("|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for source in args.folders:
            reference = image_of(source / "ref.exr")
            for noisy in sorted(source.glob("s*.exr")):
                if re.fullmatch("s" + args.samples, noisy.stem):
                    study(args, noisy, reference, Path(folder))


if __name__ == "__main__":
    main()
