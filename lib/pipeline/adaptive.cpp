// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "stein/adaptive.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/parameter_check.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

void check(const AdaptiveParams& params, int width, int height) {
  constexpr float kMaxSide = 1 << 20;
  require_in_range("width", static_cast<float>(width), 1.0F, kMaxSide, "px");
  require_in_range("height", static_cast<float>(height), 1.0F, kMaxSide, "px");
  require_in_range("initial_samples", static_cast<float>(params.initial_samples), 2.0F, 65536.0F);
  require_in_range("iterations", static_cast<float>(params.iterations), 1.0F, 1000.0F);
  require_not_negative("target_error", static_cast<float>(params.target_error));
  check(params.intermediate);
  check(params.denoise);
  for (const ExternalCandidate& candidate : params.denoise.candidates) {
    if (!std::holds_alternative<ExternalImages>(candidate.source)) continue;
    throw Error(ErrorCode::kInvalidArgument, "the candidate '" + candidate.name +
                                                 "' has images of a frame that is still to be rendered; give it as a "
                                                 "function (ExternalDenoiser)");
  }
  const std::int64_t first = std::int64_t{width} * height * params.initial_samples;
  if (params.budget < first) {
    throw Error(ErrorCode::kInvalidArgument, "the budget is " + std::to_string(params.budget) +
                                                 " samples, and the first batch alone takes " + std::to_string(first) +
                                                 ": raise the budget or lower initial_samples");
  }
}

void check_frame(const Frame& frame, int width, int height) {
  if (frame.width != width || frame.height != height) {
    throw Error(ErrorCode::kInvalidFrame, "the renderer returned a frame of " + std::to_string(frame.width) + "x" +
                                              std::to_string(frame.height) + " pixels, the loop is for " +
                                              std::to_string(width) + "x" + std::to_string(height));
  }
  if (!frame.sample_count) {
    throw Error(ErrorCode::kInvalidFrame,
                "the renderer returned a frame without sample_count: set the plane of samples per pixel");
  }
}

// The filter runs of the loop as one progress, each an equal part of it.
class LoopProgress {
 public:
  LoopProgress(std::function<bool(double)> progress, int runs) : progress_(std::move(progress)), runs_(runs) {}

  // For the next run; the last one ends at 1 also where runs were saved.
  std::function<bool(double)> next(bool is_last) {
    if (!progress_) return {};
    const double begin = static_cast<double>(done_++) / runs_;
    const double end = is_last ? 1.0 : static_cast<double>(done_) / runs_;
    return [this, begin, end](double fraction) { return progress_(begin + (end - begin) * fraction); };
  }

 private:
  std::function<bool(double)> progress_;
  int runs_;
  int done_ = 0;
};

}  // namespace

AdaptiveResult denoise_adaptively(int width, int height, const RenderSamples& render, const AdaptiveParams& params) {
  check(params, width, height);
  const std::int64_t pixels = std::int64_t{width} * height;
  DenoiseParams intermediate = params.denoise;
  intermediate.filters = {params.intermediate};
  intermediate.candidates.clear();
  intermediate.second_pass = false;
  intermediate.density.rule = params.density;
  const bool is_of_all = params.density == DensityRule::kAllSamples;
  LoopProgress progress(params.denoise.execution.progress, params.iterations + 1);

  AdaptiveResult out;
  std::int64_t batch = pixels * params.initial_samples;
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(pixels), params.initial_samples);
  for (int batches_left = params.iterations;; --batches_left) {
    const Frame frame = render(counts);
    check_frame(frame, width, height);
    out.samples += batch;
    const std::int64_t left = params.budget - out.samples;
    if (left > 0) {
      intermediate.execution.progress = progress.next(false);
      const DenoiseResult guess = denoise(frame, intermediate);
      const double error = guess.report.mean_relative_error;
      out.steps.push_back({out.samples, error});
      if (params.target_error == 0 || error > params.target_error) {
        batch = std::max(left / batches_left, std::int64_t{1});
        counts = allocate_samples(guess.density.view(), {.budget = batch},
                                  is_of_all ? frame.sample_count : ConstPlaneView{});
        continue;
      }
    }
    DenoiseParams last = params.denoise;
    last.execution.progress = progress.next(true);
    out.result = denoise(frame, last);
    return out;
  }
}

}  // namespace stein
