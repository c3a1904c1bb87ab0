// SPDX-License-Identifier: Apache-2.0
//
// Whether an image of a perturbed frame has to do with the perturbation.
#pragma once

#include <cstdint>

namespace stein {

/// Pixel by pixel, by the sign of the product of image's and frame's movement, summed over the channels: a coin's if
/// they have nothing to do with each other.
class Followed {
 public:
  /// Three channels of `count` pixels: F of the frame as it is, F_moved of y + step b. Where b is 0 nothing counts.
  void add_row(const float* const b[3], const float* const F[3], const float* const F_moved[3], float step,
               int count) noexcept;
  void add(const Followed& other) noexcept;

  /// Less than the image must show if it is one of the perturbed frame.
  [[nodiscard]] bool is_by_chance() const noexcept;
  /// Fraction of the pixels that move along.
  [[nodiscard]] double share() const noexcept;

 private:
  std::int64_t along_ = 0;  // pixels
  std::int64_t against_ = 0;
  double moved_ = 0;  // sums of lengths: at most the pixel's own perturbation, ...
  double perturbed_ = 0;
};

}  // namespace stein
