// SPDX-License-Identifier: Apache-2.0
//
// Where the planes come from: types, parts, tiles, windows, attributes.
#include <ImfChromaticitiesAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfStandardAttributes.h>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::Frame;
using stein::ScalarType;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;

namespace {

void check_colour(const Frame& frame) {
  REQUIRE(frame.width == 23);
  REQUIRE(frame.height == 13);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    CHECK(holds(frame.colour[c], name));
    CHECK(holds(frame.colour_variance[c], "variance." + name));
  }
  CHECK(holds(frame.sample_count, "sampleCount"));
}

void check_native(const Frame& frame) {
  check_colour(frame);
  REQUIRE(frame.features.size() == 3);
  CHECK(frame.features[0].name == "albedo");
  CHECK(frame.features[1].name == "normal");
  CHECK(frame.features[2].name == "depth");
  CHECK(holds(frame.features[0].mean[0], "albedo.R"));
  CHECK(holds(frame.features[0].mean[1], "albedo.G"));
  CHECK(holds(frame.features[0].mean[2], "albedo.B"));
  CHECK(holds(frame.features[0].variance[2], "albedo.variance.B"));
  CHECK(holds(frame.features[1].mean[2], "normal.Z"));
  CHECK(holds(frame.features[2].variance[0], "depth.variance.Z"));
}

}  // namespace

TEST_CASE("planes keep the file's types") {
  const TemporaryFolder folder;
  const auto type = GENERATE(Imf::HALF, Imf::FLOAT, Imf::UINT);
  write_file(folder / "in.exr", {{"", colour_channels(type)}});
  const LoadedFrame loaded = read_frame(folder / "in.exr");
  const ScalarType expected = type == Imf::HALF   ? ScalarType::kFloat16
                              : type == Imf::UINT ? ScalarType::kUint32
                                                  : ScalarType::kFloat32;
  CHECK(loaded.frame().colour[0].type() == expected);
  CHECK(holds(loaded.frame().colour[1], "G"));
  CHECK(holds(loaded.frame().colour_variance[2], "variance.B"));
  CHECK(loaded.frame().sample_count.type() == ScalarType::kUint32);
  CHECK(holds(loaded.frame().sample_count, "sampleCount"));
  CHECK(loaded.frame().origin == folder / "in.exr");
  CHECK(loaded.path() == folder / "in.exr");
}

TEST_CASE("every storage and compression gives the same frame") {
  const TemporaryFolder folder;
  const auto storage = GENERATE(Storage::kScanlines, Storage::kTiles, Storage::kMipmap);
  const auto compression = GENERATE(Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                    Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION);
  const std::array<int, 4> window = {-7, -40, 15, -28};
  write_file(folder / "in.exr", {{"", native_channels(), window, storage, compression}});
  const LoadedFrame loaded = read_frame(folder / "in.exr");
  check_native(loaded.frame());
  CHECK(loaded.data_window() == window);
}

TEST_CASE("rows stored from the bottom are read the right way up") {
  const TemporaryFolder folder;
  PartSpec part{"", native_channels()};
  part.edit = [](Imf::Header& header) { header.lineOrder() = Imf::DECREASING_Y; };
  // The file's own order of writing follows the header, so a whole-image frame buffer serves both orders.
  write_file(folder / "in.exr", {part});
  check_native(read_frame(folder / "in.exr").frame());
}

TEST_CASE("a loaded frame can be moved and its views stay valid") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", native_channels()}});
  LoadedFrame first = read_frame(folder / "in.exr");
  LoadedFrame second = std::move(first);
  LoadedFrame third;
  third = std::move(second);
  check_native(third.frame());
}

