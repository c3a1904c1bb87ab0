// SPDX-License-Identifier: Apache-2.0
//
// What errors are relative to.
#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "pipeline/surroundings.hpp"
#include "stein/denoise.hpp"
#include "support/same_bits.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// Of what is above 0 in the 11x11 pixels around one, without that one.
template <class Value>
double mean_around(int width, int height, int x, int y, const Value& value) {
  double sum = 0;
  int count = 0;
  for (int v = std::max(y - 5, 0); v <= std::min(y + 5, height - 1); ++v) {
    for (int u = std::max(x - 5, 0); u <= std::min(x + 5, width - 1); ++u) {
      if (u == x && v == y) continue;
      sum += std::max(static_cast<double>(value(u, v)), 0.0);
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

Plane random_plane(int width, int height, std::uint64_t seed) {
  Plane plane(width, height);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) plane.row(y)[x] = static_cast<float>(random.normal());
  }
  return plane;
}

}  // namespace

TEST_CASE("mean around: that of the square in the image without the pixel, whatever the part of the row") {
  for (const int width : {1, 2, 7, 40}) {
    for (const int height : {1, 3, 13}) {
      const Plane plane = random_plane(width, height, 7);
      for (int y = 0; y < height; ++y) {
        std::vector<const float*> rows;
        for (int v = std::max(y - 5, 0); v <= std::min(y + 5, height - 1); ++v) rows.push_back(plane.row(v));
        const RowsAround around{rows.data(), static_cast<int>(rows.size()), width};
        std::vector<float> whole(static_cast<std::size_t>(width));
        std::vector<float> columns(static_cast<std::size_t>(width) + 10);
        mean_around_row(around, plane.row(y), 0, width, columns.data(), whole.data());
        for (int x = 0; x < width; ++x) {
          const double expected = mean_around(width, height, x, y, [&](int u, int v) { return plane.row(v)[u]; });
          CHECK(whole[static_cast<std::size_t>(x)] == Approx(expected).margin(1e-5));
          float one = -1.0F;
          mean_around_row(around, plane.row(y), x, 1, columns.data(), &one);
          CHECK(one == whole[static_cast<std::size_t>(x)]);
        }
      }
    }
  }
}

TEST_CASE("mean around: a pixel that is far larger than all around it leaves no trace") {
  Plane plane(11, 11);
  std::vector<const float*> rows;
  for (int y = 0; y < 11; ++y) {
    std::fill_n(plane.row(y), 11, 1.0F);
    rows.push_back(plane.row(y));
  }
  plane.row(5)[5] = 1e20F;
  std::vector<float> columns(21);
  std::vector<float> out(11);
  mean_around_row({rows.data(), 11, 11}, plane.row(5), 0, 11, columns.data(), out.data());
  CHECK(out[5] == 1.0F);
  CHECK(out[4] > 1e17F);
}

// Of the input as the result, the divergence is the variance, and so are its risk and its error.
TEST_CASE("relative error: relative to the square of the result, or three times the error around, whatever the tiles") {
  constexpr int kWidth = 150;
  constexpr int kHeight = 203;
  OwnedFrame owned(kWidth, kHeight, {});
  Random random(5);
  for (const char* c : {"R", "G", "B"}) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        owned.at(c, x, y) = static_cast<float>(0.3 * random.uniform());
        owned.at(std::string("variance.") + c, x, y) = static_cast<float>(0.1 * random.uniform());
      }
    }
  }
  DenoiseParams params;
  params.filters = {CrossBilateralParams{}};
  params.strength = 0.0F;
  params.outliers.enabled = false;
  const Frame& frame = owned.frame();
  const auto relative_to = [&](std::size_t c, int x, int y) {
    const double around =
        mean_around(kWidth, kHeight, x, y, [&](int u, int v) { return frame.colour_variance[c].at(u, v); });
    return std::max(std::pow(frame.colour[c].at(x, y), 2) + 0.01, 3.0 * around);
  };
  const DenoiseResult result = denoise(frame, params);
  double expected = 0;
  double by_squares = 0;
  double told = 0;  // of the pixels' errors
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double variance = frame.colour_variance[c].at(x, y) / (3.0 * kWidth * kHeight);
        expected += variance / relative_to(c, x, y);
        by_squares += variance / (std::pow(frame.colour[c].at(x, y), 2) + 0.01);
        told += result.error[c].row(y)[x] / relative_to(c, x, y) / (3.0 * kWidth * kHeight);
      }
    }
  }
  REQUIRE(by_squares > 1.5 * expected);
  CHECK(result.report.mean_relative_error == Approx(expected).epsilon(1e-4));
  CHECK(told == Approx(expected).epsilon(0.05));  // but for what lies between the centres of bins
  for (const int threads : {1, 3}) {
    params.execution.threads = threads;
    params.execution.tile_width = 16;
    params.execution.tile_height = 3;
    const DenoiseResult other = denoise(frame, params);
    CHECK(same_errors(other.report, result.report));
    for (std::size_t c = 0; c < 3; ++c) CHECK(same_bits(other.error[c], result.error[c]));
  }
}

}  // namespace stein::test
