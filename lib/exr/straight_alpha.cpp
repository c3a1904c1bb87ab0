// SPDX-License-Identifier: Apache-2.0
#include "exr/straight_alpha.hpp"

#include <utility>

namespace stein::exr {
namespace {

/// `power`: 1 or 2.
float factor(float alpha, int power) { return power == 2 ? alpha * alpha : alpha; }

ConstPlaneView multiplied(const ConstPlaneView& plane, const ConstPlaneView& alpha, int power, Memory* memory,
                          std::vector<Plane>& planes_made) {
  if (!plane) return plane;
  Plane& out = planes_made.emplace_back(plane.width(), plane.height(), memory);
  std::vector<float> alphas(static_cast<std::size_t>(plane.width()));
  for (int y = 0; y < plane.height(); ++y) {
    if (memory != nullptr) memory->trim();
    alpha.read_row(y, 0, plane.width(), alphas.data());
    plane.read_row(y, 0, plane.width(), out.row(y));
    for (int x = 0; x < plane.width(); ++x) out.row(y)[x] *= factor(alphas[static_cast<std::size_t>(x)], power);
  }
  return std::as_const(out).view();
}

}  // namespace

void premultiply(const ConstPlaneView& alpha, Frame& frame, Memory* memory, std::vector<Plane>& planes_made) {
  const auto multiply = [&](auto& planes, int power) {
    for (ConstPlaneView& plane : planes) plane = multiplied(plane, alpha, power, memory, planes_made);
  };
  multiply(frame.colour, 1);
  multiply(frame.colour_variance, 2);
  multiply(frame.colour_covariance, 2);
  for (Feature& feature : frame.features) multiply(feature.colour_covariance, 1);
  for (Layer& layer : frame.layers) {
    if (layer.mean.size() == 3) multiply(layer.mean, 1);
  }
}

Straight::Straight(const DenoiseResult& result, const std::string& alpha, Memory* memory) : memory_(memory) {
  for (const FilteredLayer& layer : result.layers) {
    if (!alpha.empty() && layer.name == alpha) alpha_ = &layer.mean.front();
  }
}

ConstPlaneView Straight::divided(const Plane& plane, int power) {
  if (alpha_ == nullptr) return plane.view();
  Plane& out = planes_made_.emplace_back(plane.width(), plane.height(), memory_);
  for (int y = 0; y < plane.height(); ++y) {
    if (memory_ != nullptr) memory_->trim();
    for (int x = 0; x < plane.width(); ++x) {
      const float divisor = factor(alpha_->row(y)[x], power);
      out.row(y)[x] = divisor > 0.0F ? plane.row(y)[x] / divisor : 0.0F;
    }
  }
  return std::as_const(out).view();
}

}  // namespace stein::exr
