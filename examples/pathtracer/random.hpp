// SPDX-License-Identifier: Apache-2.0
//
// Random numbers that belong to a sample, not to a thread: equal (seed, pixel, index) give equal numbers, whatever was
// rendered before.
#pragma once

#include <cstdint>

#include "vec3.hpp"

namespace pathtracer {

/// PCG32 (O'Neill 2014), with state and stream hashed from seed, pixel and index of the sample.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample)
      : state_(mix(mix(mix(seed) + pixel) + sample)), stream_(mix(state_) | 1U) {}

  [[nodiscard]] std::uint32_t bits() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + stream_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
  }

  /// In [0, 1).
  [[nodiscard]] float uniform() { return static_cast<float>(bits() >> 8U) * 0x1p-24F; }

  [[nodiscard]] Vec2 uniform2() {
    const float x = uniform();
    return {x, uniform()};
  }

 private:
  // The finaliser of SplitMix64 (Steele et al. 2014).
  static std::uint64_t mix(std::uint64_t key) {
    key += 0x9E3779B97F4A7C15ULL;
    key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    key = (key ^ (key >> 27U)) * 0x94D049BB133111EBULL;
    return key ^ (key >> 31U);
  }

  std::uint64_t state_;
  std::uint64_t stream_;
};

}  // namespace pathtracer
