// SPDX-License-Identifier: Apache-2.0
//
// What error pixels have on average, by something known of each that carries less noise than its own risk.
//
// The risk of a single pixel is unbiased but mostly noise: many times its mean, of either sign, and so is a mean over
// few pixels. The mean over all pixels of the image that have like predictors is far better, and is believed as far as
// its noise allows (mean_error.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace stein {

class ErrorCalibration {
 public:
  /// `slots`: threads that may add at the same time; `pixels`: as many are added at most.
  ErrorCalibration(int slots, std::int64_t pixels);

  /// Pixels of a row: their predictors (any numbers >= 0), relative risks and likely relative errors, and the weight of
  /// each, 0 to 1, in all means. Sums are kept as integers, so that the order of the calls does not matter.
  void add(int slot, const float* predictor, const float* risk, const float* likely, const float* weight,
           int count) noexcept;

  /// Fits: the mean errors of bins of the predictor, scaled so that their mean over all pixels lies between those of
  /// likely (`evidence` 0) and risk (1), see MeanError. They are made ascending and >= 0 by pooling neighbours
  /// (isotonic regression), which leaves their mean as it is as far as that is >= 0. Where the bins' own evidence adds
  /// up to 0 or less, what is likely of each is scaled.
  void fit(double evidence);

  /// The error for a predictor, after fit(): between the centres of bins, linear in the predictor's logarithm.
  [[nodiscard]] float error(float predictor) const noexcept;

 private:
  static constexpr int kBins = 96;
  struct Table {
    std::array<std::int64_t, kBins> risk{};  // in units of 1 / kUnitsPerRisk
    std::array<std::int64_t, kBins> likely{};
    std::array<std::int64_t, kBins> squares{};  // of their difference over the bin's predictor, see kUnitsPerSquare
    std::array<std::int64_t, kBins> weight{};   // in units of 1 / kUnitsPerWeight
    std::array<std::int64_t, kBins> pixels{};
  };
  static float position(float predictor) noexcept;
  [[nodiscard]] std::array<double, kBins> errors_of(const Table& sums, double evidence) const;

  float most_risk_;                     // that a pixel counts with
  std::vector<Table> tables_;           // per slot
  std::array<float, kBins> centres_{};  // predictors
  std::array<float, kBins> errors_{};   // of the centres
};

}  // namespace stein
