// SPDX-License-Identifier: Apache-2.0
//
// Whether an image of a perturbed frame has to do with the perturbation.
#pragma once

namespace stein {

/// By the products p m of what the frame was moved by at a pixel and what its image moved by, relative to the image
/// and summed over the channels. If the two have nothing to do with each other every product is as often below 0 as
/// above, and their sum has a standard deviation of sqrt(sum (p m)^2). If m = W p with a symmetric W whose eigenvalues
/// are between 0 and 1, as averages have, sum p m >= sum m m.
class Followed {
 public:
  /// Three channels of `count` pixels: F of the frame as it is, F_moved of y + step b. Where b is 0 nothing counts.
  void add_row(const float* const b[3], const float* const F[3], const float* const F_moved[3], float step,
               int count) noexcept;
  void add(const Followed& other) noexcept;

  /// Far less than what an average that moves as much as this image must show.
  [[nodiscard]] bool is_by_chance() const noexcept;
  /// The frame moved, and the image not at all.
  [[nodiscard]] bool is_still() const noexcept { return is_perturbed_ && moved_ == 0; }

 private:
  double products_ = 0;  // sums of p m, ...
  double squares_ = 0;   // of (p m)^2 ...
  double moved_ = 0;     // and of m m
  bool is_perturbed_ = false;
};

}  // namespace stein
