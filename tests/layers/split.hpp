// SPDX-License-Identifier: Apache-2.0
//
// A noisy frame whose colour is split into layers.
#pragma once

#include <array>
#include <deque>
#include <string>
#include <vector>

#include "stein/denoise.hpp"
#include "support/synthetic.hpp"

namespace stein::test {

/// Adds layers, whose planes it owns, to a frame of fill_random().
class SplitFrame {
 public:
  SplitFrame(int width, int height, std::uint64_t seed);

  [[nodiscard]] Frame& frame() { return owned_.frame(); }
  [[nodiscard]] OwnedFrame& owned() { return owned_; }

  /// Three layers, random parts of each pixel's colour, one of them negative in places: "key", "fill" and "rim".
  void add_parts(std::uint64_t seed);
  /// A layer with the colour itself.
  void add_copy(const std::string& name);
  /// A layer of one channel, that is `value` everywhere.
  void add_constant(const std::string& name, float value);

  /// A channel of a layer.
  [[nodiscard]] Plane& plane(const std::string& layer, std::size_t channel);

 private:
  void add(const std::string& name, std::size_t channels);

  OwnedFrame owned_;
  std::deque<Plane> planes_;  // of the layers, in their order
};

/// Largest |sum of the three parts - colour|, over the larger of |colour| and the parts' sizes but at least 0.1; parts
/// are the layers from `first` on.
[[nodiscard]] double error_of_sum(const DenoiseResult& result, std::size_t first = 0);

/// Filters of the list and variants that take other ways through the kernels, in small windows.
[[nodiscard]] std::vector<std::vector<FilterSpec>> layer_filters();

}  // namespace stein::test