TEST_CASE("layers may be parts") {
  const TemporaryFolder folder;
  SECTION("a part per layer, bare components") {
    // value_of goes by the channel's own name, so only structure and first planes are compared here.
    write_file(folder / "in.exr", {{"albedo", layer("", "RGB", Imf::HALF)},
                                   {"albedo.variance", layer("", "RGB", Imf::HALF)},
                                   {"beauty", layer("", "RGB", Imf::FLOAT)},
                                   {"variance", layer("", "RGB", Imf::FLOAT)},
                                   {"depth", layer("", "Z", Imf::FLOAT) + layer("variance", "Z", Imf::FLOAT)},
                                   {"count", {{"sampleCount", Imf::UINT}}, {0, 0, 22, 12}, Storage::kTiles}});
    const LoadedFrame loaded = read_frame(folder / "in.exr");
    const Frame& frame = loaded.frame();
    CHECK(frame.colour[0].type() == ScalarType::kFloat32);
    CHECK(holds(frame.colour[0], "R"));
    CHECK(holds(frame.colour_variance[1], "G"));
    CHECK(holds(frame.sample_count, "sampleCount"));
    REQUIRE(frame.features.size() == 2);
    CHECK(frame.features[0].mean[0].type() == ScalarType::kFloat16);
    CHECK(frame.features[0].variance.size() == 3);
    CHECK(frame.features[1].name == "depth");
    CHECK(holds(frame.features[1].mean[0], "Z"));
    CHECK(holds(frame.features[1].variance[0], "variance.Z"));
    CHECK(loaded.channels()[0].part == "albedo");
    CHECK(loaded.channels()[0].role == "feature albedo, mean");
    CHECK(loaded.channels()[3].role == "feature albedo, variance of the mean");
  }
  SECTION("parts that group full names") {
    write_file(folder / "in.exr",
               {{"main", colour_channels()},
                {"guides", layer("albedo", "RGB", Imf::HALF) + layer("normal", "XYZ", Imf::HALF) +
                               layer("depth", "Z", Imf::FLOAT)},
                {"noise", layer("albedo.variance", "RGB", Imf::HALF) + layer("normal.variance", "XYZ", Imf::HALF) +
                              layer("depth.variance", "Z", Imf::FLOAT)}});
    check_native(read_frame(folder / "in.exr").frame());
  }
  SECTION("a part per layer with full names") {
    write_file(folder / "in.exr",
               {{"main", colour_channels()},
                {"albedo", layer("albedo", "RGB", Imf::HALF) + layer("albedo.variance", "RGB", Imf::HALF)},
                {"normal", layer("normal", "XYZ", Imf::HALF) + layer("normal.variance", "XYZ", Imf::HALF)},
                {"depth", layer("depth", "Z", Imf::FLOAT) + layer("depth.variance", "Z", Imf::FLOAT)}});
    check_native(read_frame(folder / "in.exr").frame());
  }
  SECTION("the other eye is another image") {
    const auto view = [](const char* name) { return [name](Imf::Header& header) { header.setView(name); }; };
    write_file(
        folder / "in.exr",
        {{"left", colour_channels(), {0, 0, 22, 12}, Storage::kScanlines, Imf::ZIP_COMPRESSION, view("left")},
         {"right", colour_channels(), {0, 0, 22, 12}, Storage::kScanlines, Imf::ZIP_COMPRESSION, view("right")}});
    const LoadedFrame loaded = read_frame(folder / "in.exr");
    CHECK(loaded.frame().features.empty());
    CHECK(loaded.channels()[7].part == "right");
    CHECK(loaded.channels()[7].role.empty());
  }
}

TEST_CASE("a feature with another data window is refused, an unrelated part is not") {
  const TemporaryFolder folder;
  const std::string name = GENERATE("albedo", "matte");
  write_file(folder / "in.exr", {{"main", colour_channels()}, {name, layer("", "RGB", Imf::HALF), {0, 0, 10, 10}}});
  if (name == "matte") {
    CHECK(read_frame(folder / "in.exr").frame().features.empty());
    CHECK(read_frame(folder / "in.exr", {.layers = {"all"}}).frame().layers.empty());
  } else {
    expect_error(ErrorCode::kInvalidFrame, {"in.exr", "albedo", "data window"},
                 [&] { (void)read_frame(folder / "in.exr"); });
  }
}

