// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>

#include "core/parameter_check.hpp"
#include "core/validity.hpp"
#include "exec/runner.hpp"
#include "prefilter/source.hpp"
#include "stein/candidate.hpp"

namespace stein {
namespace {

constexpr float kMostDraws = 1 << 20;

// A plane of the frame, and the direction that it is moved along: direction_row(y, out).
template <class DirectionRow>
Plane moved(const ConstPlaneView& plane, float step, Memory* memory, exec::Runner& runner,
            const DirectionRow& direction_row) {
  Plane out(plane.width(), plane.height(), memory);
  std::vector<std::vector<float>> rows(static_cast<std::size_t>(runner.slots()),
                                       std::vector<float>(static_cast<std::size_t>(plane.width())));
  runner.for_each(plane.height(), 0.0, [&](int y, int slot) {
    float* b = rows[static_cast<std::size_t>(slot)].data();
    float* value = out.row(y);
    plane.read_row(y, 0, plane.width(), value);
    direction_row(y, b);
    for (int x = 0; x < plane.width(); ++x) value[x] += step * b[x];
  });
  return out;
}

}  // namespace

void check(const Perturbation& perturbation) {
  require_in_range("the draw of a perturbation", static_cast<float>(perturbation.draw), 0.0F, kMostDraws);
  require_in_range("the step of a perturbation", perturbation.step, 1e-3F, 1.0F, "standard deviations");
}

PerturbedFrame::PerturbedFrame(const Frame& frame, const Perturbation& perturbation, const Execution& execution)
    : moved_(frame) {
  check(perturbation);
  check(frame);
  exec::Runner runner(execution);
  const FrameReport report = inspect(frame, runner, 0.0);
  Memory* const memory = execution.memory.get();
  const Source source = Source(frame, report, memory).perturbed(perturbation);
  for (std::size_t c = 0; c < 3; ++c) {
    planes_.push_back(moved(frame.colour[c], perturbation.step, memory, runner,
                            [&](int y, float* b) { source.direction_row(c, y, 0, frame.width, b); }));
    moved_.colour[c] = planes_.back().view();
  }
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    if (frame.features[f].colour_covariance.empty()) continue;
    const float unit = 1.0F / source.feature_scale(f);
    for (std::size_t k = 0; k < frame.features[f].mean.size(); ++k) {
      planes_.push_back(moved(frame.features[f].mean[k], perturbation.step, memory, runner, [&](int y, float* b) {
        source.feature_direction_row(f, k, unit, y, 0, frame.width, b);
      }));
      moved_.features[f].mean[k] = planes_.back().view();
    }
  }
}

}  // namespace stein
