# SPDX-License-Identifier: Apache-2.0
"""Denoising of Monte Carlo renderings with an error estimate per pixel.

    result = stein.denoise(colour, variance, features={"albedo": (albedo, albedo_variance)}, samples=16)
    result.colour, result.error, result.density, result.report["warnings"]
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from . import _stein
from ._errors import Cancelled, Error, ErrorCode, FileError, InvalidArgument, InvalidFrame, Unsupported
from ._stein import Frame, Result, filter_names
from ._stein import version as __version__
from ._types import Candidate, FeaturePlanes, Options, Planes, Report

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from typing_extensions import Unpack

if TYPE_CHECKING or hasattr(_stein, "read"):  # not in a build without OpenEXR
    from ._stein import read, write, write_frame

__all__ = [
    "Cancelled", "Error", "ErrorCode", "FileError", "Frame", "InvalidArgument", "InvalidFrame", "Options", "Report",
    "Result", "Unsupported", "__version__", "denoise", "filter_names", "read", "write",
    "write_frame",
]  # fmt: skip


def denoise(
    colour: Frame | Planes,
    variance: Planes | None = None,
    *,
    features: Mapping[str, FeaturePlanes] | None = None,
    covariance: Planes | None = None,
    samples: float | NDArray[Any] | None = None,
    degrees_of_freedom: float = 0,
    filter: str = "auto",
    feature_sigmas: Mapping[str, float] | None = None,
    candidates: Mapping[str, Candidate] | None = None,
    progress: Callable[[float], bool | None] | None = None,
    **options: Unpack[Options],
) -> Result:
    """Removes the noise of an image, and says how large the error is that remains in every pixel.

    colour: a Frame, or the arrays to make one of; the arguments up to degrees_of_freedom are then those of Frame.
    filter: "auto", or one or more of filter_names() with commas between, which are mixed.
    feature_sigmas: how strongly features guide, by name; smaller is stronger, 0: not at all.
    candidates: other denoisers, by name, that are mixed with the filters where they are better: a function that takes a
    Frame and returns an array of height x width x 3, or (function, draws). It is called for the frame, and for `draws`
    perturbed ones (1), by which its error is told.
    progress: called with the fraction done, from any thread; cancels by returning False or by raising.
    options: further parameters, see Options; each filter has some of its own.

    Other threads of Python run meanwhile. The arrays must stay as they are.
    """
    if isinstance(colour, Frame):
        of_frame = (variance, features, covariance, samples)
        if degrees_of_freedom or any(value is not None for value in of_frame):
            raise InvalidArgument("a Frame has its variance, features, covariance, samples and degrees of freedom already")
        frame = colour
    else:
        frame = Frame(colour, variance, features=dict(features or {}), covariance=covariance, samples=samples,
                      degrees_of_freedom=degrees_of_freedom)  # fmt: skip
    return _stein.denoise(frame, filter, dict(feature_sigmas or {}), dict(options), dict(candidates or {}), progress)
