// SPDX-License-Identifier: Apache-2.0
//
// Files whose colour is straight (divided by alpha), where stein works on premultiplied colour.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "stein/denoise.hpp"
#include "stein/frame.hpp"

namespace stein::exr {

/// Multiplies colour and layers of three channels by alpha, variances and covariances of the colour by its square, and
/// covariances with features by alpha. Values of alpha that are not finite make the pixel unusable. The new planes,
/// from `memory` where there is one, go to `planes_made`.
void premultiply(const ConstPlaneView& alpha, Frame& frame, Memory* memory, std::vector<Plane>& planes_made);

/// Divides planes of a result by alpha as it is in the result; 0 where alpha is not above 0.
class Straight {
 public:
  /// `alpha`: name of the layer; empty: the planes are left as they are. `memory`: for new planes, as above.
  Straight(const DenoiseResult& result, const std::string& alpha, Memory* memory);

  /// `power`: 1 for colours, 2 for squared errors. The view is valid as long as this object.
  [[nodiscard]] ConstPlaneView divided(const Plane& plane, int power);

 private:
  const Plane* alpha_ = nullptr;
  Memory* memory_;
  std::deque<Plane> planes_made_;
};

}  // namespace stein::exr
