// SPDX-License-Identifier: Apache-2.0
#include "prefilter/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};

// Sets a grey pixel and its standard error.
void set_pixel(OwnedFrame& frame, int x, int y, float value, float error) {
  for (const char* c : kRgb) {
    frame.at(c, x, y) = value;
    frame.at(std::string("variance.") + c, x, y) = error * error;
  }
}

OwnedFrame& make_flat(OwnedFrame& frame, float value, float error) {
  for (int y = 0; y < frame.frame().height; ++y) {
    for (int x = 0; x < frame.frame().width; ++x) set_pixel(frame, x, y, value, error);
  }
  return frame;
}

OutlierReport find(const OwnedFrame& frame, const OutlierParams& params = {}, int threads = 1) {
  Execution execution;
  execution.threads = threads;
  exec::Runner runner(execution);
  const Source source(frame.frame(), inspect(frame.frame()));
  return find_outliers(source, params, runner);
}

// Outliers of a 5x5 image of 1 with standard error 0.1 and one pixel at (2, 2).
OutlierReport find_one(float value, float error, const OutlierParams& params = {}) {
  OwnedFrame frame(5, 5, {});
  set_pixel(make_flat(frame, 1.0F, 0.1F), 2, 2, value, error);
  return find(frame, params);
}

double mean_of(const ReplacedPixel& p) { return (p.colour[0] + p.colour[1] + p.colour[2]) / 3.0; }

}  // namespace

TEST_CASE("outliers: a flat image has none") {
  OwnedFrame frame(20, 10, {});
  CHECK(find(frame).pixels.empty());
  CHECK(find(frame).removed == 0.0);
}

TEST_CASE("outliers: a pixel must exceed its brightest neighbour by more than that neighbour's error") {
  CHECK(find_one(1.19F, 1.0F).pixels.empty());
  REQUIRE(find_one(1.21F, 1.0F).pixels.size() == 1);
  OutlierParams params;
  params.excess = 5.0F;
  CHECK(find_one(1.49F, 1.0F, params).pixels.empty());
  CHECK(find_one(1.51F, 1.0F, params).pixels.size() == 1);
}

TEST_CASE("outliers: a pixel that its own samples support is none") {
  CHECK(find_one(2.99F, 1.0F).pixels.size() == 1);
  CHECK(find_one(3.01F, 1.0F).pixels.empty());
  OutlierParams params;
  params.support = 0.5F;
  CHECK(find_one(1.49F, 1.0F, params).pixels.size() == 1);
  CHECK(find_one(1.51F, 1.0F, params).pixels.empty());
}

TEST_CASE("outliers: errors of few degrees of freedom support less") {
  OwnedFrame frame(5, 5, {});
  set_pixel(make_flat(frame, 1.0F, 0.1F), 2, 2, 3.9F, 1.0F);  // 2.9 standard errors above the others
  CHECK(find(frame).pixels.empty());
  frame.frame().degrees_of_freedom = 4;  // 3 are needed
  CHECK(find(frame).pixels.size() == 1);
  frame.frame().degrees_of_freedom = 5;  // 2.8
  CHECK(find(frame).pixels.empty());
}

TEST_CASE("outliers: the brightest neighbour decides, in any of the eight places") {
  for (int place = 0; place < 9; ++place) {
    if (place == 4) continue;
    const int x = 1 + place % 3;
    const int y = 1 + place / 3;
    OwnedFrame frame(5, 5, {});
    // Its own error is small, so that it is itself supported against the rest.
    set_pixel(make_flat(frame, 1.0F, 0.1F), x, y, 2.0F, 0.25F);
    set_pixel(frame, 2, 2, 2.49F, 5.0F);
    CHECK(find(frame).pixels.empty());
    set_pixel(frame, 2, 2, 2.51F, 5.0F);
    const OutlierReport report = find(frame);
    REQUIRE(report.pixels.size() == 1);
    CHECK(mean_of(report.pixels[0]) == Approx(2.0));
  }
}

