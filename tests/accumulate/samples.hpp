// SPDX-License-Identifier: Apache-2.0
//
// Samples whose colour and features move together, and their moments in two passes.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "stein/accumulate.hpp"
#include "support/synthetic.hpp"

namespace stein::test {

constexpr std::size_t kChannels = 7;
using Sample = std::array<float, kChannels>;  // R, G, B, albedo.R, G, B, depth.Z

inline SampleLayout usual_layout() { return {.features = {{"albedo", 3}, {"depth", 1}}}; }

/// Of a pixel that sees a lamp with probability `lamp`, and a textured wall otherwise.
inline Sample draw_sample(Random& random, double lamp) {
  const bool sees_lamp = random.uniform() < lamp;
  const double light = -std::log(1 - random.uniform());
  const double texture = random.uniform();
  const auto f = [](double v) { return static_cast<float>(v); };
  if (sees_lamp) return {f(6 + light), f(5 + light), f(2 + light), 0, 0, 0, f(3 + 0.1 * texture)};
  return {f(light * texture), f(0.7 * light * texture), f(0.5 * light), f(texture), f(0.7 * texture), 0.5F,
          f(8 + texture)};
}

inline double at(const ConstPlaneView& plane, int x = 0, int y = 0) { return static_cast<double>(plane.at(x, y)); }

/// The planes of one pixel: means, then variances, then covariances as in SampleLayout::pairs().
inline std::vector<double> pixel_of(const Frame& frame, int x = 0, int y = 0) {
  std::vector<double> values;
  for (const auto& plane : frame.colour) values.push_back(at(plane, x, y));
  for (const Feature& f : frame.features) {
    for (const auto& plane : f.mean) values.push_back(at(plane, x, y));
  }
  for (const auto& plane : frame.colour_variance) values.push_back(at(plane, x, y));
  for (const Feature& f : frame.features) {
    for (const auto& plane : f.variance) values.push_back(at(plane, x, y));
  }
  for (const auto& plane : frame.colour_covariance) values.push_back(at(plane, x, y));
  for (std::size_t c = 0; c < 3; ++c) {
    for (const Feature& f : frame.features) {
      for (std::size_t k = 0; k < f.mean.size(); ++k)
        values.push_back(at(f.colour_covariance[c * f.mean.size() + k], x, y));
    }
  }
  return values;
}

/// The channels whose moment stands at kChannels + i of `pixel_of`.
inline std::vector<std::array<std::size_t, 2>> moment_channels() {
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t k = 0; k < kChannels; ++k) pairs.push_back({k, k});
  pairs.insert(pairs.end(), {{0, 1}, {0, 2}, {1, 2}});
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 3; k < kChannels; ++k) pairs.push_back({c, k});
  }
  return pairs;
}

}  // namespace stein::test
