// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "catch.hpp"
#include "prefilter/source.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// A frame with one feature whose channel k is value(k, x, y).
template <class Value>
float range_of(const FeatureShape& shape, int width, int height, Value value) {
  OwnedFrame frame(width, height, {shape});
  const Feature& feature = frame.frame().features[0];
  for (std::size_t k = 0; k < feature.mean.size(); ++k) {
    const std::string name = plane_name(feature, k, false);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) frame.at(name, x, y) = value(static_cast<int>(k), x, y);
    }
  }
  return feature_range(feature);
}

}  // namespace

TEST_CASE("feature range: features that are bounded by nature are not normalised") {
  const auto large = [](int k, int x, int y) { return static_cast<float>(1000 * k + x * y); };
  CHECK(range_of({"normal", 3}, 20, 20, large) == 1.0F);
  CHECK(range_of({"albedo", 3}, 20, 20, large) == 1.0F);
  CHECK(range_of({"visibility", 1}, 20, 20, large) == 1.0F);
  CHECK(range_of({"depth", 1}, 20, 20, large) > 100.0F);
}

TEST_CASE("feature range: depth is counted from 0, up to its 99.9 % quantile") {
  const auto ramp = [](int /*k*/, int x, int y) { return 5.0F + static_cast<float>(x + 50 * y) / 1000.0F; };
  const float range = range_of({"depth", 1}, 50, 40, ramp);  // 5 ... 6.999
  CHECK(range == Approx(6.997).margin(0.0015));
}

TEST_CASE("feature range: one infinite or huge value among many does not move it") {
  for (const std::string name : {"depth", "anything"}) {
    const auto ramp = [](int /*k*/, int x, int y) { return static_cast<float>(x + 50 * y) / 2000.0F; };
    const float clean = range_of({name, 1}, 50, 40, ramp);
    for (const float bad : {1e30F, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
      const auto spoilt = [&](int k, int x, int y) { return x == 17 && y == 20 ? bad : ramp(k, x, y); };
      CHECK(range_of({name, 1}, 50, 40, spoilt) == Approx(clean).margin(0.002));
    }
  }
}

TEST_CASE("feature range: a plane without a range, or without a finite value, is left as it is") {
  CHECK(range_of({"depth", 1}, 9, 9, [](int, int, int) { return 0.0F; }) == 1.0F);
  CHECK(range_of({"position", 3}, 9, 9, [](int, int, int) { return -7.5F; }) == 1.0F);
  CHECK(range_of({"position", 3}, 1, 1, [](int, int, int) { return 3.0F; }) == 1.0F);
  CHECK(range_of({"depth", 1}, 9, 9, [](int, int, int) { return std::numeric_limits<float>::quiet_NaN(); }) == 1.0F);
  CHECK(range_of({"depth", 1}, 9, 9, [](int, int, int) { return -2.0F; }) == 1.0F);
}

TEST_CASE("feature range: the range of the largest channel counts for all") {
  const auto value = [](int k, int x, int /*y*/) {
    constexpr float kWidth[] = {1.0F, 8.0F, 3.0F};
    return 100.0F + kWidth[k] * static_cast<float>(x) / 999.0F;
  };
  CHECK(range_of({"position", 3}, 1000, 3, value) == Approx(8.0).margin(0.04));
}

TEST_CASE("feature range: in large planes all columns and rows take part") {
  // Too many pixels to look at all; widths that a step of 2 or 3 divides.
  for (const auto& [width, height] : {std::pair(300, 300), std::pair(420, 360), std::pair(512, 256)}) {
    for (const int column : {0, 1}) {
      const auto stripes = [&](int /*k*/, int x, int /*y*/) { return x % 2 == column ? 6.0F : 2.0F; };
      CHECK(range_of({"depth", 1}, width, height, stripes) == 6.0F);
      CHECK(range_of({"other", 1}, width, height, stripes) == 4.0F);
    }
    const auto lower_half = [h = height](int /*k*/, int /*x*/, int y) { return y >= h / 2 ? 9.0F : 1.0F; };
    CHECK(range_of({"depth", 1}, width, height, lower_half) == 9.0F);
    CHECK(range_of({"other", 1}, width, height, lower_half) == 8.0F);
  }
}

}  // namespace stein::test