TEST_CASE("outliers: the pixel is scaled to its brightest neighbour and keeps its hue; what that takes is reported") {
  OwnedFrame frame(6, 4, {});
  make_flat(frame, 1.0F, 0.1F);
  constexpr std::array<float, 3> kColour = {12.0F, 3.0F, 0.0F};
  for (std::size_t c = 0; c < 3; ++c) {
    frame.at(kRgb[c], 3, 1) = kColour[c];
    frame.at(std::string("variance.") + kRgb[c], 3, 1) = 2.0F * kColour[c] * kColour[c];
  }
  const OutlierReport report = find(frame);
  REQUIRE(report.pixels.size() == 1);
  CHECK(report.pixels[0].x == 3);
  CHECK(report.pixels[0].y == 1);
  CHECK(report.pixels[0].is_source);
  for (std::size_t c = 0; c < 3; ++c) CHECK(report.pixels[0].colour[c] == Approx(kColour[c] / 5.0));
  CHECK(report.removed == Approx(15.0 - 3.0));
}

// Without the one path that made it bright, the pixel would be a standard error less.
TEST_CASE("outliers: the response is the slope from a pixel with a bright path less") {
  OutlierParams params;
  params.support = 5.0F;
  const auto response = [&](float value, float error) {
    const OutlierReport report = find_one(value, error, params);  // neighbours of 1
    REQUIRE(report.pixels.size() == 1);
    return report.pixels[0].response;
  };
  CHECK(response(5.0F, 4.0F) == Approx(0.0));  // from 1 to 1
  CHECK(response(5.0F, 4.5F) == Approx(0.5 / 4.5));
  CHECK(response(5.0F, 2.5F) == Approx(-1.5 / 2.5));  // from 2.5, which would be left alone, to 1
  CHECK(response(5.0F, 1.0F) == -1.0F);
}

TEST_CASE("outliers: what is removed sums over all of them, in row order") {
  OwnedFrame frame(20, 10, {});
  make_flat(frame, 1.0F, 0.1F);
  set_pixel(frame, 15, 2, 4.0F, 10.0F);
  set_pixel(frame, 3, 2, 6.0F, 10.0F);
  set_pixel(frame, 8, 7, 11.0F, 10.0F);
  const OutlierReport report = find(frame);
  REQUIRE(report.pixels.size() == 3);
  CHECK(report.pixels[0].x == 3);
  CHECK(report.pixels[1].x == 15);
  CHECK(report.pixels[2].x == 8);
  CHECK(report.removed == Approx(3.0 * (3 + 5 + 10)));
}

TEST_CASE("outliers: an invalid neighbour neither protects nor hides a pixel, and is none itself") {
  OwnedFrame frame(5, 5, {});
  set_pixel(make_flat(frame, 1.0F, 0.1F), 2, 2, 2.6F, 1.0F);
  set_pixel(frame, 3, 2, 100.0F, 80.0F);
  frame.at("sampleCount", 3, 2) = 0.0F;  // would be the brightest neighbour; its fill, too, is above 1
  frame.at("R", 1, 1) = std::numeric_limits<float>::quiet_NaN();
  const OutlierReport report = find(frame);
  REQUIRE(report.pixels.size() == 1);
  CHECK(report.pixels[0].x == 2);
  CHECK(report.pixels[0].y == 2);
  CHECK(mean_of(report.pixels[0]) == Approx(1.0));
}

TEST_CASE("outliers: pixels at the borders and corners have fewer neighbours") {
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(6, 0), std::pair(0, 4), std::pair(6, 4), std::pair(3, 0),
                             std::pair(3, 4), std::pair(0, 2), std::pair(6, 2)}) {
    OwnedFrame frame(7, 5, {});
    set_pixel(make_flat(frame, 1.0F, 0.1F), x, y, 2.0F, 1.0F);
    const OutlierReport report = find(frame);
    REQUIRE(report.pixels.size() == 1);
    CHECK(report.pixels[0].x == x);
    CHECK(report.pixels[0].y == y);
    CHECK(mean_of(report.pixels[0]) == Approx(1.0));
  }
}

