// SPDX-License-Identifier: Apache-2.0
#include "pipeline/error_calibration.hpp"

#include <algorithm>
#include <cmath>

namespace stein {
namespace {

constexpr float kBinsPerOctave = 2.0F;
constexpr float kLeast = 0x1p-32F;          // centre of the first bin, and all that is less
constexpr double kUnitsPerRisk = 0x1p24;    // sums of 1e9 pixels of relative risk 1 fit, and 6e-8 is not lost
constexpr float kMostRisk = 1e4F;           // one pixel's
constexpr std::int64_t kFewestPixels = 64;  // of what stands for itself

// Bins that are pooled.
struct Pool {
  double risk = 0;
  double pixels = 0;
  std::size_t bins = 0;
  void add(const Pool& other) {
    risk += other.risk;
    pixels += other.pixels;
    bins += other.bins;
  }
  [[nodiscard]] double mean() const { return risk / pixels; }
};

}  // namespace

// In bins; whole numbers at their centres.
float ErrorCalibration::position(float predictor) noexcept {
  const float octaves = std::log2(std::max(predictor, kLeast) / kLeast);
  return std::min(kBinsPerOctave * octaves, static_cast<float>(kBins - 1));
}

void ErrorCalibration::add(int slot, const float* predictor, const float* risk, const float* mask, int count) noexcept {
  Table& table = tables_[static_cast<std::size_t>(slot)];
  for (int i = 0; i < count; ++i) {
    if (mask[i] == 0.0F) continue;
    const auto bin = static_cast<std::size_t>(position(predictor[i]) + 0.5F);
    const double units = static_cast<double>(std::clamp(risk[i], -kMostRisk, kMostRisk)) * kUnitsPerRisk;
    table.risk[bin] += static_cast<std::int64_t>(units);
    ++table.pixels[bin];
  }
}

void ErrorCalibration::fit() {
  Table all;
  for (const Table& table : tables_) {
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      all.risk[bin] += table.risk[bin];
      all.pixels[bin] += table.pixels[bin];
    }
  }
  std::vector<Pool> pools;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    Pool last = {static_cast<double>(all.risk[bin]) / kUnitsPerRisk, static_cast<double>(all.pixels[bin]), 1};
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
