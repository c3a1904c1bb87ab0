// SPDX-License-Identifier: Apache-2.0
//
// `inspect` and `check_strict`: values that cannot be used.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "scene.hpp"
#include "stein/frame.hpp"

namespace {

using stein::BadValue;
using stein::ConstPlaneView;
using stein::Feature;
using stein::Frame;
using stein::FrameReport;

void check_equal(const BadValue& found, const std::string& plane, int x, int y) {
  CHECK(found.plane == plane);
  CHECK(found.x == x);
  CHECK(found.y == y);
}

}  // namespace

TEST_CASE("Covariances that are no number are counted once per pixel, where what they are of is usable") {
  const Scene scene;
  poke(scene.frame.colour_covariance[1], 3, 1, kNan);
  poke(scene.frame.features[0].colour_covariance[4], 3, 1, kInf);
  poke(scene.frame.features[0].colour_covariance[4], 1, 2, kInf);
  poke(scene.frame.features[0].colour_covariance[4], 2, 2, kNan);  // unusable feature
  poke(scene.frame.features[0].mean[0], 2, 2, kNan);
  poke(scene.frame.colour_covariance[0], 4, 3, kNan);  // unusable colour
  poke(scene.frame.colour[0], 4, 3, kNan);
  const FrameReport report = stein::inspect(scene.frame);
  CHECK(report.bad_covariance_pixels == 2);
  check_equal(report.first_bad_covariance, "covariance.R.B", 3, 1);
  const Scene other;
  poke(other.frame.features[0].colour_covariance[4], 1, 2, kInf);
  check_equal(stein::inspect(other.frame).first_bad_covariance, "covariance.G.normal.Y", 1, 2);
  CHECK(contains(message_of([&] { stein::check_strict(other.frame); }), "'covariance.G.normal.Y'"));
}

TEST_CASE("Covariances of a feature without variances are refused") {
  Scene scene;
  scene.frame.features[0].variance.clear();
  CHECK(contains(message_of([&] { stein::check(scene.frame); }), "covariances with the colour but no variances"));
}

TEST_CASE("Each kind of unusable colour is counted, and the first is reported") {
  struct Kind {
    std::function<ConstPlaneView(const Frame&)> plane;
    float value;
    std::string name;
  };
  const std::vector<Kind> kinds = {
      {[](const Frame& f) { return f.colour[0]; }, kNan, "R"},
      {[](const Frame& f) { return f.colour[2]; }, -kInf, "B"},
      {[](const Frame& f) { return f.colour[1]; }, 1.01e15F, "G"},
      {[](const Frame& f) { return f.colour[1]; }, -1.01e15F, "G"},
      {[](const Frame& f) { return f.colour_variance[1]; }, kNan, "variance.G"},
      {[](const Frame& f) { return f.colour_variance[2]; }, 1.01e30F, "variance.B"},
      {[](const Frame& f) { return f.colour_variance[0]; }, kInf, "variance.R"},
      {[](const Frame& f) { return f.colour_variance[2]; }, -1e-20F, "variance.B"},
      {[](const Frame& f) { return f.sample_count; }, 0.0F, "sampleCount"},
      {[](const Frame& f) { return f.sample_count; }, -1.0F, "sampleCount"},
      {[](const Frame& f) { return f.sample_count; }, kNan, "sampleCount"},
  };
  for (const Kind& kind : kinds) {
    CAPTURE(kind.name, kind.value);
    const Scene scene;
    poke(kind.plane(scene.frame), 3, 1, kind.value);
    poke(kind.plane(scene.frame), 0, 2, kind.value);
    const FrameReport report = stein::inspect(scene.frame);
    CHECK(report.invalid_pixels == 2);
    check_equal(report.first_invalid, kind.name, 3, 1);
    CHECK((report.first_invalid.value == kind.value || kind.value != kind.value));
    CHECK(report.bad_feature_pixels == std::vector<std::int64_t>{0, 0});
    const std::string message = message_of([&] { stein::check_strict(scene.frame); });
    CAPTURE(message);
    CHECK(contains(message, "'" + kind.name + "'"));
    CHECK(contains(message, "(3, 1)"));
    CHECK(contains(message, "2 pixels"));
  }
}