TEST_CASE("outliers: without a valid neighbour there is nothing to compare with") {
  OwnedFrame one(1, 1, {});
  set_pixel(one, 0, 0, 50.0F, 100.0F);
  CHECK(find(one).pixels.empty());
  OwnedFrame frame(5, 5, {});
  set_pixel(make_flat(frame, 1.0F, 0.1F), 2, 2, 2.0F, 1.0F);
  for (int i = 0; i < 9; ++i) {
    if (i != 4) frame.at("sampleCount", 1 + i % 3, 1 + i / 3) = 0.0F;
  }
  CHECK(find(frame).pixels.empty());
}

TEST_CASE("outliers: two bright pixels side by side support each other") {
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1), std::pair(-1, 1)}) {
    OwnedFrame frame(7, 7, {});
    make_flat(frame, 1.0F, 0.1F);
    set_pixel(frame, 3, 3, 2.5F, 1.0F);
    set_pixel(frame, 3 + dx, 3 + dy, 2.5F, 1.0F);
    CHECK(find(frame).pixels.empty());
    set_pixel(frame, 3, 3, 2.8F, 1.0F);
    CHECK(find(frame).pixels.empty());
    set_pixel(frame, 3 + 2 * dx, 3 + 2 * dy, 2.5F, 1.0F);  // a line of three
    CHECK(find(frame).pixels.empty());
  }
}

TEST_CASE("outliers: a tall image, looked at in bands of rows, has those of the same image lying on its side") {
  constexpr int kLength = 83;
  OwnedFrame tall(7, kLength, {});
  OwnedFrame wide(kLength, 7, {});
  make_flat(tall, 1.0F, 0.1F);
  make_flat(wide, 1.0F, 0.1F);
  Random random(9);
  for (int i = 0; i < kLength; ++i) {
    for (int k = 0; k < 7; ++k) {
      const float value = static_cast<float>(1.0 + 2.0 * random.uniform());
      set_pixel(tall, k, i, value, 1.0F);
      set_pixel(wide, i, k, value, 1.0F);
    }
  }
  OutlierParams params;
  params.excess = 0.1F;
  const OutlierReport down = find(tall, params);
  const OutlierReport across = find(wide, params);
  CHECK(down.pixels.size() > 20);
  REQUIRE(down.pixels.size() == across.pixels.size());
  CHECK(down.removed == Approx(across.removed));
  int before = -1;
  for (const ReplacedPixel& p : down.pixels) {
    CHECK(p.y * 7 + p.x > before);
    before = p.y * 7 + p.x;
    CHECK(std::any_of(across.pixels.begin(), across.pixels.end(),
                      [&](const ReplacedPixel& q) { return q.x == p.y && q.y == p.x && q.colour == p.colour; }));
  }
}

TEST_CASE("outliers: 1 and 3 threads find the same") {
  OwnedFrame frame(97, 61, {});
  fill_random(frame, 4);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const int x = static_cast<int>(97 * random.uniform());
    const int y = static_cast<int>(61 * random.uniform());
    set_pixel(frame, x, y, static_cast<float>(2.0 + 20.0 * random.uniform()), 30.0F);
  }
  frame.at("R", 40, 30) = std::numeric_limits<float>::quiet_NaN();
  const OutlierReport one = find(frame, {}, 1);
  const OutlierReport three = find(frame, {}, 3);
  CHECK(one.pixels.size() > 50);
  REQUIRE(one.pixels.size() == three.pixels.size());
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    CHECK(one.pixels[i].x == three.pixels[i].x);
    CHECK(one.pixels[i].y == three.pixels[i].y);
    CHECK(one.pixels[i].colour == three.pixels[i].colour);
  }
  CHECK(one.removed == three.removed);
}

}  // namespace stein::test
