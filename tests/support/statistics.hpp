// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

/// Mean of numbers, and how far it may be from the true one.
class Statistics {
 public:
  void add(double value) {
    ++count_;
    const double distance = value - mean_;
    mean_ += distance / count_;
    squares_ += distance * (value - mean_);
  }
  [[nodiscard]] double count() const { return count_; }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double standard_error() const { return std::sqrt(squares_ / (count_ * (count_ - 1))); }

  /// Within 4 standard errors; rounding in float is forgiven.
  [[nodiscard]] bool agrees_with(double truth) const {
    return std::abs(mean_ - truth) <= 4 * standard_error() + 1e-5 * std::abs(truth);
  }
  [[nodiscard]] bool agrees_with(const Statistics& other) const {
    return std::abs(mean_ - other.mean_) <= 4 * std::hypot(standard_error(), other.standard_error());
  }

 private:
  double count_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};
