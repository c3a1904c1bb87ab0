// SPDX-License-Identifier: Apache-2.0
//
// Which layers are features, their channels, covariances, and what the reader says about all that.
#include <algorithm>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::Frame;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;

namespace {

bool says(const LoadedFrame& loaded, const std::string& words) {
  return std::any_of(loaded.missing().begin(), loaded.missing().end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

std::string role(const LoadedFrame& loaded, const std::string& name) {
  for (const auto& channel : loaded.channels()) {
    if (channel.name == name) return channel.role;
  }
  return "no such channel";
}

std::vector<ChannelSpec> covariances(const std::string& of, const std::string& components) {
  return layer("covariance.R." + of, components, Imf::HALF) + layer("covariance.G." + of, components, Imf::HALF) +
         layer("covariance.B." + of, components, Imf::HALF);
}

}  // namespace

TEST_CASE("a layer is a feature by its name or by its variance") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr",
             {{"", colour_channels() + layer("visibility", "V", Imf::FLOAT) + layer("roughness", "x", Imf::FLOAT) +
                       layer("roughness.variance", "x", Imf::FLOAT) + layer("left.gloss", "uv", Imf::HALF) +
                       layer("left.gloss.variance", "uv", Imf::HALF) + layer("key", "RGB", Imf::HALF) +
                       layer("crypto00", "RGBA", Imf::FLOAT) + layer("orphan.variance", "R", Imf::HALF) +
                       std::vector<ChannelSpec>{{"A", Imf::HALF}, {"Z", Imf::FLOAT}}}});
  const LoadedFrame loaded = read_frame(folder / "in.exr");
  const Frame& frame = loaded.frame();
  REQUIRE(frame.features.size() == 3);
  CHECK(frame.features[0].name == "visibility");
  CHECK(frame.features[0].variance.empty());
  CHECK(frame.features[1].name == "left.gloss");
  CHECK(holds(frame.features[1].variance[1], "left.gloss.variance.v"));
  CHECK(frame.features[2].name == "roughness");
  CHECK(frame.layers.empty());
  CHECK(role(loaded, "visibility.V") == "feature visibility, mean");
  CHECK(role(loaded, "left.gloss.variance.u") == "feature left.gloss, variance of the mean");
  CHECK(role(loaded, "variance.R") == "colour, variance of the mean");
  CHECK(role(loaded, "sampleCount") == "samples per pixel");
  CHECK(role(loaded, "key.R").empty());
  CHECK(role(loaded, "crypto00.R").empty());
  CHECK(role(loaded, "orphan.variance.R").empty());
  CHECK(role(loaded, "Z").empty());
  CHECK(loaded.channels()[0].type == "half");
  CHECK(says(loaded, "no albedo: textures guide nothing"));
  CHECK(says(loaded, "visibility.variance"));
}

TEST_CASE("alpha and colour layers come along when asked for") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr",
             {{"", colour_channels() + layer("key", "RGBA", Imf::HALF) + layer("id", "XY", Imf::HALF) +
                       layer("noisy", "RGB", Imf::HALF) + std::vector<ChannelSpec>{{"A", Imf::HALF}}}});
  const LoadedFrame loaded = read_frame(folder / "in.exr", {.layers = {"all"}});
  const std::vector<stein::Layer>& layers = loaded.frame().layers;
  REQUIRE(layers.size() == 2);
  CHECK(layers[0].name == "key");
  CHECK(holds(layers[0].mean.at(2), "key.B"));
  CHECK(layers[1].name == "A");
  CHECK(holds(layers[1].mean.at(0), "A"));
}

TEST_CASE("components come in conventional order, whatever their case") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr",
             {{"", colour_channels() + layer("albedo", "rgb", Imf::HALF) + layer("normal", "zYx", Imf::HALF) +
                       layer("tag", "qap", Imf::HALF) + layer("tag.variance", "qap", Imf::HALF)}});
  const LoadedFrame loaded = read_frame(folder / "in.exr");
  const Frame& frame = loaded.frame();
  CHECK(holds(frame.features[0].mean[0], "albedo.r"));
  CHECK(holds(frame.features[0].mean[2], "albedo.b"));
  CHECK(holds(frame.features[1].mean[0], "normal.x"));
  CHECK(holds(frame.features[1].mean[1], "normal.Y"));
  CHECK(holds(frame.features[1].mean[2], "normal.z"));
  CHECK(holds(frame.features[2].mean[0], "tag.a"));
  CHECK(holds(frame.features[2].mean[1], "tag.p"));
  CHECK(holds(frame.features[2].variance[2], "tag.variance.q"));
}

