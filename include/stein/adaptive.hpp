// SPDX-License-Identifier: Apache-2.0
//
// The loop of adaptive sampling (SBF sec. 4.3, AOS sec. 5): render a few samples everywhere, estimate the error that is
// left, render more where it pays, until the budget is spent. How it works, with pictures: docs/adaptive.md.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "stein/denoise.hpp"
#include "stein/filters.hpp"
#include "stein/frame.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// Renders counts[y * width + x] further samples of every pixel and returns the image with all samples so far; it must
/// say the samples of every pixel in `sample_count`. The frame's planes must stay as they are until the next call, or,
/// after the last one, until the loop returns.
using RenderSamples = std::function<Frame(const std::vector<std::uint32_t>& counts)>;

/// What is known after a batch of samples.
struct AdaptiveStep {
  std::int64_t samples = 0;        ///< asked for so far
  double mean_relative_error = 0;  ///< estimated, see DenoiseReport; with the intermediate filter
};

struct AdaptiveParams {
  std::int64_t budget = 0;            ///< samples of the whole image; asked for exactly, unless target_error is met
  std::uint32_t initial_samples = 4;  ///< of every pixel, in the first batch; [2..65536]
  int iterations = 3;                 ///< batches after the first, of equal size; [1..1000]
  /// Stop once the estimated mean relative error is at most this; 0: never. The estimate comes out low in this loop, by
  /// up to a quarter: pixels whose variance came out low get fewer samples to correct it.
  double target_error = 0;
  FilterSpec intermediate = intermediate_cross_bilateral();  ///< what the batches are planned with
  /// What the batches follow. kAllSamples: a batch fills up to it; the others: a batch is proportional to it.
  DensityRule density = DensityRule::kAllSamples;
  DenoiseParams denoise;  ///< of the result; the intermediate runs are of one filter, once, and with another density
};

struct AdaptiveResult {
  DenoiseResult result;             ///< of the last frame
  std::vector<AdaptiveStep> steps;  ///< one for each batch, but for the one that spent the budget
  std::int64_t samples = 0;         ///< asked for in all
};

/// The loop. `denoise.execution.progress` sees the filter's part of the work; the renderer's calls come in between,
/// from the calling thread.
/// @throws Error kInvalidArgument (parameters, sides outside [1..2^20], or a budget below the first batch),
/// kInvalidFrame (a frame of another size, or without sample counts), what `denoise` throws, and whatever `render`
/// throws.
[[nodiscard]] AdaptiveResult denoise_adaptively(int width, int height, const RenderSamples& render,
                                                const AdaptiveParams& params);

}  // namespace stein
#pragma GCC visibility pop
