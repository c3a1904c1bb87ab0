// SPDX-License-Identifier: Apache-2.0
//
// The mixture of pictures of least estimated error.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stein/filters.hpp"

namespace stein {

inline constexpr int kMaxMixed = kMaxFilters + 1;  ///< the pictures of the filters, and the input

/// The risk of a mixture sum_k w_k F_k with sum_k w_k = 1, but for the sum of the variances, which does not depend on
/// w:
///   |sum_k w_k F_k - y|^2 + 2 sum_k w_k D_k = w^T G w + 2 d^T w
/// with G_kl the sum over pixels of (F_k - y)(F_l - y), and d_k that of D_k. Sums may be weighted.
struct MixtureRisk {
  static constexpr std::size_t kPairs = std::size_t{kMaxMixed} * (kMaxMixed + 1) / 2;
  std::array<double, kPairs> products{};  ///< G, see pair()
  std::array<double, kMaxMixed> divergences{};
  double noise = 0;  ///< sum of the variances
  double pixels = 0;

  /// Index of G_kl, k >= l.
  [[nodiscard]] static constexpr std::size_t pair(int k, int l) noexcept {
    return static_cast<std::size_t>(k * (k + 1) / 2 + l);
  }
  [[nodiscard]] double product(int k, int l) const noexcept { return products[k > l ? pair(k, l) : pair(l, k)]; }

  /// *this += factor * other
  void add(const MixtureRisk& other, double factor);
};

using MixtureWeights = std::array<float, kMaxMixed>;

/// The weights >= 0 with sum 1 over the first `count` pictures at which the risk is least. Deterministic. Pictures
/// whose bit is not in `among` get none; picture 0 is always among them.
[[nodiscard]] MixtureWeights least_risk(const MixtureRisk& risk, int count, std::uint32_t among = ~0U);

}  // namespace stein
