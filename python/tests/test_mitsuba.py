# SPDX-License-Identifier: Apache-2.0
import importlib.util
from pathlib import Path

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is not installed")


def test_the_example_denoises_a_real_rendering():
    path = Path(__file__).parents[2] / "examples/python/denoise_mitsuba.py"
    spec = importlib.util.spec_from_file_location("denoise_mitsuba", path)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    mi.set_variant("scalar_rgb")
    noisy, result = example.render_and_denoise(size=64, samples=16)
    assert noisy.shape == result.colour.shape == (64, 64, 3)
    description = mi.cornell_box()
    description["sensor"]["film"].update(width=64, height=64, rfilter={"type": "box"})
    reference = np.array(mi.render(mi.load_dict(description), spp=256))

    def relative_error(image):
        return float(np.mean((image - reference) ** 2 / (reference**2 + 0.01)))

    assert relative_error(result.colour) < 0.5 * relative_error(noisy)