TEST_CASE("A pixel that is unusable in several ways counts once") {
  const Scene scene;
  for (std::size_t c = 0; c < 3; ++c) {
    poke(scene.frame.colour[c], 4, 3, kNan);
    poke(scene.frame.colour_variance[c], 4, 3, -1.0F);
  }
  poke(scene.frame.sample_count, 4, 3, 0.0F);
  const FrameReport report = stein::inspect(scene.frame);
  CHECK(report.invalid_pixels == 1);
  check_equal(report.first_invalid, "R", 4, 3);
}

TEST_CASE("Negative and very large colours and zero variances are usable") {
  const Scene scene;
  poke(scene.frame.colour[0], 0, 0, -0.5F);
  poke(scene.frame.colour[1], 1, 0, 1e15F);
  poke(scene.frame.colour_variance[1], 1, 0, 1e30F);
  poke(scene.frame.colour_variance[0], 2, 0, 0.0F);
  CHECK_NOTHROW(stein::check_strict(scene.frame));
}

TEST_CASE("Unusable feature values are counted per feature and leave the colour alone") {
  const Scene scene;
  const Feature& normal = scene.frame.features[0];
  poke(normal.variance[1], 2, 1, kNan);
  poke(normal.variance[2], 2, 1, kNan);
  poke(normal.mean[0], 1, 3, kInf);
  poke(normal.variance[0], 4, 3, -1.0F);
  poke(scene.frame.features[1].mean[0], 0, 2, kNan);
  const FrameReport report = stein::inspect(scene.frame);
  CHECK(report.invalid_pixels == 0);
  CHECK(report.bad_feature_pixels == std::vector<std::int64_t>{3, 1});
  REQUIRE(report.first_bad_feature.size() == 2);
  check_equal(report.first_bad_feature[0], "normal.variance.Y", 2, 1);
  check_equal(report.first_bad_feature[1], "depth.Z", 0, 2);
  const std::string message = message_of([&] { stein::check_strict(scene.frame); });
  CAPTURE(message);
  CHECK(contains(message, "'normal.variance.Y'"));
  CHECK(contains(message, "(2, 1)"));
  CHECK(contains(message, "3 pixels of feature 'normal'"));
}

TEST_CASE("Single samples are counted from the plane and from the uniform count") {
  Scene scene;
  poke(scene.frame.sample_count, 0, 0, 1.0F);
  poke(scene.frame.sample_count, 4, 3, 1.0F);
  CHECK(stein::inspect(scene.frame).single_sample_pixels == 2);
  scene.frame.sample_count = {};
  scene.frame.uniform_sample_count = 1;
  CHECK(stein::inspect(scene.frame).single_sample_pixels == std::int64_t{kWidth} * kHeight);
  CHECK_NOTHROW(stein::check_strict(scene.frame));
}

TEST_CASE("Rows longer than any internal block are scanned whole") {
  constexpr int kLong = 3001;
  Scene scene;
  scene.frame.features.clear();
  scene.frame.colour_covariance = {};
  scene.frame.width = kLong;
  scene.frame.height = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    scene.frame.colour[c] = scene.plane(1, kLong, 1);
    scene.frame.colour_variance[c] = scene.plane(1, kLong, 1);
  }
  scene.frame.sample_count = scene.plane(2, kLong, 1);
  for (const int x : {511, 512, 1024, 3000}) poke(scene.frame.colour[1], x, 0, kNan);
  const FrameReport report = stein::inspect(scene.frame);
  CHECK(report.invalid_pixels == 4);
  check_equal(report.first_invalid, "G", 511, 0);
}
