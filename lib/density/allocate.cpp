// SPDX-License-Identifier: Apache-2.0
//
// Integer samples from a density. SBF sec. 4.3 rounds each pixel's share of the budget up, which overspends by up to
// one sample per pixel and knows no bounds. Here the shares are the solution of
//
//   sum_i clamp(level * S_i - n_i, min, max) = budget
//
// with n_i the samples that the pixel has, where that counts,
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

void check_arguments(ConstPlaneView density, const AllocationParams& params, ConstPlaneView existing) {
  if (!density || density.width() < 1 || density.height() < 1) {
    throw Error(ErrorCode::kInvalidFrame, "density: the plane is absent or empty; pass a plane of at least 1x1");
  }
  if (existing && (existing.width() != density.width() || existing.height() != density.height())) {
    throw Error(ErrorCode::kInvalidFrame, "existing: the plane is " + std::to_string(existing.width()) + "x" +
                                              std::to_string(existing.height()) + ", must be of the density's size");
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

/// Row-major.
std::vector<float> values_of(ConstPlaneView plane) {
  const int width = plane.width();
  std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(plane.height()));
  for (int y = 0; y < plane.height(); ++y) {
    plane.read_row(y, 0, width, values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width));
  }
  return values;
}

std::vector<float> finite_density(ConstPlaneView density) {
  std::vector<float> values = values_of(density);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      const auto width = static_cast<std::size_t>(density.width());
      throw Error(ErrorCode::kInvalidFrame, "density is " + to_text(values[i]) + " at pixel (" +
                                                std::to_string(i % width) + ", " + std::to_string(i / width) +
                                                "), must be finite");
    }
  }
  return values;
}

/// A pixel whose count cannot be used has no samples that could be.
std::vector<float> usable_counts(ConstPlaneView existing) {
  std::vector<float> counts = existing ? values_of(existing) : std::vector<float>{};
  for (float& n : counts) n = std::isfinite(n) && n > 0.0F ? n : 0.0F;
  return counts;
}

/// The shares of all pixels: of those with a positive density under one level, and of the others.
class Shares {
 public:
  Shares(const std::vector<float>& density, const std::vector<float>& existing, const AllocationParams& params)
      : density_(density),
        existing_(existing),
        budget_(static_cast<double>(params.budget)),
        min_(params.min_per_pixel),
        max_(params.max_per_pixel) {
    const auto positive =
        static_cast<double>(std::count_if(density.begin(), density.end(), [](float s) { return s > 0.0F; }));
    const double zeros = static_cast<double>(density.size()) - positive;
    is_saturated_ = positive * max_ + zeros * min_ <= budget_;
    zero_share_ = is_saturated_ && zeros > 0 ? (budget_ - positive * max_) / zeros : min_;
    if (!is_saturated_) level_ = solve();
  }

  [[nodiscard]] double share(std::size_t i) const {
    if (!(density_[i] > 0.0F)) return zero_share_;
    return is_saturated_ ? max_ : share_at(level_, i);
  }

 private:
  [[nodiscard]] double existing(std::size_t i) const { return existing_.empty() ? 0.0 : existing_[i]; }

  [[nodiscard]] double share_at(double level, std::size_t i) const {
    return std::clamp(level * density_[i] - existing(i), min_, max_);
  }

  [[nodiscard]] double spent(double level) const {
    double sum = 0;
    for (std::size_t i = 0; i < density_.size(); ++i) sum += density_[i] > 0.0F ? share_at(level, i) : min_;
    return sum;
  }

  /// The level of the equation at the top of this file. What is spent is linear in the level between the levels at
  /// which a pixel leaves its minimum or reaches its maximum.
  [[nodiscard]] double solve() const {
    std::vector<double> bends;
    bends.reserve(2 * density_.size());
    for (std::size_t i = 0; i < density_.size(); ++i) {
      if (!(density_[i] > 0.0F)) continue;
      bends.push_back((existing(i) + min_) / density_[i]);
      bends.push_back((existing(i) + max_) / density_[i]);
    }
    std::sort(bends.begin(), bends.end());
    const auto above =
        std::partition_point(bends.begin(), bends.end(), [&](double level) { return spent(level) <= budget_; });
    if (above == bends.begin()) return bends.front();
    const double low = *std::prev(above);
    if (above == bends.end()) return low;
    double held = 0;
    double slope = 0;
    const double middle = low + (*above - low) / 2;
    for (std::size_t i = 0; i < density_.size(); ++i) {
      const double wanted = middle * density_[i] - existing(i);
      const bool is_free = density_[i] > 0.0F && wanted > min_ && wanted < max_;
      held += is_free ? -existing(i) : density_[i] > 0.0F ? share_at(middle, i) : min_;
      slope += is_free ? density_[i] : 0.0;
    }
    return slope > 0 ? std::clamp((budget_ - held) / slope, low, *above) : low;
  }

  const std::vector<float>& density_;
  const std::vector<float>& existing_;
  double budget_;
  double min_;
  double max_;
  bool is_saturated_ = false;  ///< every positive pixel is at the maximum; the zero ones share the rest
  double zero_share_ = 0;
  double level_ = 0;
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

std::vector<std::uint32_t> allocate_samples(ConstPlaneView density, const AllocationParams& params,
                                            ConstPlaneView existing) {
  check_arguments(density, params, existing);
  const std::vector<float> values = finite_density(density);
  const std::vector<float> taken = usable_counts(existing);
  const Shares shares(values, taken, params);

  std::vector<std::uint32_t> counts(values.size());
  std::vector<double> remainders(values.size());
  std::int64_t excess = params.budget;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = shares.share(i);
    counts[i] = static_cast<std::uint32_t>(share);
    remainders[i] = share - std::floor(share);
    excess -= counts[i];
  }
  settle(counts, remainders, excess, params);
  return counts;
}

}  // namespace stein
