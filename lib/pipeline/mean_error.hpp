// SPDX-License-Identifier: Apache-2.0
//
// The mean squared error of many pixels from their risk R, and from what it is for a good picture.
//
// R has the error as its expectation, but a mean of R is a noisy one: a few pixels can carry most of it. The divergence
// term D of the mixture F is known to a few percent, and is its error where F is as good as mixing with the input can
// make it: with x the truth, the derivative of E|F + s (y - F) - x|^2 at s = 0 is 2 (E D - E|F - x|^2), which is 0 at
// the best share of the input and not below 0 where the best has none: the error is D, or somewhat less. So R is
// believed as far as its noise allows, and D, which is likely, for the rest.
#pragma once

#include <algorithm>

namespace stein {

/// How far a mean error goes from what a good picture has to R, 0 to 1. `risk`, `likely`: sums of both; `noise`: the
/// variance of their difference.
[[nodiscard]] double evidence_of(double risk, double likely, double noise) noexcept;

class MeanError {
 public:
  /// The sums over one area of the image, so wide that what neighbours have in common stays within, and over how many
  /// values they go.
  void add(double risk, double likely, double values) noexcept {
    const double difference = risk - likely;
    risk_ += risk;
    likely_ += likely;
    values_ += values;
    squares_ += difference * difference;
    products_ += difference * values;
    squared_values_ += values * values;
    areas_ += 1;
  }

  [[nodiscard]] double evidence() const noexcept;
  /// >= 0: below lies what only variances can say that are not true.
  [[nodiscard]] double mean() const noexcept {
    return values_ > 0 ? std::max(likely_ + evidence() * (risk_ - likely_), 0.0) / values_ : 0.0;
  }

 private:
  double risk_ = 0;
  double likely_ = 0;
  double values_ = 0;
  double squares_ = 0;   // of the differences
  double products_ = 0;  // of differences and values
  double squared_values_ = 0;
  double areas_ = 0;
};

}  // namespace stein
