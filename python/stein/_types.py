# SPDX-License-Identifier: Apache-2.0
"""Types of arguments and results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypedDict, Union

from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._stein import Frame  # noqa: F401, by name in an alias

# An array of height x width x channels or height x width, or a list of these.
Planes = Union[NDArray[Any], list[NDArray[Any]]]
# The mean; or with its variance; or with its covariance with the colour as well.
FeaturePlanes = Union[Planes, tuple[Planes], tuple[Planes, Union[Planes, None]], tuple[Planes, Union[Planes, None], Planes]]

# Another denoiser; or with the number of perturbed frames that it is run on.
Denoiser = Callable[["Frame"], Planes]
Candidate = Union[Denoiser, tuple[Denoiser, int]]

# The names of the channels of the mean, or those and of the variance.
Channels = Union[list[str], tuple[list[str], list[str]]]


class Options(TypedDict, total=False):
    """By name, as on the command line and in include/stein/options.hpp, which say what they mean; left out, each is as there."""

    quality: Literal["fast", "default", "best"]
    risk: Literal["auto", "sure", "joint", "monte-carlo"]
    draws: int
    seed: int
    selection: Literal["evidence", "argmin"]
    density_rule: Literal["next-samples", "all-samples", "error-reduction"]
    strength: float
    outliers: bool
    second_pass: bool
    strict: bool
    threads: int
    tile_width: int
    tile_height: int
    max_memory: int
    scratch: str
    # Of the filters that have them:
    bank: Literal["final", "intermediate"]
    spatial_sigmas: Sequence[float]
    range_sigmas: Sequence[float]
    distance: Literal["absolute", "variance-normalised"]
    order: Literal["0", "1", "3", "adaptive"]
    order_error: Literal["risk", "taylor"]
    other_feature_sigma: float
    min_feature_variance: float
    feature_smoothing: int
    range_sigma: float
    spatial_sigma: float
    window_radius: int
    patch_radius: int
    patch_blur: float
    noise_threshold: float
    ridge: float
    curvature_ridge: float
    levels: int
    value_sigma: float
    fixed_weight: float
    noise_margin: float
    weight_steps: int
    plain: bool


class FilterShare(TypedDict):
    """The part of a filter, or of a candidate, in the mixture; its error alone, None where the strength is not 1."""

    name: str
    weight: float
    mean_relative_error: float | None
    risk: str
    risk_reason: str


class Report(TypedDict):
    """How it went, as in include/stein/denoise.hpp."""

    filter: str
    filters: list[FilterShare]
    candidates: list[str]
    choice_share: dict[str, float]
    mean_error: list[float]
    mean_relative_error: float
    invalid_pixels: int
    single_sample_pixels: int
    bad_feature_pixels: dict[str, int]
    outlier_pixels: int
    outlier_energy: float
    scratch_bytes: int
    warnings: list[str]
    seconds: dict[str, float]
    instruction_set: str
