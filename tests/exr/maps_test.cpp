// SPDX-License-Identifier: Apache-2.0
//
// What the caller says of channels.
#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::Frame;
using stein::exr::LoadedFrame;
using stein::exr::PlaneMap;
using stein::exr::read_frame;

TEST_CASE("what the caller says stands above the schema") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  write_file(path, {{"", fixture::native_channels() + layer("Beauty", "RGB", Imf::FLOAT) +
                             layer("Noise", "RGB", Imf::FLOAT) + std::vector<ChannelSpec>{{"spp", Imf::FLOAT}}}});
  const PlaneMap colour{"colour", {"Beauty.R", "Beauty.G", "Beauty.B"}, {"Noise.R", "Noise.G", "Noise.B"}};
  const PlaneMap albedo{"albedo", {"Beauty.G", "normal.X"}, {}};
  const LoadedFrame loaded = read_frame(path, {.maps = {colour, albedo, {"samples", {"spp"}, {}}}});
  CHECK(holds(loaded.frame().colour[1], "Beauty.G"));
  CHECK(holds(loaded.frame().colour_variance[2], "Noise.B"));
  CHECK(holds(loaded.frame().sample_count, "spp"));
  REQUIRE(loaded.frame().features.at(0).mean.size() == 2);
  CHECK(loaded.frame().features.at(0).variance.empty());
  expect_error(ErrorCode::kInvalidArgument, {path, "Glow.R", "Beauty.B"}, [&] {
    (void)read_frame(path, {.maps = {{"glow", {"Glow.R"}, {}}}});
  });
  expect_error(ErrorCode::kInvalidArgument, {"colour", "2 channels"}, [&] {
    (void)read_frame(path, {.maps = {{"colour", {"R", "G"}, {}}}});
  });
  expect_error(ErrorCode::kInvalidArgument, {"povray", "pbrt"}, [&] { (void)read_frame(path, {.preset = "povray"}); });
  expect_error(ErrorCode::kInvalidArgument, {path, "cycles"}, [&] { (void)read_frame(path, {.preset = "cycles"}); });
}

TEST_CASE("covariances are of the file's own colour") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  std::vector<ChannelSpec> channels = colour_channels() + layer("Beauty", "RGB", Imf::FLOAT) +
                                      layer("Noise", "RGB", Imf::FLOAT) + layer("depth", "Z", Imf::FLOAT) +
                                      layer("depth.variance", "Z", Imf::FLOAT);
  for (const char* name : {"R.G", "R.B", "G.B", "R.depth.Z", "G.depth.Z", "B.depth.Z"})
    channels.push_back({"covariance." + std::string(name), Imf::FLOAT});
  write_file(path, {{"", channels}});
  const auto has_covariances = [](const Frame& frame) {
    return frame.colour_covariance[0] && !frame.features.at(0).colour_covariance.empty();
  };
  CHECK(has_covariances(read_frame(path).frame()));
  PlaneMap colour{"colour", {"Beauty.R", "Beauty.G", "Beauty.B"}, {}};
  CHECK(has_covariances(read_frame(path, {.maps = {colour}}).frame()));
  colour.variance = {"Noise.R", "Noise.G", "Noise.B"};
  const LoadedFrame loaded = read_frame(path, {.maps = {colour}});
  CHECK_FALSE(loaded.frame().colour_covariance[0]);
  CHECK(loaded.frame().features.at(0).colour_covariance.empty());
  CHECK(loaded.frame().features.at(0).variance.size() == 1);
}

}  // namespace fixture
