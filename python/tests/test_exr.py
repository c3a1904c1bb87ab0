# SPDX-License-Identifier: Apache-2.0

import numpy as np
import pytest
from scene import Scene

import stein

pytestmark = pytest.mark.skipif(not hasattr(stein, "read"), reason="built without OpenEXR")


def test_results_are_written_and_read(tmp_path):
    result = stein.denoise(**Scene().arguments())
    path = tmp_path / "clean.exr"
    stein.write(path, result, choice=False)
    with pytest.raises(stein.InvalidFrame):  # there is nothing in it that says how noisy it is
        stein.read(path)
    with pytest.raises(stein.InvalidFrame, match="clean.exr"):
        stein.read(path, samples=16)


def test_frames_of_files(tmp_path):
    result = stein.denoise(**Scene().arguments())
    noisy = tmp_path / "noisy.exr"
    # The written error serves as variance here: what is read is a frame like any other.
    frame = stein.Frame(result.colour, np.abs(result.error) + 1e-6, samples=8)
    stein.write_frame(noisy, frame)
    read = stein.read(noisy)
    for name, plane in frame.planes.items():
        assert np.array_equal(read.planes[name], plane), name
    expected = stein.denoise(frame)
    again = stein.denoise(read)
    assert np.array_equal(again.colour, expected.colour)
    clean = tmp_path / "clean.exr"
    stein.write(str(clean), again, read, inputs=True, error=False)
    kept = stein.read(clean)
    assert np.array_equal(kept.planes["R"], again.colour[..., 0])
    assert np.array_equal(kept.planes["variance.R"], read.planes["variance.R"])


def test_channels_of_other_names(tmp_path):
    scene = Scene()
    frame = stein.Frame(**scene.arguments())
    path = tmp_path / "noisy.exr"
    stein.write_frame(path, frame)
    assert any("normal" in note for note in stein.read(path).notes)
    colour = ["albedo.R", "albedo.G", "albedo.B"]
    variance = ["albedo.variance.R", "albedo.variance.G", "albedo.variance.B"]
    mapped = stein.read(path, maps={"colour": (colour, variance)}, variance_of="sample")
    assert np.array_equal(mapped.planes["R"], scene.albedo[..., 0])
    assert np.allclose(mapped.planes["variance.G"], scene.albedo_variance[..., 1] / 8)
    with pytest.raises(stein.InvalidArgument, match="'nobody'"):
        stein.read(path, preset="nobody")
    with pytest.raises(stein.InvalidArgument, match="map of 'colour'"):
        stein.read(path, maps={"colour": 3})
    with pytest.raises(stein.InvalidArgument, match="variance_of"):
        stein.read(path, variance_of="all")


def test_errors_of_files(tmp_path):
    with pytest.raises(stein.FileError, match="missing.exr") as missing:
        stein.read(tmp_path / "missing.exr")
    assert isinstance(missing.value, OSError) and missing.value.code == stein.ErrorCode.IO
    result = stein.denoise(**Scene().arguments())
    with pytest.raises(stein.FileError):
        stein.write(tmp_path / "no folder" / "clean.exr", result)
    with pytest.raises(stein.InvalidArgument, match="stein.read"):
        stein.write(tmp_path / "clean.exr", result, half=True)
    assert not list(tmp_path.iterdir())
