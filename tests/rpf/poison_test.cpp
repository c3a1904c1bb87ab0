// SPDX-License-Identifier: Apache-2.0
//
// One sample that holds what it should not: it may change what lies within the boxes of all passes and
// the reach of what is returned after them, and nothing else.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "catch.hpp"
#include "rpf/samples.hpp"

namespace stein::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kX = 5;  // of the poisoned pixel
constexpr int kY = 4;

RpfParams small_boxes() {
  RpfParams params;
  params.boxes = {9, 7, 5};
  params.shares = {0.3F, 0.4F, 0.6F};
  params.draws = 1;
  params.return_sigma = 2;
  return params;
}

FilteredImage filtered(SampleImage image, std::size_t channel, float value) {
  image.at(kX, kY)[channel] = value;
  return filter_image(image, small_boxes());
}

/// Whether values of three channels agree from `halo` pixels on.
bool agree_beyond(const std::vector<float>& a, const std::vector<float>& b, int width, int halo) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int pixel = static_cast<int>(i / 3);
    const bool is_far = pixel % width > kX + halo || pixel / width > kY + halo;
    if (is_far && a[i] != b[i]) return false;
  }
  return a.size() == b.size();
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

TEST_CASE("a poisoned sample changes no bit beyond the boxes of all passes and what is returned") {
  constexpr int kHalo = 4 + 3 + 2 + 4;
  constexpr int kSmoothing = 8;  // of the error
  const SampleImage wall = make_wall(kX + kHalo + kSmoothing + 6, kY + kHalo + kSmoothing + 5, 6);
  const FilteredImage sound = filter_image(wall, small_boxes());
  const FilteredImage without = filtered(wall, 1, kNan);
  CHECK(without.report.rejected == 1);
  CHECK(without.colour != sound.colour);
  for (const float value : {kInfinity, -kInfinity, 1e38F}) {
    const FilteredImage poisoned = filtered(wall, 0, value);
    CHECK(poisoned.report.rejected == 1);
    CHECK(poisoned.colour == without.colour);
    CHECK(poisoned.error == without.error);
  }
  for (std::size_t channel = 0; channel < static_cast<std::size_t>(wall.channels()); ++channel) {
    for (const float value : {kNan, 1e38F}) {
      INFO("channel " << channel << " is " << value);
      const FilteredImage poisoned = filtered(wall, channel, value);
      CHECK(all_finite(poisoned.colour));
      CHECK(all_finite(poisoned.error));
      CHECK(agree_beyond(sound.colour, poisoned.colour, wall.width, kHalo));
      CHECK(agree_beyond(sound.error, poisoned.error, wall.width, kHalo + kSmoothing));
    }
  }
}

}  // namespace stein::test
