// SPDX-License-Identifier: Apache-2.0
#include "risk/followed.hpp"

#include <cmath>

#include "risk/sure.hpp"

namespace stein {
namespace {

// Standard deviations. Of OIDN's images of 11 renders, and of parts of 48 to 160 px, those of which 10 can be expected
// have 14 or more; with another draw none has more than 2.2.
constexpr double kExpected = 10.0;
constexpr double kChance = 3.0;

}  // namespace

void Followed::add_row(const float* const b[3], const float* const F[3], const float* const F_moved[3], float step,
                       int count) noexcept {
  for (int i = 0; i < count; ++i) {
    double product = 0;
    for (int c = 0; c < 3; ++c) {
      const double perturbation = static_cast<double>(step) * b[c][i];
      const double image = F[c][i];
      const double movement = F_moved[c][i] - image;
      if (perturbation == 0.0 || !std::isfinite(movement)) continue;
      const double weight = 1.0 / (image * image + kRelativeEpsilon);
      product += weight * perturbation * movement;
      moved_ += weight * movement * movement;
      is_perturbed_ = true;
    }
    products_ += product;
    squares_ += product * product;
  }
}

void Followed::add(const Followed& other) noexcept {
  products_ += other.products_;
  squares_ += other.squares_;
  moved_ += other.moved_;
  is_perturbed_ = is_perturbed_ || other.is_perturbed_;
}

bool Followed::is_by_chance() const noexcept {
  const double deviation = std::sqrt(squares_);
  return moved_ > kExpected * deviation && products_ < kChance * deviation;
}

}  // namespace stein
