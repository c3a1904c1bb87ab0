// SPDX-License-Identifier: Apache-2.0
#include "pipeline/mean_error.hpp"

#include <algorithm>
#include <cmath>

namespace stein {
namespace {

// Standard deviation of the error around what is likely, relative to that: the mixture is not quite the best, and D has
// noise and a bias of its own. Measured: docs/risk.md.
constexpr double kDeviation = 0.2;
// What lies more standard errors away from it is no noise: a picture can be a bad one.
constexpr double kCertain = 3.0;

}  // namespace

// The posterior mean where both deviations are Gaussian, or what James and Stein leave of a greater one.
double evidence_of(double risk, double likely, double squares) noexcept {
  if (squares == 0) return 1;
  const double variance = std::pow(kDeviation * likely, 2);
  const double difference = std::pow(risk - likely, 2);
  const double gaussian = variance / (variance + squares);
  return difference > 0 ? std::max(gaussian, 1.0 - kCertain * kCertain * squares / difference) : gaussian;
}

// The spread from area to area. One area says nothing of its noise, which may then be all there is.
double MeanError::evidence() const noexcept {
  if (areas_ < 2) return evidence_of(risk_, likely_, squares_);
  const double difference = risk_ - likely_;
  const double scatter = std::max(squares_ - difference * difference / areas_, 0.0) * areas_ / (areas_ - 1);
  return evidence_of(risk_, likely_, scatter);
}

}  // namespace stein
