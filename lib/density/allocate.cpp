// SPDX-License-Identifier: Apache-2.0
//
// Integer samples from a density. SBF sec. 4.3 rounds each pixel's share of the budget up, which overspends by up to
// one sample per pixel and knows no bounds. Here the shares are the solution of
//
//   sum_i clamp(level * S_i, min, max) = budget
//
// and are rounded by largest remainder, so the sum is exact. Pixels of density 0 (or below) act as ones of an equal,
// vanishing density: they stay at the minimum until every other pixel is at the maximum, and then share what is left
// evenly.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "core/parameter_check.hpp"
#include "stein/density.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

void check_arguments(ConstPlaneView density, const AllocationParams& params) {
  if (!density || density.width() < 1 || density.height() < 1) {
    throw Error(ErrorCode::kInvalidFrame, "density: the plane is absent or empty; pass a plane of at least 1x1");
  }
  const auto pixels = static_cast<std::int64_t>(density.width()) * density.height();
  const std::string bounds = "min_per_pixel = " + std::to_string(params.min_per_pixel) +
                             ", max_per_pixel = " + std::to_string(params.max_per_pixel);
  if (params.budget < 0) {
    throw Error(ErrorCode::kInvalidArgument, "budget is " + std::to_string(params.budget) + ", must be >= 0");
  }
  if (params.min_per_pixel > params.max_per_pixel) {
    throw Error(ErrorCode::kInvalidArgument, bounds + ": the minimum must not be above the maximum");
  }
  // By division, because pixels * max_per_pixel need not fit.
  const std::int64_t floor_share = params.budget / pixels;
  const std::int64_t ceil_share = floor_share + (params.budget % pixels != 0 ? 1 : 0);
  if (params.min_per_pixel > floor_share || params.max_per_pixel < ceil_share) {
    const std::string advice = params.min_per_pixel > floor_share ? "lower the minimum or raise the budget"
                                                                  : "raise the maximum or lower the budget";
    throw Error(ErrorCode::kInvalidArgument, "a budget of " + std::to_string(params.budget) + " samples for " +
                                                 std::to_string(pixels) + " pixels does not fit " + bounds + "; " +
                                                 advice);
  }
}

/// The density, row-major.
std::vector<float> finite_density(ConstPlaneView density) {
  const int width = density.width();
  std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(density.height()));
  for (int y = 0; y < density.height(); ++y) {
    float* row = values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    density.read_row(y, 0, width, row);
    for (int x = 0; x < width; ++x) {
      if (!std::isfinite(row[x])) {
        throw Error(ErrorCode::kInvalidFrame, "density is " + to_text(row[x]) + " at pixel (" + std::to_string(x) +
                                                  ", " + std::to_string(y) + "), must be finite");
      }
    }
  }
  return values;
}

/// The positive densities, ascending, under one level: which pixels are held at a bound and how many samples that
/// takes.
class Shares {
 public:
  Shares(const std::vector<float>& density, const AllocationParams& params)
      : budget_(static_cast<double>(params.budget)), min_(params.min_per_pixel), max_(params.max_per_pixel) {
    positive_.reserve(density.size());
    std::copy_if(density.begin(), density.end(), std::back_inserter(positive_), [](float s) { return s > 0.0F; });
    std::sort(positive_.begin(), positive_.end());
    zeros_ = static_cast<double>(density.size() - positive_.size());
  }

  /// Whether every positive pixel is at the maximum; the zero ones then share the rest.
  [[nodiscard]] bool saturated() const { return count(0, positive_.size()) * max_ + zeros_ * min_ <= budget_; }

  /// What a pixel of density 0 gets.
  [[nodiscard]] double zero_share() const {
    return saturated() && zeros_ > 0 ? (budget_ - count(0, positive_.size()) * max_) / zeros_ : min_;
  }

