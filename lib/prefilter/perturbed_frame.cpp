// SPDX-License-Identifier: Apache-2.0
#include "prefilter/perturbed_frame.hpp"

#include <cstddef>

#include "core/parameter_check.hpp"
#include "core/validity.hpp"

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

Frame perturbed_frame(const Source& source, const Perturbation& perturbation, exec::Runner& runner,
                      std::vector<Plane>& planes) {
  Frame frame = source.frame();
  const Source along = source.perturbed(perturbation);
  const auto move = [&](ConstPlaneView& view, const auto& direction_row) {
    planes.push_back(moved(view, perturbation.step, source.memory(), runner, direction_row));
    view = planes.back().view();
  };
  for (std::size_t c = 0; c < 3; ++c)
    move(frame.colour[c], [&](int y, float* b) { along.direction_row(c, y, 0, frame.width, b); });
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    if (frame.features[f].colour_covariance.empty()) continue;
    const float unit = 1.0F / along.feature_scale(f);
    for (std::size_t k = 0; k < frame.features[f].mean.size(); ++k) {
      move(frame.features[f].mean[k],
           [&](int y, float* b) { along.feature_direction_row(f, k, unit, y, 0, frame.width, b); });
    }
  }
  return frame;
}

PerturbedFrame::PerturbedFrame(const Frame& frame, const Perturbation& perturbation, const Execution& execution) {
  check(perturbation);
  check(frame);
  exec::Runner runner(execution);
  const FrameReport report = inspect(frame, runner, 0.0);
  moved_ = perturbed_frame(Source(frame, report, execution.memory.get()), perturbation, runner, planes_);
}

}  // namespace stein
