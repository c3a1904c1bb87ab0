// SPDX-License-Identifier: Apache-2.0
//
// `check`: the structure of a frame.
#include "stein/frame.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "scene.hpp"

namespace {

using stein::ConstPlaneView;
using stein::Feature;
using stein::Frame;
using stein::FrameReport;

/// Breaks a valid scene and requires that `check` names all the parts.
void require_refused(const std::function<void(Scene&)>& damage, const std::vector<std::string_view>& parts) {
  Scene scene;
  damage(scene);
  const std::string message = message_of([&] { stein::check(scene.frame); });
  CAPTURE(message);
  REQUIRE_FALSE(message.empty());
  for (const std::string_view part : parts) {
    CAPTURE(part);
    CHECK(contains(message, part));
  }
  CHECK(message_of([&] { static_cast<void>(stein::inspect(scene.frame)); }) == message);
  CHECK(message_of([&] { stein::check_strict(scene.frame); }) == message);
}

}  // namespace

TEST_CASE("A complete frame is clean") {
  const Scene scene;
  CHECK_NOTHROW(stein::check(scene.frame));
  CHECK_NOTHROW(stein::check_strict(scene.frame));
  const FrameReport report = stein::inspect(scene.frame);
  CHECK(report.invalid_pixels == 0);
  CHECK(report.bad_feature_pixels == std::vector<std::int64_t>{0, 0});
  CHECK(report.single_sample_pixels == 0);
}

TEST_CASE("Features, covariances and the count plane are optional") {
  Scene scene;
  scene.frame.features.clear();
  scene.frame.colour_covariance = {};
  scene.frame.sample_count = {};
  scene.frame.uniform_sample_count = 4;
  CHECK_NOTHROW(stein::check_strict(scene.frame));
}

TEST_CASE("The size of the frame must be usable") {
  require_refused([](Scene& s) { s.frame.width = 0; }, {"0x4"});
  require_refused([](Scene& s) { s.frame.height = -3; }, {"5x-3"});
  require_refused([](Scene& s) { s.frame.width = 2'000'000; }, {"2000000x4"});
}

TEST_CASE("Missing colour planes are named") {
  require_refused([](Scene& s) { s.frame.colour[1] = {}; }, {"'G'", "missing"});
  require_refused([](Scene& s) { s.frame.colour_variance[2] = {}; },
                  {"'variance.B'", "missing", "sample variance / n"});
  require_refused([](Scene& s) { s.frame.colour_covariance[1] = {}; }, {"'covariance.R.B'", "all three", "none"});
}

TEST_CASE("Planes of another size are named with both sizes") {
  const auto wrong = [](Scene& s) { return s.plane(1, kWidth, kHeight + 1); };
  const std::vector<std::pair<std::function<ConstPlaneView&(Frame&)>, std::string_view>> planes = {
      {[](Frame& f) -> ConstPlaneView& { return f.colour[0]; }, "'R'"},
      {[](Frame& f) -> ConstPlaneView& { return f.colour_variance[1]; }, "'variance.G'"},
      {[](Frame& f) -> ConstPlaneView& { return f.colour_covariance[2]; }, "'covariance.G.B'"},
      {[](Frame& f) -> ConstPlaneView& { return f.sample_count; }, "'sampleCount'"},
      {[](Frame& f) -> ConstPlaneView& { return f.features[0].mean[1]; }, "'normal.Y'"},
      {[](Frame& f) -> ConstPlaneView& { return f.features[0].variance[2]; }, "'normal.variance.Z'"},
      {[](Frame& f) -> ConstPlaneView& { return f.features[0].colour_covariance[4]; }, "'covariance.G.normal.Y'"},
      {[](Frame& f) -> ConstPlaneView& { return f.features[1].mean[0]; }, "'depth.Z'"},
  };
  for (const auto& plane : planes) {
    require_refused([&](Scene& s) { plane.first(s.frame) = wrong(s); }, {plane.second, "5x5", "5x4"});
  }
  require_refused(
      [&](Scene& s) {
        s.frame.layers = {{"key", {s.plane(1), wrong(s), s.plane(1)}}};
      },
      {"'key.G'", "5x5"});
  require_refused([&](Scene& s) { s.frame.layers = {{"key", {s.plane(1), {}, s.plane(1)}}}; }, {"'key.G'", "missing"});
  require_refused([&](Scene& s) { s.frame.layers = {{"A", {wrong(s)}}}; }, {"'A'", "5x5"});
}

