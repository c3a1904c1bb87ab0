// SPDX-License-Identifier: Apache-2.0
//
// Counter-based random bits: a function of what is hashed, so that threads and tiles cannot change them.
#pragma once

#include <cstdint>

namespace stein {

inline constexpr std::uint64_t kGoldenRatioBits = 0x9E3779B97F4A7C15ULL;

inline constexpr std::uint64_t kMixFactors[2] = {0xBF58476D1CE4E5B9ULL, 0x94D049BB133111EBULL};

/// The finaliser of SplitMix64 (Steele et al. 2014).
[[nodiscard]] constexpr std::uint64_t mixed(std::uint64_t z) noexcept {
  z = (z ^ (z >> 30)) * kMixFactors[0];
  z = (z ^ (z >> 27)) * kMixFactors[1];
  return z ^ (z >> 31);
}

/// One number for a pixel.
[[nodiscard]] constexpr std::uint64_t pixel_key(int x, int y) noexcept {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32U) | static_cast<std::uint32_t>(x);
}

}  // namespace stein
