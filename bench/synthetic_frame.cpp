// SPDX-License-Identifier: Apache-2.0
#include "synthetic_frame.hpp"

#include <string>
#include <utility>

namespace stein::bench {

BenchFrame::BenchFrame(int width, int height, bool has_covariances) {
  frame_.width = width;
  frame_.height = height;
  frame_.uniform_sample_count = 8;
  planes_.reserve(64);
  for (std::size_t c = 0; c < 3; ++c) {
    frame_.colour[c] = add(0.0F, 4.0F);
    frame_.colour_variance[c] = add(0.0F, 0.2F);
  }
  const std::vector<std::pair<const char*, int>> features = {{"normal", 3}, {"albedo", 3}, {"depth", 1}};
  for (const auto& [name, channels] : features) {
    Feature feature;
    feature.name = name;
    for (int k = 0; k < channels; ++k) {
      feature.mean.push_back(add(0.0F, 0.3F));
      feature.variance.push_back(add(0.0F, 1e-4F));  // much less than the mean varies: all directions count
    }
    frame_.features.push_back(std::move(feature));
  }
  if (!has_covariances) return;
  for (ConstPlaneView& plane : frame_.colour_covariance) plane = add(0.0F, 0.1F);
  for (Feature& feature : frame_.features) {
    for (std::size_t k = 0; k < 3 * feature.mean.size(); ++k) feature.colour_covariance.push_back(add(0.0F, 0.02F));
  }
}

void BenchFrame::add_layers(int count) {
  for (int l = 0; l < count; ++l) {
    Layer layer{"layer" + std::to_string(l), {}};
    for (int c = 0; c < 3; ++c) layer.mean.push_back(add(0.0F, 1.0F));
    frame_.layers.push_back(std::move(layer));
  }
}

ConstPlaneView BenchFrame::add(float low, float high) {
  Plane plane(frame_.width, frame_.height);
  for (int y = 0; y < frame_.height; ++y) {
    for (int x = 0; x < frame_.width; ++x) {
      state_ = state_ * 1664525U + 1013904223U;
      plane.row(y)[x] = low + (high - low) * static_cast<float>(state_ >> 8) * 0x1p-24F;
    }
  }
  planes_.push_back(std::move(plane));
  const Plane& stored = planes_.back();
  return stored.view();
}

}  // namespace stein::bench