  /// The level of the equation at the top of this file; only if not saturated.
  [[nodiscard]] double solve() const {
    // A pixel is at the minimum if even the level that would lift it off takes the whole budget, and at the maximum if
    // the level that brings it there does not. Both hold for one end of the sorted densities.
    const auto begin = positive_.begin();
    const auto mid_begin = static_cast<std::size_t>(
        std::partition_point(begin, positive_.end(), [&](float s) { return spent(min_ / s) >= budget_; }) - begin);
    auto mid_end = static_cast<std::size_t>(
        std::partition_point(begin, positive_.end(), [&](float s) { return spent(max_ / s) > budget_; }) - begin);
    mid_end = std::max(mid_end, mid_begin);
    if (mid_begin == mid_end) {
      return mid_end < positive_.size() ? max_ / positive_[mid_end] : min_ / positive_.back();
    }
    const double held = (count(0, mid_begin) + zeros_) * min_ + count(mid_end, positive_.size()) * max_;
    return (budget_ - held) / sum(mid_begin, mid_end);
  }

 private:
  [[nodiscard]] static double count(std::size_t begin, std::size_t end) { return static_cast<double>(end - begin); }

  /// Ascending, so that small densities are not lost; differences of running sums would lose them.
  [[nodiscard]] double sum(std::size_t begin, std::size_t end) const {
    const auto at = [&](std::size_t i) { return positive_.begin() + static_cast<std::ptrdiff_t>(i); };
    return std::accumulate(at(begin), at(end), 0.0);
  }

  [[nodiscard]] double spent(double level) const {
    const auto below = [&](double bound) {
      return static_cast<std::size_t>(
          std::partition_point(positive_.begin(), positive_.end(), [&](float s) { return level * s < bound; }) -
          positive_.begin());
    };
    const std::size_t mid_begin = below(min_);
    const std::size_t mid_end = below(max_);
    return (count(0, mid_begin) + zeros_) * min_ + level * sum(mid_begin, mid_end) +
           count(mid_end, positive_.size()) * max_;
  }

  std::vector<float> positive_;
  double zeros_ = 0;
  double budget_;
  double min_;
  double max_;
};

/// Moves `counts` by one sample per pixel and round until `excess` samples are handed out (or, if negative, taken
/// back): the largest remainders first, the lower pixel index on ties. More than one round, or a negative excess, comes
/// from rounding only.
void settle(std::vector<std::uint32_t>& counts, const std::vector<double>& remainders, std::int64_t excess,
            const AllocationParams& params) {
  while (excess != 0) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (excess > 0 ? counts[i] < params.max_per_pixel : counts[i] > params.min_per_pixel) order.push_back(i);
    }
    const auto first = [&](std::size_t a, std::size_t b) {
      if (remainders[a] != remainders[b]) return (remainders[a] > remainders[b]) == (excess > 0);
      return a < b;
    };
    const auto taken = std::min<std::size_t>(order.size(), static_cast<std::size_t>(std::abs(excess)));
    if (taken < order.size()) {
      std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(taken), order.end(), first);
    }
    for (std::size_t i = 0; i < taken; ++i) {
      excess > 0 ? ++counts[order[i]] : --counts[order[i]];
    }
    excess -= (excess > 0 ? 1 : -1) * static_cast<std::int64_t>(taken);
  }
}

}  // namespace

std::vector<std::uint32_t> allocate_samples(ConstPlaneView density, const AllocationParams& params) {
  check_arguments(density, params);
  const std::vector<float> values = finite_density(density);
  const Shares shares(values, params);
  const double zero_share = shares.zero_share();
  const bool saturated = shares.saturated();
  const double level = saturated ? 0.0 : shares.solve();

  std::vector<std::uint32_t> counts(values.size());
  std::vector<double> remainders(values.size());
  std::int64_t excess = params.budget;
  const auto low = static_cast<double>(params.min_per_pixel);
  const auto high = static_cast<double>(params.max_per_pixel);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double wanted = values[i] > 0.0F ? (saturated ? high : level * values[i]) : zero_share;
    const double share = std::clamp(wanted, low, high);
    counts[i] = static_cast<std::uint32_t>(share);
    remainders[i] = share - std::floor(share);
    excess -= counts[i];
  }
  settle(counts, remainders, excess, params);
  return counts;
}

}  // namespace stein
