// SPDX-License-Identifier: Apache-2.0
//
// Layers of a file: which are read, and where filtered ones go.
#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::Plane;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::read_planes;
using stein::exr::write_result;
using Names = std::vector<std::string>;

namespace {

// Light groups in the part of the colour and in one of its own, alpha, and what is no light.
void write_layers(const std::string& path) {
  const std::vector<ChannelSpec> main = colour_channels() + layer("key", "RGB", Imf::HALF) +
                                        layer("CryptoObject00", "RGBA", Imf::FLOAT) + layer("id", "RGB", Imf::UINT) +
                                        layer("albedo", "RGB", Imf::HALF) +
                                        std::vector<ChannelSpec>{{"A", Imf::HALF}, {"mist.Z", Imf::FLOAT}};
  write_file(path, {{"main", main},
                    {"rim", layer("rim", "RGB", Imf::FLOAT) + std::vector<ChannelSpec>{{"tag", Imf::HALF, true}}},
                    {"small", layer("small", "RGB", Imf::FLOAT), {0, 0, 5, 5}}});
}

Names names_of(const LoadedFrame& loaded) {
  Names names;
  for (const stein::Layer& each : loaded.frame().layers) names.push_back(each.name);
  return names;
}

}  // namespace

TEST_CASE("layers: by name, and all that are light") {
  const TemporaryFolder folder;
  write_layers(folder / "in.exr");
  CHECK(read_frame(folder / "in.exr").frame().layers.empty());
  CHECK(names_of(read_frame(folder / "in.exr", {.layers = {"all"}})) == Names{"key", "rim", "A"});
  CHECK(names_of(read_frame(folder / "in.exr", {.layers = {"rim", "all", "rim"}})) == Names{"rim", "key", "A"});
  const LoadedFrame loaded = read_frame(folder / "in.exr", {.layers = {"mist.Z", "albedo", "rim"}});
  const std::vector<stein::Layer>& layers = loaded.frame().layers;
  REQUIRE(names_of(loaded) == Names{"mist.Z", "albedo", "rim"});
  REQUIRE(layers[0].mean.size() == 1);
  CHECK(holds(layers[0].mean[0], "mist.Z"));
  REQUIRE(layers[1].mean.size() == 3);
  CHECK(holds(layers[1].mean[1], "albedo.G"));
  CHECK(holds(layers[2].mean[2], "rim.B"));
  CHECK(loaded.frame().features.size() == 1);
}

TEST_CASE("layers: what is none is refused with the names of those there are") {
  const TemporaryFolder folder;
  write_layers(folder / "in.exr");
  const auto refuse = [&](const std::string& name, ErrorCode code, const std::vector<std::string>& words) {
    expect_error(code, words, [&] { (void)read_frame(folder / "in.exr", {.layers = {name}}); });
  };
  refuse("fill", ErrorCode::kInvalidArgument, {"in.exr", "'fill'", "key, rim, A"});
  refuse("", ErrorCode::kInvalidArgument, {"in.exr", "''"});
  refuse("R", ErrorCode::kInvalidArgument, {"'R'", "colour"});
  refuse("variance", ErrorCode::kInvalidArgument, {"'variance'", "variance of the mean"});
  refuse("sampleCount", ErrorCode::kInvalidArgument, {"samples per pixel"});
  refuse("CryptoObject00", ErrorCode::kInvalidArgument, {"'CryptoObject00'", "numbers"});
  refuse("id", ErrorCode::kInvalidArgument, {"'id'", "numbers"});
  refuse("small", ErrorCode::kInvalidFrame, {"small.R", "data window"});
}

TEST_CASE("layers: filtered ones take the place of the file's, in their part") {
  const TemporaryFolder folder;
  write_layers(folder / "in.exr");
  const bool is_half = GENERATE(false, true);
  const LoadedFrame source = read_frame(folder / "in.exr", {.layers = {"key", "rim", "A"}});
  stein::DenoiseResult result = result_for(source.frame());
  for (const stein::Layer& each : source.frame().layers) {
    result.layers.push_back({each.name, {}});
    for (std::size_t c = 0; c < each.mean.size(); ++c) {
      Plane plane(source.frame().width, source.frame().height);
      plane.row(3)[4] = static_cast<float>(result.layers.size() * 10 + c);
      result.layers.back().mean.push_back(std::move(plane));
    }
  }
  stein::exr::WriteOptions options;
  options.half_colour = is_half;
  write_result(folder / "out.exr", source, result, options);

  const auto at = [&](const std::string& name) {
    const auto read = read_planes(folder / "out.exr", {name});
    CHECK(read.planes[0].row(5)[5] == 0.0F);
    return read.planes[0].row(3)[4];
  };
  CHECK(at("key.R") == 10.0F);
  CHECK(at("key.B") == 12.0F);
  CHECK(at("rim.G") == 21.0F);
  CHECK(at("A") == 30.0F);
  CHECK(fixture::channel_names(folder / "out.exr", 1) == Names{"rim.B", "rim.G", "rim.R", "tag"});
  CHECK(read_raw(folder / "out.exr", 1, "rim.R").type == (is_half ? Imf::HALF : Imf::FLOAT));
  for (const char* name : {"CryptoObject00.R", "id.G", "mist.Z"})
    CHECK(read_raw(folder / "out.exr", 0, name) == read_raw(folder / "in.exr", 0, name));
  CHECK(read_raw(folder / "out.exr", 1, "tag") == read_raw(folder / "in.exr", 1, "tag"));
  CHECK(read_raw(folder / "out.exr", 2, "small.R") == read_raw(folder / "in.exr", 2, "small.R"));
}

TEST_CASE("layers: a plane of another size is refused") {
  const TemporaryFolder folder;
  write_layers(folder / "in.exr");
  const LoadedFrame source = read_frame(folder / "in.exr");
  stein::DenoiseResult result = result_for(source.frame());
  result.layers.push_back({"A", {}});
  result.layers[0].mean.emplace_back(3, 3);
  expect_error(ErrorCode::kInvalidArgument, {"out.exr", "A of the result", "3 x 3"},
               [&] { write_result(folder / "out.exr", source, result); });
}

TEST_CASE("straight alpha: the result needs the layer that divides it, and frames are not written") {
  const TemporaryFolder folder;
  write_layers(folder / "in.exr");
  const LoadedFrame loaded = read_frame(folder / "in.exr", {.straight_alpha = true});
  CHECK(names_of(loaded) == Names{"A"});
  stein::DenoiseResult result = result_for(loaded.frame());
  result.layers.clear();
  expect_error(ErrorCode::kInvalidArgument, {"no layer 'A'"},
               [&] { write_result(folder / "out.exr", loaded, result); });
  expect_error(ErrorCode::kUnsupported, {"read as straight"},
               [&] { stein::exr::write_frame(folder / "out.exr", loaded.frame(), loaded); });
}

}  // namespace fixture
