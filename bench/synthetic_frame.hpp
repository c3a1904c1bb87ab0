// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stein/frame.hpp"

namespace stein::bench {

/// A frame with normal, albedo and depth (7 channels), all with variances and perhaps covariances, of random but
/// bounded values; fixed seed.
class BenchFrame {
 public:
  BenchFrame(int width, int height, bool has_covariances = false);
  void add_layers(int count);  ///< of three channels
  [[nodiscard]] const Frame& frame() const { return frame_; }

 private:
  ConstPlaneView add(float low, float high);
  std::vector<Plane> planes_;
  Frame frame_;
  unsigned state_ = 1;
};

}  // namespace stein::bench
