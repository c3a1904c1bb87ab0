// SPDX-License-Identifier: Apache-2.0
#include "pipeline/error_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/mean_error.hpp"

namespace stein {
namespace {

constexpr float kBinsPerOctave = 2.0F;
constexpr float kLeast = 0x1p-32F;         // centre of the first bin, and all that is less
constexpr double kUnitsPerRisk = 0x1p24;   // 6e-8 is not lost
constexpr double kMostRisk = 1e4;          // one pixel's, or less in images of so many that the sums would not fit
constexpr double kMostUnits = 0x1p62;      // of a sum, and as much again to spare
constexpr double kUnitsPerSquare = 0x1p4;  // squares are mostly above 1, as many pixels are averaged
constexpr float kMostRatio = 0x1p28F;      // whose square is summed
constexpr std::int64_t kMostSquares = std::int64_t{1} << 61;  // sums stay there, whatever the order of their terms
constexpr double kUnitsPerWeight = 0x1p24;
constexpr double kTogether = 2.0;     // times the sum of squares: neighbours err together
constexpr double kFewestPixels = 64;  // of what stands for itself

std::int64_t units(float risk, float most) noexcept {
  return static_cast<std::int64_t>(static_cast<double>(std::clamp(risk, -most, most)) * kUnitsPerRisk);
}

// Bins that are pooled.
struct Pool {
  double error = 0;
  double weight = 0;
  double pixels = 0;
  std::size_t bins = 0;
  void add(const Pool& other) {
    error += other.error;
    weight += other.weight;
    pixels += other.pixels;
    bins += other.bins;
  }
  [[nodiscard]] double mean() const { return weight > 0 ? error / weight : 0.0; }
};

}  // namespace

// In bins; whole numbers at their centres.
float ErrorCalibration::position(float predictor) noexcept {
  const float octaves = std::log2(std::max(predictor, kLeast) / kLeast);
  return std::min(kBinsPerOctave * octaves, static_cast<float>(kBins - 1));
}

ErrorCalibration::ErrorCalibration(int slots, std::int64_t pixels)
    : most_risk_(static_cast<float>(
          std::min(kMostRisk, kMostUnits / (kUnitsPerRisk * static_cast<double>(std::max<std::int64_t>(pixels, 1)))))),
      tables_(static_cast<std::size_t>(slots)) {
  for (std::size_t bin = 0; bin < kBins; ++bin)
    centres_[bin] = kLeast * std::exp2(static_cast<float>(bin) / kBinsPerOctave);
}

void ErrorCalibration::add(int slot, const float* predictor, const float* risk, const float* likely,
                           const float* weight, int count) noexcept {
  Table& table = tables_[static_cast<std::size_t>(slot)];
  for (int i = 0; i < count; ++i) {
    if (weight[i] == 0.0F) continue;
    const auto bin = static_cast<std::size_t>(position(predictor[i]) + 0.5F);
    const float ratio = std::min(weight[i] * std::abs(risk[i] - likely[i]) / centres_[bin], kMostRatio);
    const auto square = static_cast<std::int64_t>(static_cast<double>(ratio) * ratio * kUnitsPerSquare);
    table.squares[bin] = std::min(table.squares[bin] + square, kMostSquares);
    table.risk[bin] += units(weight[i] * risk[i], most_risk_);
    table.likely[bin] += units(weight[i] * likely[i], most_risk_);
    table.weight[bin] += static_cast<std::int64_t>(static_cast<double>(weight[i]) * kUnitsPerWeight);
    ++table.pixels[bin];
  }
}

// Weighted sums over the pixels of each bin.
std::array<double, ErrorCalibration::kBins> ErrorCalibration::errors_of(const Table& sums, double evidence) const {
  std::array<double, kBins> errors{};
  double told = 0;
  double wanted = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const double risk = static_cast<double>(sums.risk[bin]) / kUnitsPerRisk;
    const double likely = static_cast<double>(sums.likely[bin]) / kUnitsPerRisk;
    const double squares = static_cast<double>(sums.squares[bin]) / kUnitsPerSquare * std::pow(centres_[bin], 2);
    const double difference = risk - likely;
    errors[bin] = likely + evidence_of(risk, likely, kTogether * squares) * difference;
    told += errors[bin];
    wanted += likely + evidence * difference;
  }
  if (!(told > 0)) {  // the bins' own evidence does not add up to the image's: what is likely of each
    for (std::size_t bin = 0; bin < kBins; ++bin)
      errors[bin] = std::max(static_cast<double>(sums.likely[bin]) / kUnitsPerRisk, 0.0);
    told = std::accumulate(errors.begin(), errors.end(), 0.0);
  }
  for (double& error : errors) error *= told > 0 ? std::max(wanted, 0.0) / told : 0.0;
  return errors;
}

void ErrorCalibration::fit(double evidence) {
  Table all;
  for (const Table& table : tables_) {
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      all.risk[bin] += table.risk[bin];
      all.likely[bin] += table.likely[bin];
      all.squares[bin] = std::min(all.squares[bin] + table.squares[bin], kMostSquares);
      all.weight[bin] += table.weight[bin];
      all.pixels[bin] += table.pixels[bin];
    }
  }
  const std::array<double, kBins> errors = errors_of(all, evidence);
  std::vector<Pool> pools;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    Pool last = {errors[bin], static_cast<double>(all.weight[bin]) / kUnitsPerWeight,
                 static_cast<double>(all.pixels[bin]), 1};
    // Pool adjacent violators.
    while (!pools.empty() &&
           (last.pixels < kFewestPixels || pools.back().pixels < kFewestPixels || pools.back().mean() >= last.mean())) {
      last.add(pools.back());
      pools.pop_back();
    }
    pools.push_back(last);
  }
  // What lies below 0 is pooled from the lower end, until the mean is 0 or more.
  std::size_t positive = 0;
  Pool low;
  while (positive < pools.size() && (low.pixels == 0 || low.mean() < 0)) low.add(pools[positive++]);
  pools.erase(pools.begin(), pools.begin() + static_cast<std::ptrdiff_t>(positive));
  pools.insert(pools.begin(), low);
  auto* out = errors_.begin();
  for (const Pool& pool : pools) {
    out = std::fill_n(out, pool.bins, pool.pixels > 0 ? static_cast<float>(std::max(pool.mean(), 0.0)) : 0.0F);
  }
}

float ErrorCalibration::error(float predictor) const noexcept {
  const float at = position(predictor);
  const auto first = static_cast<std::size_t>(at);
  const std::size_t second = std::min(first + 1, errors_.size() - 1);
  return errors_[first] + (at - static_cast<float>(first)) * (errors_[second] - errors_[first]);
}

}  // namespace stein