TEST_CASE("Layers must be named once, with one channel or three") {
  const auto refuse = [](const std::vector<std::pair<std::string, std::size_t>>& layers,
                         const std::vector<std::string_view>& parts) {
    require_refused(
        [&](Scene& s) {
          for (const auto& [name, channels] : layers)
            s.frame.layers.push_back({name, std::vector<ConstPlaneView>(channels, s.plane(1))});
        },
        parts);
  };
  refuse({{"key", 0}}, {"'key'", "0 channels"});
  refuse({{"key", 2}}, {"'key'", "2 channels"});
  refuse({{"key", 4}}, {"'key'", "4 channels"});
  refuse({{"", 1}}, {"no name"});
  refuse({{"key", 3}, {"key", 1}}, {"'key'", "unique"});
}

TEST_CASE("The number of samples must be known") {
  for (const float n : {0.0F, 0.5F, -1.0F, kNan, kInf}) {
    CAPTURE(n);
    require_refused(
        [n](Scene& s) {
          s.frame.sample_count = {};
          s.frame.uniform_sample_count = n;
        },
        {"sampleCount", "uniform"});
  }
}

TEST_CASE("Features must be named once, with matching channel lists") {
  require_refused([](Scene& s) { s.frame.features[1].name = "normal"; }, {"'normal'", "unique"});
  require_refused([](Scene& s) { s.frame.features[1].name.clear(); }, {"no name"});
  require_refused([](Scene& s) { s.frame.features[1].mean.clear(); }, {"'depth'", "0 channels"});
  require_refused([](Scene& s) { s.frame.features[1].mean.assign(5, s.frame.features[1].mean[0]); },
                  {"'depth'", "5 channels"});
  require_refused([](Scene& s) { s.frame.features[0].variance.pop_back(); }, {"'normal'", "3 means", "2 variances"});
  require_refused([](Scene& s) { s.frame.features[0].colour_covariance.pop_back(); }, {"'normal'", "8 covariances"});
  require_refused([](Scene& s) { s.frame.features[0].mean[2] = {}; }, {"'normal.Z'", "missing"});
  require_refused([](Scene& s) { s.frame.features[0].variance[0] = {}; }, {"'normal.variance.X'", "missing"});
  require_refused([](Scene& s) { s.frame.features[0].colour_covariance[6] = {}; },
                  {"'covariance.B.normal.X'", "missing"});
}

TEST_CASE("Messages name the origin of the frame") {
  require_refused(
      [](Scene& s) {
        s.frame.origin = "shot.0042.exr";
        s.frame.colour[0] = {};
      },
      {"'shot.0042.exr': "});
}

TEST_CASE("Planes are named as in files") {
  const auto name = [](const std::string& feature, std::size_t channels, std::size_t channel, bool is_variance) {
    return stein::plane_name(Feature{feature, std::vector<ConstPlaneView>(channels), {}, {}}, channel, is_variance);
  };
  CHECK(name("normal", 3, 0, false) == "normal.X");
  CHECK(name("normal", 3, 2, true) == "normal.variance.Z");
  CHECK(name("albedo", 3, 1, true) == "albedo.variance.G");
  CHECK(name("depth", 1, 0, false) == "depth.Z");
  CHECK(name("visibility", 1, 0, true) == "visibility.variance.V");
  CHECK(name("custom", 4, 3, false) == "custom.W");
}
