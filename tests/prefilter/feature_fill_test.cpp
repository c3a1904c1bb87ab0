// SPDX-License-Identifier: Apache-2.0
//
// What filters see of a feature in single pixels where it is unusable.
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "core/validity.hpp"
#include "prefilter/source.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 1030;  // rows are worked on in parts of 512
constexpr int kHeight = 6;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kFactor = 2.5F;

struct Seen {
  float mean[3] = {};
  float variance = 0;
};

// Pixel (x, y) as a part of the row from `first` on.
Seen seen(const Source& source, int x, int y, int first = 0) {
  std::vector<std::vector<float>> rows(4, std::vector<float>(kWidth));
  float* means[] = {rows[0].data(), rows[1].data(), rows[2].data()};
  source.feature_row(0, kFactor, y, first, kWidth - first, means, rows[3].data());
  const auto i = static_cast<std::size_t>(x - first);
  return {{rows[0][i], rows[1][i], rows[2][i]}, rows[3][i]};
}

float variance_of_mean(const Source& source, std::size_t k, int x, int y, int first = 0) {
  std::vector<float> row(kWidth);
  source.feature_variance_row(0, k, y, first, kWidth - first, row.data());
  return row[static_cast<std::size_t>(x - first)];
}

bool is_left_out(const Seen& pixel) { return pixel.mean[0] == 0.0F && pixel.variance >= 1e9F; }

}  // namespace

TEST_CASE(
    "a feature that is unusable in a single pixel is that of the pixels around it, with their differences as noise") {
  OwnedFrame frame(kWidth, kHeight, {{"albedo", 3}});
  fill_random(frame, 5);
  for (const auto& [x, y] : {std::pair(7, 3), {0, 0}, {511, 2}, {512, 4}, {kWidth - 1, kHeight - 1}}) {
    INFO(x << ", " << y);
    const float before = std::exchange(frame.at("albedo.G", x, y), kNan);
    const Source source(frame.frame(), inspect(frame.frame()));
    double sum[3] = {};
    double squares[3] = {};
    double variance = 0;
    int count = 0;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kHeight - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kWidth - 1); ++u) {
        if (u == x && v == y) continue;
        ++count;
        for (std::size_t k = 0; k < 3; ++k) {
          const double value = frame.frame().features[0].mean[k].at(u, v);
          sum[k] += value;
          squares[k] += value * value;
          variance +=
              static_cast<double>(frame.frame().features[0].variance[k].at(u, v)) * frame.at("sampleCount", u, v);
        }
      }
    }
    for (const int first : {0, std::max(x - 1, 0), x}) {
      const Seen pixel = seen(source, x, y, first);
      double spread = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK(pixel.mean[k] == Approx(kFactor * sum[k] / count).epsilon(1e-5));
        spread += squares[k] / count - std::pow(sum[k] / count, 2);
      }
      CHECK(pixel.variance == Approx((variance / count + spread) / 3).epsilon(1e-4));
      const double of_mean = pixel.variance / frame.at("sampleCount", x, y);
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK(variance_of_mean(source, k, x, y, first) == Approx(of_mean).epsilon(1e-5));
      }
    }
    frame.at("albedo.G", x, y) = before;
  }
}

TEST_CASE("where a feature is unusable in more than half of the pixels around as well, it is left out") {
  OwnedFrame frame(kWidth, kHeight, {{"albedo", 3}});
  fill_random(frame, 6);
  for (int x = 20; x < 24; ++x) {
    for (int y = 1; y < 5; ++y) frame.at("albedo.variance.B", x, y) = -1.0F;
  }
  const Source source(frame.frame(), inspect(frame.frame()));
  CHECK(is_left_out(seen(source, 21, 2)));
  CHECK(variance_of_mean(source, 0, 21, 2) == Source::kNoInformation);
  CHECK(is_left_out(seen(source, 20, 2)));        // 3 of 8
  CHECK_FALSE(is_left_out(seen(source, 20, 1)));  // 5 of 8
  CHECK_FALSE(is_left_out(seen(source, 19, 1)));  // usable itself
  for (const int x : {100, 101, 102}) frame.at("albedo.R", x, 0) = kNan;
  const Source line(frame.frame(), inspect(frame.frame()));
  CHECK_FALSE(is_left_out(seen(line, 101, 0)));  // 3 of 5
}

TEST_CASE("huge features around an unusable one stay finite when squared") {
  OwnedFrame frame(kWidth, kHeight, {{"albedo", 3}});
  for (const int x : {49, 51}) frame.at("albedo.R", x, 2) = x < 50 ? 3e38F : -3e38F;
  frame.at("albedo.R", 50, 2) = kNan;
  const Source source(frame.frame(), inspect(frame.frame()));
  const Seen pixel = seen(source, 50, 2);
  CHECK(std::abs(pixel.mean[0]) <= 1e4F);
  CHECK(pixel.variance >= 1e9F);
  CHECK(pixel.variance <= 1e11F);
}

}  // namespace stein::test
