// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <utility>

#include "catch.hpp"
#include "prefilter/source.hpp"
#include "stein/error.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};

// The fill as its description reads: whole images, one ring of the hole after the other.
std::vector<std::array<double, 3>> plain_fill(const Frame& frame) {
  const auto size = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  const auto width = static_cast<std::size_t>(frame.width);
  const auto index = [&](int x, int y) { return static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x); };
  std::vector<std::array<double, 3>> image(size);
  std::vector<float> known(size);
  std::size_t unknown = 0;
  for (int y = 0; y < frame.height; ++y) {
    unknown += static_cast<std::size_t>(colour_validity_row(frame, y, 0, frame.width, &known[index(0, y)]));
    for (int x = 0; x < frame.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) image[index(x, y)][c] = frame.colour[c].at(x, y);
    }
  }
  while (unknown > 0) {
    const std::vector<std::array<double, 3>> old_image = image;
    const std::vector<float> old_known = known;
    for (int i = 0; i < frame.width * frame.height; ++i) {
      if (old_known[static_cast<std::size_t>(i)] != 0) continue;
      std::array<double, 4> sum{};
      for (int k = 0; k < 9; ++k) {
        const int x = i % frame.width + k % 3 - 1;
        const int y = i / frame.width + k / 3 - 1;
        if (x < 0 || y < 0 || x >= frame.width || y >= frame.height || old_known[index(x, y)] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += old_image[index(x, y)][c];
        sum[3] += 1;
      }
      if (sum[3] == 0) continue;
      image[static_cast<std::size_t>(i)] = {sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]};
      known[static_cast<std::size_t>(i)] = 1;
      --unknown;
    }
  }
  return image;
}

void check_against_plain_fill(const Frame& frame) {
  const std::vector<ReplacedPixel> filled = fill_invalid(frame);
  const std::vector<std::array<double, 3>> expected = plain_fill(frame);
  CHECK(static_cast<std::int64_t>(filled.size()) == inspect(frame).invalid_pixels);
  for (std::size_t i = 0; i < filled.size(); ++i) {
    const ReplacedPixel& p = filled[i];
    if (i > 0) CHECK(std::pair(filled[i - 1].y, filled[i - 1].x) < std::pair(p.y, p.x));  // row order, each once
    CHECK_FALSE(p.is_source);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(p.colour[c] == Approx(expected[static_cast<std::size_t>(p.y * frame.width + p.x)][c]).epsilon(1e-5));
    }
  }
}

}  // namespace

TEST_CASE("fill: a single invalid pixel gets the mean of its eight neighbours in all channels") {
  OwnedFrame frame(5, 4, {});
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 5; ++x)
        frame.at(kRgb[c], x, y) = static_cast<float>(100 * c) + static_cast<float>(x * x + 10 * y);
    }
  }
  frame.at("G", 2, 1) = kNan;  // R and B of the pixel are numbers, and must not be used either
  frame.at("R", 2, 1) = 1e6F;
  const std::vector<ReplacedPixel> filled = fill_invalid(frame.frame());
  REQUIRE(filled.size() == 1);
  CHECK(filled[0].x == 2);
  CHECK(filled[0].y == 1);
  CHECK_FALSE(filled[0].is_source);
  // x*x over columns 1, 2, 3 without the pixel: (3*1 + 2*4 + 3*9) / 8; 10*y over rows 0, 1, 2: 10.
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(filled[0].colour[c] == Approx(100.0 * static_cast<double>(c) + 38.0 / 8 + 10));
}

TEST_CASE("fill: every kind of invalid pixel is filled") {
  OwnedFrame frame(9, 9, {});
  frame.at("R", 1, 1) = std::numeric_limits<float>::infinity();
  frame.at("variance.G", 4, 1) = -1.0F;
  frame.at("variance.B", 7, 1) = kNan;
  frame.at("sampleCount", 1, 4) = 0.0F;
  frame.at("B", 4, 4) = -std::numeric_limits<float>::infinity();
  const std::vector<ReplacedPixel> filled = fill_invalid(frame.frame());
  REQUIRE(filled.size() == 5);
  for (const ReplacedPixel& p : filled) CHECK(p.colour == std::array<float, 3>{0.5F, 0.5F, 0.5F});
}

TEST_CASE("fill: holes are filled from the rim inwards") {
  OwnedFrame frame(23, 17, {});
  fill_random(frame, 1);
  for (int y = 3; y < 12; ++y) {
    for (int x = 4; x < 4 + y; ++x) frame.at("R", x, y) = kNan;  // nine rows high, of changing width
  }
  check_against_plain_fill(frame.frame());
}

TEST_CASE("fill: holes at the corners and borders, and a frame of scattered valid pixels") {
  OwnedFrame frame(19, 13, {});
  fill_random(frame, 2);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 6; ++x) {
      frame.at("R", x, y) = kNan;
      frame.at("G", 18 - x, 12 - y) = kNan;
    }
  }
  for (int x = 8; x < 12; ++x) frame.at("B", x, 0) = kNan;
  check_against_plain_fill(frame.frame());

  OwnedFrame sparse(31, 11, {});
  fill_random(sparse, 3);
  for (int i = 0; i < 31 * 11; ++i) {
    if (i % 47 != 5) sparse.at("sampleCount", i % 31, i / 31) = 0.0F;
  }
  check_against_plain_fill(sparse.frame());
}

TEST_CASE("fill: a symmetric hole in a symmetric image is filled symmetrically") {
  OwnedFrame frame(13, 13, {});
  for (const char* c : kRgb) {
    for (int y = 0; y < 13; ++y) {
      for (int x = 0; x < 13; ++x) {
        const int dx = std::abs(x - 6);
        const int dy = std::abs(y - 6);
        frame.at(c, x, y) = dx <= 3 && dy <= 3 ? kNan : static_cast<float>(dx * dx + dy * dy);
      }
    }
  }
  const std::vector<ReplacedPixel> filled = fill_invalid(frame.frame());
  REQUIRE(filled.size() == 49);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 7; ++x) {
      const auto at = [&](int px, int py) {
        return filled[static_cast<std::size_t>(py) * 7 + static_cast<std::size_t>(px)].colour[0];
      };
      CHECK(at(6 - x, y) == Approx(at(x, y)).epsilon(1e-6));
      CHECK(at(x, 6 - y) == Approx(at(x, y)).epsilon(1e-6));
      CHECK(at(y, x) == Approx(at(x, y)).epsilon(1e-6));
    }
  }
}

TEST_CASE("fill: one valid pixel fills the whole frame; none is an error") {
  OwnedFrame frame(7, 3, {});
  for (int i = 0; i < 21; ++i) frame.at("R", i % 7, i / 7) = kNan;
  frame.at("R", 6, 0) = 4.0F;
  const std::vector<ReplacedPixel> filled = fill_invalid(frame.frame());
  REQUIRE(filled.size() == 20);
  for (const ReplacedPixel& p : filled) CHECK(p.colour == std::array<float, 3>{4.0F, 0.5F, 0.5F});

  frame.at("R", 6, 0) = kNan;
  frame.frame().origin = "shot.exr";
  try {
    (void)fill_invalid(frame.frame());
    FAIL("a frame without a valid pixel was filled");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::kInvalidFrame);
    CHECK(std::string(error.what()).find("shot.exr") != std::string::npos);
  }
}

}  // namespace stein::test
