#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders the Cornell box with Mitsuba 3 (`pip install mitsuba`), denoises it, and leaves noisy.png and denoised.png."""

import mitsuba as mi
import numpy as np

import stein


def render_and_denoise(size: int, samples: int) -> tuple[np.ndarray, stein.Result]:
    description = mi.cornell_box()
    # A box filter: others spread samples over neighbours, so that noise is no longer a matter of single pixels.
    description["sensor"]["film"].update(width=size, height=size, rfilter={"type": "box"})
    features = {"type": "aov", "aovs": "albedo:albedo,normal:sh_normal,depth:depth", "image": {"type": "path", "max_depth": 8}}
    description["integrator"] = {"type": "moment", "of": features}  # the mean of everything, and the mean of its squares
    scene = mi.load_dict(description)
    image = np.array(mi.render(scene, spp=samples))
    names = ["R", "G", "B"] + scene.integrator().aov_names()

    def mean_and_variance(layer: str) -> tuple[np.ndarray, np.ndarray]:
        mean, squares = (
            np.stack([image[..., i] for i, name in enumerate(names) if name[:-2] == prefix + layer and name[-1] != "A"], 2)
            for prefix in ("of.", "m2_of.")
        )
        return mean, np.maximum(squares - mean**2, 0) / (samples - 1)

    colour, variance = mean_and_variance("image")
    guides = {layer: mean_and_variance(layer) for layer in ("albedo", "normal", "depth")}
    return colour, stein.denoise(colour, variance, features=guides, samples=samples)


if __name__ == "__main__":
    mi.set_variant("scalar_rgb")
    noisy, result = render_and_denoise(size=256, samples=16)
    mi.util.write_bitmap("noisy.png", noisy)
    mi.util.write_bitmap("denoised.png", np.ascontiguousarray(result.colour))
    print(f"error that remains (root mean square, estimated): {np.sqrt(np.mean(result.error)):.4f}")
    for warning in result.report["warnings"]:
        print("warning:", warning)
