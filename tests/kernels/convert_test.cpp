// SPDX-License-Identifier: Apache-2.0
#include "kernels/convert.hpp"

#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "kernels/guides.hpp"
#include "kernels/instruction_sets.hpp"

namespace stein::kernels {
namespace {

// IEEE 754 binary16, as the standard defines its value.
float value_of_half(std::uint16_t half) {
  const int exponent = half >> 10 & 31;
  const int fraction = half & 1023;
  double magnitude = 0;
  if (exponent == 31) {
    magnitude = fraction == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  } else if (exponent == 0) {
    magnitude = std::ldexp(fraction, -24);
  } else {
    magnitude = std::ldexp(1024 + fraction, exponent - 25);
  }
  return static_cast<float>((half & 0x8000) != 0 ? -magnitude : magnitude);
}

bool is_same(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

}  // namespace

TEST_CASE("kernels: the instruction set changes when another one is asked for") {
  const std::string best = instruction_set();
  const std::set<std::string> names = for_each_instruction_set([] {});
  CHECK(names.count(best) == 1);
  CHECK(instruction_set() == best);
  for (const std::int64_t target : {HWY_AVX2, HWY_AVX3, HWY_NEON}) {  // those that no kind of build omits
    if ((hwy::SupportedTargets() & HWY_TARGETS & target) != 0) CHECK(names.count(hwy::TargetName(target)) == 1);
  }
}

TEST_CASE("half_to_float_row: every bit pattern, on every instruction set") {
  std::vector<std::uint16_t> half(65536);
  for (std::size_t i = 0; i < half.size(); ++i) half[i] = static_cast<std::uint16_t>(i);
  for_each_instruction_set([&] {
    std::vector<float> converted(half.size());
    half_to_float_row(reinterpret_cast<const std::byte*>(half.data()), 65536, converted.data());
    int wrong = 0;
    for (std::size_t i = 0; i < half.size(); ++i) wrong += is_same(converted[i], value_of_half(half[i])) ? 0 : 1;
    CHECK(wrong == 0);
  });
}

TEST_CASE("half_to_float_row: any count at any address, and nothing beyond the count") {
  constexpr float kUntouched = -77.0F;
  std::vector<std::byte> bytes(256);
  for_each_instruction_set([&] {
    for (std::size_t offset = 0; offset < 5; ++offset) {
      for (std::size_t count = 0; count <= 50; ++count) {
        for (std::size_t i = 0; i < count; ++i) {
          const auto half = static_cast<std::uint16_t>(0x3000 + 97 * i);
          std::memcpy(&bytes[offset + 2 * i], &half, 2);
        }
        std::vector<float> out(count + 20, kUntouched);
        half_to_float_row(&bytes[offset], static_cast<int>(count), out.data() + 1);
        int wrong = 0;
        for (std::size_t i = 0; i + 1 < out.size(); ++i) {
          const float expected = i < count ? value_of_half(static_cast<std::uint16_t>(0x3000 + 97 * i)) : kUntouched;
          wrong += out[i + 1] == expected ? 0 : 1;
        }
        CHECK(out[0] == kUntouched);
        CHECK(wrong == 0);
      }
    }
  });
}

}  // namespace stein::kernels
