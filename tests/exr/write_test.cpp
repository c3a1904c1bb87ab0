// SPDX-License-Identifier: Apache-2.0
//
// write_result: what is new, what is carried over bit for bit, what is dropped.
#include <ImfFloatVectorAttribute.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::DenoiseResult;
using stein::ErrorCode;
using stein::Plane;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::read_planes;
using stein::exr::write_result;
using Names = std::vector<std::string>;

namespace {

const std::vector<ChannelSpec> kStrangers = {
    {"A", Imf::HALF}, {"id", Imf::UINT, true}, {"mask.half", Imf::HALF, true}, {"crypto00.R", Imf::FLOAT, true}};

bool has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool equals(const std::string& path, const std::string& channel, const Plane& plane) {
  const auto read = read_planes(path, {channel});
  for (int y = 0; y < plane.height(); ++y) {
    if (!std::equal(plane.row(y), plane.row(y) + plane.width(), read.planes[0].row(y))) return false;
  }
  return true;
}

void check_result(const std::string& path, const DenoiseResult& result) {
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    CHECK(equals(path, name, result.colour[c]));
    CHECK(equals(path, "error." + name, result.error[c]));
  }
  CHECK(equals(path, "choice.V", result.choice));
  CHECK(equals(path, "density.V", result.density));
}

}  // namespace