TEST_CASE("a feature's alpha is no guide") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", colour_channels() + layer("albedo", "RGBA", Imf::HALF) +
                                          layer("albedo.variance", "RGB", Imf::HALF)}});
  const LoadedFrame loaded = read_frame(folder / "in.exr");
  CHECK(loaded.frame().features[0].mean.size() == 3);
  CHECK(role(loaded, "albedo.A").empty());
}

TEST_CASE("features that are incomplete or too wide are refused") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  write_file(path,
             {{"", colour_channels() + layer("albedo", "RGB", Imf::HALF) + layer("albedo.variance", "RB", Imf::HALF)}});
  expect_error(ErrorCode::kInvalidFrame, {path, "albedo.variance.G"}, [&] { (void)read_frame(path); });
  write_file(path, {{"", colour_channels() + layer("position", "VWXYZ", Imf::HALF)}});
  expect_error(ErrorCode::kInvalidFrame, {path, "position", "5 channels"}, [&] { (void)read_frame(path); });
}

TEST_CASE("covariances") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  const auto base = colour_channels() + layer("albedo", "RGB", Imf::HALF) + layer("depth", "Z", Imf::HALF);
  const auto colour = layer("covariance.R", "GB", Imf::HALF) + layer("covariance.G", "B", Imf::HALF);
  SECTION("all") {
    write_file(path, {{"", base + colour + covariances("albedo", "RGB") + covariances("depth", "Z")}});
    const LoadedFrame loaded = read_frame(path);
    const Frame& frame = loaded.frame();
    CHECK(holds(frame.colour_covariance[0], "covariance.R.G"));
    CHECK(holds(frame.colour_covariance[1], "covariance.R.B"));
    CHECK(holds(frame.colour_covariance[2], "covariance.G.B"));
    REQUIRE(frame.features[0].colour_covariance.size() == 9);
    CHECK(holds(frame.features[0].colour_covariance[1 * 3 + 2], "covariance.G.albedo.B"));
    REQUIRE(frame.features[1].colour_covariance.size() == 3);
    CHECK(holds(frame.features[1].colour_covariance[2], "covariance.B.depth.Z"));
    CHECK_FALSE(says(loaded, "covariance"));
    CHECK(role(loaded, "covariance.G.albedo.B") == "feature albedo, covariance of the mean with the colour");
  }
  SECTION("in a part of their own") {
    write_file(path, {{"main", base},
                      {"covariance", layer("R", "GB", Imf::HALF) + layer("G", "B", Imf::HALF) +
                                         layer("R.depth", "Z", Imf::HALF) + layer("G.depth", "Z", Imf::HALF) +
                                         layer("B.depth", "Z", Imf::HALF)}});
    const LoadedFrame loaded = read_frame(path);
    CHECK(holds(loaded.frame().colour_covariance[1], "R.B"));
    REQUIRE(loaded.frame().features[1].colour_covariance.size() == 3);
    CHECK(holds(loaded.frame().features[1].colour_covariance[1], "G.depth.Z"));
  }
  SECTION("not asked for") {
    write_file(path, {{"", base + colour + covariances("albedo", "RGB") + covariances("depth", "Z")}});
    const LoadedFrame loaded = read_frame(path, {.read_covariances = false});
    CHECK_FALSE(loaded.frame().colour_covariance[0]);
    CHECK(loaded.frame().features[0].colour_covariance.empty());
  }
  SECTION("some") {
    write_file(path, {{"", base + covariances("albedo", "RGB") + covariances("depth", "Z") +
                               layer("covariance.R", "G", Imf::HALF)}});
    const LoadedFrame partial = read_frame(path);
    CHECK_FALSE(partial.frame().colour_covariance[0]);
    CHECK(says(partial, "covariances of the colour channels"));
    write_file(path, {{"", base + colour + covariances("albedo", "RG") + covariances("depth", "Z")}});
    const LoadedFrame loaded = read_frame(path);
    CHECK(loaded.frame().features[0].colour_covariance.empty());
    CHECK(says(loaded, "no covariances of the colour with albedo"));
  }
  SECTION("none") {
    write_file(path, {{"", base}});
    CHECK(says(read_frame(path), "risk is plain SURE"));
  }
}

}  // namespace fixture
