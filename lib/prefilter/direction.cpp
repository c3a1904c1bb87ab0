// SPDX-License-Identifier: Apache-2.0
#include "prefilter/direction.hpp"

#include <cmath>

#include "core/hash.hpp"

namespace stein {
namespace {

// A pivot below this fraction of its variance is rounding.
constexpr float kSingular = 1e-4F;

float root_of_pivot(float pivot, float variance) noexcept {
  return pivot > kSingular * variance ? std::sqrt(pivot) : 0.0F;
}

float quotient(float a, float b) noexcept { return b > 0.0F ? a / b : 0.0F; }

}  // namespace

std::array<float, 3> random_signs(std::uint64_t seed, int draw, int x, int y) noexcept {
  const std::uint64_t stream = mixed(seed + kGoldenRatioBits * (static_cast<std::uint64_t>(draw) + 1));
  const std::uint64_t bits = mixed(stream ^ mixed(pixel_key(x, y) + 0xD1B54A32D192ED03ULL));
  const auto sign = [bits](unsigned bit) { return ((bits >> bit) & 1U) != 0 ? 1.0F : -1.0F; };
  return {sign(17), sign(31), sign(47)};
}

ColourFactor::ColourFactor(float v0, float v1, float v2, float c01, float c02, float c12) noexcept {
  l00 = root_of_pivot(v0, v0);
  l10 = quotient(c01, l00);
  l11 = root_of_pivot(v1 - l10 * l10, v1);
  l20 = quotient(c02, l00);
  l21 = quotient(c12 - l20 * l10, l11);
  l22 = root_of_pivot(v2 - l20 * l20 - l21 * l21, v2);
}

float ColourFactor::colour(std::size_t channel, const std::array<float, 3>& z) const noexcept {
  if (channel == 0) return l00 * z[0];
  if (channel == 1) return l10 * z[0] + l11 * z[1];
  return l20 * z[0] + l21 * z[1] + l22 * z[2];
}

float ColourFactor::feature(float c0, float c1, float c2, const std::array<float, 3>& z) const noexcept {
  const float m0 = quotient(c0, l00);
  const float m1 = quotient(c1 - l10 * m0, l11);
  const float m2 = quotient(c2 - l20 * m0 - l21 * m1, l22);
  return m0 * z[0] + m1 * z[1] + m2 * z[2];
}

}  // namespace stein
