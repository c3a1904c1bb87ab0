// SPDX-License-Identifier: Apache-2.0
#include "pipeline/mean_error.hpp"

#include <algorithm>
#include <cmath>

namespace stein {
namespace {

// Standard deviation of the error around what is likely, relative to that: the mixture is not quite the best, and D has
// noise and a bias of its own. Chosen near what D and the error of good filters differ by (docs/risk.md).
constexpr double kDeviation = 0.15;
// What lies more standard errors away from it counts whatever D is, the more the farther: a picture can be a bad one.
constexpr double kCertain = 3.0;

}  // namespace

// The posterior mean where both deviations are Gaussian, or what James and Stein leave of a greater one.
double evidence_of(double risk, double likely, double noise) noexcept {
  if (noise == 0) return 1;
  const double prior = std::pow(kDeviation * likely, 2);
  const double squared_difference = std::pow(risk - likely, 2);
  const double gaussian = prior / (prior + noise);
  return squared_difference > 0 ? std::max(gaussian, 1.0 - kCertain * kCertain * noise / squared_difference) : gaussian;
}

// The spread from area to area around the mean of all, as of a ratio: areas at the border are smaller. One area says
// nothing of its noise, which may then be all there is.
double MeanError::evidence() const noexcept {
  if (areas_ < 2) return evidence_of(risk_, likely_, squares_);
  const double usual = (risk_ - likely_) / values_;
  const double scatter = std::max(squares_ - 2.0 * usual * products_ + usual * usual * squared_values_, 0.0);
  return evidence_of(risk_, likely_, scatter * areas_ / (areas_ - 1));
}

}  // namespace stein