TEST_CASE("the result replaces the colour; the rest is carried over bit for bit") {
  const TemporaryFolder folder;
  const auto storage = GENERATE(Storage::kScanlines, Storage::kTiles, Storage::kMipmap);
  const auto compression = GENERATE(Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::NO_COMPRESSION);
  const std::array<int, 4> window = {-9, 3, 13, 150};
  write_file(folder / "in.exr", {{"", native_channels() + kStrangers, window, storage, compression}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  write_result(folder / "out.exr", source, result);

  check_result(folder / "out.exr", result);
  const Names names = channel_names(folder / "out.exr");
  CHECK(names == Names{"A", "B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "choice.V", "crypto00.R", "density.V",
                       "depth.Z", "error.B", "error.G", "error.R", "id", "mask.half", "normal.X", "normal.Y",
                       "normal.Z"});
  for (const std::string name : {"A", "id", "mask.half", "crypto00.R", "albedo.G", "normal.X", "depth.Z"}) {
    INFO(name);
    CHECK(read_raw(folder / "in.exr", 0, name) == read_raw(folder / "out.exr", 0, name));
  }
  const Imf::Header header = header_of(folder / "out.exr");
  CHECK(header.compression() == compression);
  CHECK(header.dataWindow() == header_of(folder / "in.exr").dataWindow());
  CHECK(header.displayWindow() == header_of(folder / "in.exr").displayWindow());
  CHECK_FALSE(header.hasTileDescription());
}

TEST_CASE("attributes are carried over") {
  const TemporaryFolder folder;
  PartSpec part{"beauty", colour_channels()};
  part.edit = [&](Imf::Header& header) {
    Imf::addOwner(header, "somebody");
    Imf::addChromaticities(header, {{0.680F, 0.320F}, {0.265F, 0.690F}, {0.150F, 0.060F}, {0.3127F, 0.3290F}});
    header.insert("cryptomatte/1234567/manifest", Imf::StringAttribute(R"({"bunny":"13851a76"})"));
    header.insert("studio", Imf::StringAttribute("bytes"));
    header.insert("curve", Imf::FloatVectorAttribute({1.5F, 2.5F}));
    header.lineOrder() = Imf::DECREASING_Y;
    header.pixelAspectRatio() = 2;
  };
  write_file(folder / "in.exr", {part});
  // An attribute of a type that OpenEXR does not know.
  const auto swap_text = [](std::vector<unsigned char> bytes, std::string_view from, std::string_view to) {
    const auto at = std::search(bytes.begin(), bytes.end(), from.begin(), from.end());
    REQUIRE(at != bytes.end());
    std::copy(to.begin(), to.end(), at);
    return bytes;
  };
  const std::string_view known("studio\0string\0\5\0\0\0bytes", 23);
  const std::string_view unknown("studio\0custom\0\5\0\0\0bytes", 23);
  write_bytes(folder / "in.exr", swap_text(bytes_of(folder / "in.exr"), known, unknown));
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  write_result(folder / "out.exr", source, result);
  check_result(folder / "out.exr", result);
  (void)swap_text(bytes_of(folder / "out.exr"), unknown, unknown);  // found there
  const Imf::Header header = header_of(folder / "out.exr");
  CHECK(header.name() == "beauty");
  CHECK(Imf::owner(header) == "somebody");
  CHECK(Imf::chromaticities(header).red == Imath::V2f(0.680F, 0.320F));
  CHECK(header.typedAttribute<Imf::StringAttribute>("cryptomatte/1234567/manifest").value() ==
        R"({"bunny":"13851a76"})");
  CHECK(header.typedAttribute<Imf::FloatVectorAttribute>("curve").value() == std::vector<float>{1.5F, 2.5F});
  CHECK(header.pixelAspectRatio() == 2);
}

TEST_CASE("other parts are carried over, also tiled, mipmapped, lossy and deep ones") {
  const TemporaryFolder folder;
  const std::array<int, 4> odd = {-2, -3, 30, 9};
  write_file(
      folder / "in.exr",
      {{"variance", layer("", "RGB", Imf::FLOAT)},
       {"ids", kStrangers, odd, Storage::kTiles, Imf::PIZ_COMPRESSION},
       {"beauty", layer("", "RGB", Imf::HALF) + std::vector<ChannelSpec>{{"sampleCount", Imf::UINT}}},
       {"pyramid", layer("", "XY", Imf::HALF), odd, Storage::kMipmap},
       {"albedo", layer("", "RGB", Imf::HALF) + layer("variance", "RGB", Imf::HALF), {0, 0, 22, 12}, Storage::kTiles},
       {"lossy", layer("", "RGB", Imf::HALF), odd, Storage::kScanlines, Imf::DWAA_COMPRESSION},
       {"deep", layer("", "AZ", Imf::FLOAT), odd, Storage::kDeep, Imf::ZIPS_COMPRESSION}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  write_result(folder / "out.exr", source, result);
  check_result(folder / "out.exr", result);
  REQUIRE(fixture::parts_of(folder / "out.exr") == 6);
  const std::vector<std::pair<int, Names>> kept = {{1, {"A", "id", "mask.half", "crypto00.R"}},
                                                   {3, {"X", "Y"}},
                                                   {4, {"R", "G", "B"}},
                                                   {5, {"R", "G", "B"}},
                                                   {6, {"A", "Z"}}};
  for (const auto& [part, names] : kept) {
    const Imf::Header before = header_of(folder / "in.exr", part);
    const Imf::Header after = header_of(folder / "out.exr", part - 1);
    CHECK(before.name() == after.name());
    CHECK(before.compression() == after.compression());
    for (const std::string& name : names) {
      INFO(before.name() << " " << name);
      CHECK(read_raw(folder / "in.exr", part, name) == read_raw(folder / "out.exr", part - 1, name));
    }
  }
  CHECK(header_of(folder / "out.exr", 2).tileDescription().mode == Imf::MIPMAP_LEVELS);
  CHECK(channel_names(folder / "out.exr", 3) == Names{"B", "G", "R"});
  CHECK(header_of(folder / "out.exr", 5).type() == Imf::DEEPSCANLINE);
}

TEST_CASE("lossy compression of rewritten channels becomes ZIP") {
  const TemporaryFolder folder;
  const auto compression = GENERATE(Imf::DWAB_COMPRESSION, Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION);
  write_file(
      folder / "in.exr",
      {{"", colour_channels() + layer("key", "RGB", Imf::HALF), {0, 0, 40, 300}, Storage::kScanlines, compression}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  write_result(folder / "out.exr", source, result_for(source.frame()));
  CHECK(header_of(folder / "out.exr").compression() == Imf::ZIP_COMPRESSION);
  CHECK(read_raw(folder / "in.exr", 0, "key.G") == read_raw(folder / "out.exr", 0, "key.G"));
}

TEST_CASE("options choose what is written") {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  write_file(folder / "in.exr",
             {{"", native_channels() + layer("covariance.R", "GB", Imf::HALF) +
                       layer("covariance.R.albedo", "R", Imf::HALF) + layer("lamp.variance", "R", Imf::HALF)}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  SECTION("nothing but the colour") {
    write_result(out, source, result, {.error = false, .choice = false, .density = false});
    CHECK(channel_names(out) == Names{"B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "depth.Z", "lamp.variance.R",
                                      "normal.X", "normal.Y", "normal.Z"});
  }
  SECTION("the noisy colour, in its own type") {
    write_result(out, source, result, {.noisy = true});
    for (const char c : {'R', 'G', 'B'}) {
      CHECK(read_raw(out, 0, std::string("noisy.") + c) == read_raw(folder / "in.exr", 0, std::string(1, c)));
    }
  }
  SECTION("the planes that describe the noise") {
    write_result(out, source, result, {.inputs = true});
    for (const std::string name : {"variance.G", "sampleCount", "albedo.variance.B", "depth.variance.Z",
                                   "covariance.R.G", "covariance.R.albedo.R"}) {
      INFO(name);
      CHECK(read_raw(out, 0, name) == read_raw(folder / "in.exr", 0, name));
    }
  }
}

TEST_CASE("half colour is clamped to what half can hold") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", colour_channels()}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  DenoiseResult result = result_for(source.frame());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::array<float, 6> values = {1e6F, -1e6F, kInfinity, 65519.0F, 0.5F, std::nanf("")};
  std::copy(values.begin(), values.end(), result.colour[1].row(2));
  write_result(folder / "out.exr", source, result, {.half_colour = true});
  CHECK(read_raw(folder / "out.exr", 0, "G").type == Imf::HALF);
  CHECK(read_raw(folder / "out.exr", 0, "error.G").type == Imf::FLOAT);
  const auto read = read_planes(folder / "out.exr", {"G"});
  const float* row = read.planes[0].row(2);
  CHECK(row[0] == 65504);
  CHECK(row[1] == -65504);
  CHECK(row[2] == 65504);
  CHECK(row[3] == 65504);
  CHECK(row[4] == 0.5F);
  CHECK(std::isnan(row[5]));
}

TEST_CASE("results of an earlier run are replaced") {
  const TemporaryFolder folder;
  const auto old = layer("error", "RGB", Imf::HALF) + layer("choice", "V", Imf::HALF) +
                   layer("noisy", "RGB", Imf::HALF) + std::vector<ChannelSpec>{{"density.V", Imf::HALF}};
  write_file(folder / "in.exr", {{"", colour_channels(Imf::HALF) + old}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  const DenoiseResult result = result_for(source.frame());
  write_result(folder / "out.exr", source, result);
  check_result(folder / "out.exr", result);
  CHECK(read_raw(folder / "out.exr", 0, "noisy.R") == read_raw(folder / "in.exr", 0, "noisy.R"));
  write_result(folder / "out.exr", source, result, {.error = false, .noisy = true});
  CHECK_FALSE(has(channel_names(folder / "out.exr"), "error.R"));
  CHECK(read_raw(folder / "out.exr", 0, "noisy.R") == read_raw(folder / "in.exr", 0, "R"));
}

}  // namespace fixture
