// SPDX-License-Identifier: Apache-2.0
#include "risk/followed.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "catch.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kStep = 0.1F;

// Pixels of a line, grey in three channels.
struct Line {
  std::vector<float> b;
  std::vector<float> F;
  std::vector<float> F_moved;

  [[nodiscard]] Followed followed() const {
    const float* directions[3] = {b.data(), b.data(), b.data()};
    const float* images[3] = {F.data(), F.data(), F.data()};
    const float* moved[3] = {F_moved.data(), F_moved.data(), F_moved.data()};
    Followed all;
    all.add_row(directions, images, moved, kStep, static_cast<int>(b.size()));
    return all;
  }
};

// Of noise whose deviation is 0.2 exp(spread n), n normal: its mean over 2 `radius` + 1 pixels, without the pixel
// itself if it is blind; if it is not right, that of other noise of the same deviations.
Line line_of(int pixels, int radius, double spread, bool is_right, bool is_blind = false) {
  Random random(11);
  const auto count = static_cast<std::size_t>(pixels);
  Line line{std::vector<float>(count), std::vector<float>(count, 1.0F), std::vector<float>(count)};
  std::vector<double> other(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double deviation = 0.2 * std::exp(spread * random.normal());
    line.b[i] = static_cast<float>(random.uniform() < 0.5 ? deviation : -deviation);
    other[i] = random.uniform() < 0.5 ? deviation : -deviation;
  }
  for (int i = 0; i < pixels; ++i) {
    double sum = 0;
    for (int j = i - radius; j <= i + radius; ++j) {
      const auto at = static_cast<std::size_t>((j + pixels) % pixels);
      if (!is_blind || j != i) sum += is_right ? static_cast<double>(line.b[at]) : other[at];
    }
    line.F_moved[static_cast<std::size_t>(i)] = static_cast<float>(1.0 + kStep * sum / (2 * radius + 1));
  }
  return line;
}

}  // namespace

TEST_CASE("followed: means of the perturbed pixels follow, whatever their noise, and those of others do not") {
  for (const int radius : {0, 1, 5, 50}) {
    for (const double spread : {0.0, 1.0, 2.0, 3.0}) {
      INFO("radius " << radius << ", spread " << spread);
      CHECK_FALSE(line_of(200000, radius, spread, true).followed().is_by_chance());
      if (spread < 2.0) CHECK(line_of(200000, radius, spread, false).followed().is_by_chance());
    }
  }
  CHECK_FALSE(line_of(90, 0, 0.0, false).followed().is_by_chance());  // too few to tell
  // What never uses the pixel itself cannot be told from another's.
  CHECK(line_of(200000, 5, 0.0, true, true).followed().is_by_chance());
}

TEST_CASE("followed: what stands still, has no noise or is no number does not count") {
  Line line = line_of(5000, 1, 0.0, true);
  CHECK_FALSE(line.followed().is_still());
  line.F_moved = line.F;
  CHECK(line.followed().is_still());
  CHECK_FALSE(line.followed().is_by_chance());
  line.b.assign(line.b.size(), 0.0F);
  line.F_moved.assign(line.F.size(), 7.0F);
  CHECK_FALSE(line.followed().is_still());
  CHECK_FALSE(line.followed().is_by_chance());
  line = line_of(5000, 1, 0.0, true);
  for (std::size_t i = 0; i < 100; ++i) line.F_moved[i] = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(line.followed().is_by_chance());
  CHECK_FALSE(line.followed().is_still());
}

TEST_CASE("followed: sums of parts are that of the whole") {
  const Line wrong = line_of(5000, 0, 0.0, false);
  Followed sum;
  CHECK_FALSE(sum.is_still());
  sum.add(wrong.followed());
  CHECK(sum.is_by_chance());
  for (int part = 0; part < 10; ++part) sum.add(line_of(5000, 0, 0.0, true).followed());
  CHECK_FALSE(sum.is_by_chance());
}

}  // namespace stein::test