TEST_CASE("chromaticities give luminance and the way to Rec. 709") {
  const TemporaryFolder folder;
  PartSpec part{"", colour_channels()};
  SECTION("none: Rec. 709") {
    write_file(folder / "in.exr", {part});
    const LoadedFrame loaded = read_frame(folder / "in.exr");
    CHECK(loaded.luminance_weights() == std::array<float, 3>{0.2126F, 0.7152F, 0.0722F});
    CHECK(loaded.to_rec709() == std::array<float, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  }
  SECTION("P3 with D65") {
    part.edit = [](Imf::Header& header) {
      Imf::addChromaticities(header, {{0.680F, 0.320F}, {0.265F, 0.690F}, {0.150F, 0.060F}, {0.3127F, 0.3290F}});
    };
    write_file(folder / "in.exr", {part});
    const LoadedFrame loaded = read_frame(folder / "in.exr");
    const std::array<double, 3> weights = {0.22897, 0.69174, 0.07929};
    // Rows: what the red, green and blue of Rec. 709 take from P3's.
    const std::array<double, 9> matrix = {1.22494, -0.22494, 0, -0.04206, 1.04206, 0, -0.01964, -0.07864, 1.09828};
    for (std::size_t i = 0; i < 3; ++i) CHECK(loaded.luminance_weights()[i] == Approx(weights[i]).margin(2e-4));
    for (std::size_t i = 0; i < 9; ++i) CHECK(loaded.to_rec709()[i] == Approx(matrix[i]).margin(2e-4));
  }
  SECTION("all in one point") {
    part.edit = [](Imf::Header& header) { Imf::addChromaticities(header, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}); };
    write_file(folder / "in.exr", {part});
    expect_error(ErrorCode::kInvalidFrame, {"in.exr", "chromaticities"}, [&] { (void)read_frame(folder / "in.exr"); });
  }
}

TEST_CASE("sample counts: channel, then attribute, then option, then an error") {
  const TemporaryFolder folder;
  auto channels = colour_channels();
  PartSpec part{"", channels};
  part.edit = [](Imf::Header& header) { header.insert("samplesPerPixel", Imf::IntAttribute(16)); };
  write_file(folder / "channel.exr", {part});
  part.channels.pop_back();
  write_file(folder / "int.exr", {part});
  part.edit = [](Imf::Header& header) { header.insert("samplesPerPixel", Imf::FloatAttribute(20.5F)); };
  write_file(folder / "float.exr", {part});
  part.edit = [](Imf::Header& header) { header.insert("samplesPerPixel", Imf::IntAttribute(0)); };
  write_file(folder / "none.exr", {part});

  const stein::exr::ReadOptions four{.samples_per_pixel = 4};
  CHECK(read_frame(folder / "channel.exr", four).frame().sample_count);
  CHECK(read_frame(folder / "int.exr", four).frame().uniform_sample_count == 16);
  CHECK_FALSE(read_frame(folder / "int.exr", four).frame().sample_count);
  CHECK(read_frame(folder / "float.exr", four).frame().uniform_sample_count == 20.5F);
  CHECK(read_frame(folder / "none.exr", four).frame().uniform_sample_count == 4);
  CHECK(read_frame(folder / "none.exr", four).missing().back().find("4 samples, as given") != std::string::npos);
  expect_error(ErrorCode::kInvalidFrame, {"none.exr", "sampleCount", "samplesPerPixel", "pass the number of samples"},
               [&] { (void)read_frame(folder / "none.exr"); });
  expect_error(ErrorCode::kInvalidArgument, {"samples_per_pixel", "-1"},
               [&] { (void)read_frame(folder / "channel.exr", {.samples_per_pixel = -1}); });
}

TEST_CASE("what cannot be read is named") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  SECTION("no variance") {
    write_file(path, {{"", layer("", "RGB", Imf::HALF) + std::vector<ChannelSpec>{{"variance.G", Imf::HALF}}}});
    expect_error(ErrorCode::kInvalidFrame, {path, "variance.R, variance.B", "have the renderer write it"},
                 [&] { (void)read_frame(path); });
  }
  SECTION("no colour") {
    write_file(path, {{"", layer("Combined", "RGB", Imf::HALF) + layer("", "R", Imf::HALF)}});
    expect_error(ErrorCode::kInvalidFrame, {path, "it has no R, G, B", "Combined.R", "docs/inputs.md"},
                 [&] { (void)read_frame(path); });
  }
  SECTION("subsampled") {
    auto channels = colour_channels();
    channels.push_back({"chroma", Imf::HALF, false, 2});
    write_file(path, {{"", channels, {0, 0, 23, 13}}});
    expect_error(ErrorCode::kUnsupported, {path, "chroma", "subsampled"}, [&] { (void)read_frame(path); });
  }
  SECTION("deep") {
    write_file(path, {{"deep", layer("", "RGB", Imf::FLOAT), {0, 0, 22, 12}, Storage::kDeep, Imf::ZIPS_COMPRESSION}});
    expect_error(ErrorCode::kUnsupported, {path, "deep"}, [&] { (void)read_frame(path); });
  }
}

}  // namespace fixture
