// SPDX-License-Identifier: Apache-2.0
//
// Files of several views: each is read and written as if it were alone, and the others stay as they are.
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <filesystem>

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
using stein::exr::write_results;
using Names = std::vector<std::string>;

namespace {

// "R" is right.R, "variance.R" variance.right.R.
std::vector<ChannelSpec> right_eye(std::vector<ChannelSpec> channels) {
  for (ChannelSpec& channel : channels) {
    const std::size_t dot = channel.name.rfind('.');
    const std::size_t at = dot == std::string::npos ? 0 : dot + 1;
    channel.name.insert(at, "right.");
  }
  return channels;
}

// Both eyes in one part; the left one has an albedo, the right one depth.
void write_one_part(const std::string& path) {
  const std::vector<ChannelSpec> left = colour_channels() + layer("albedo", "RGB", Imf::HALF);
  const std::vector<ChannelSpec> right = right_eye(colour_channels() + layer("depth", "Z", Imf::FLOAT));
  write_file(path, {{"",
                     left + right + std::vector<ChannelSpec>{{"id.Z", Imf::UINT, true}},
                     {0, 0, 22, 12},
                     fixture::Storage::kScanlines,
                     Imf::ZIP_COMPRESSION,
                     [](Imf::Header& header) {
                       Imf::addMultiView(header, {"left", "right"});
                     }}});
}

void write_two_parts(const std::string& path) {
  const auto eye = [](const char* name) {
    return fixture::PartSpec{name,
                             colour_channels() + layer("albedo", "RGB", Imf::HALF),
                             {0, 0, 22, 12},
                             fixture::Storage::kScanlines,
                             Imf::ZIP_COMPRESSION,
                             [name](Imf::Header& header) { header.setView(name); }};
  };
  write_file(path, {eye("left"), eye("right")});
}

bool has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_plane(const std::string& path, const std::string& channel, const Plane& plane) {
  const Plane read = std::move(read_planes(path, {channel}).planes.at(0));
  for (int y = 0; y < plane.height(); ++y) {
    if (!std::equal(plane.row(y), plane.row(y) + plane.width(), read.row(y))) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("views of one part: each sees its own channels") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  write_one_part(path);
  const LoadedFrame left = read_frame(path);
  CHECK(left.views() == Names{"left", "right"});
  CHECK(left.view() == "left");
  CHECK(holds(left.frame().colour[1], "G"));
  REQUIRE(left.frame().features.size() == 1);
  CHECK(left.frame().features[0].name == "albedo");
  const LoadedFrame right = read_frame(path, {.view = "right"});
  CHECK(right.view() == "right");
  CHECK(holds(right.frame().colour[1], "right.G"));
  CHECK(holds(right.frame().colour_variance[2], "variance.right.B"));
  CHECK(holds(right.frame().sample_count, "right.sampleCount"));
  REQUIRE(right.frame().features.size() == 1);
  CHECK(right.frame().features[0].name == "depth");
}

TEST_CASE("views of one part: results go under the view's names, all else is carried over") {
  const TemporaryFolder folder;
  const std::string in = folder / "in.exr";
  const std::string out = folder / "out.exr";
  write_one_part(in);
  const LoadedFrame left = read_frame(in);
  const LoadedFrame right = read_frame(in, {.view = "right"});
  const DenoiseResult left_result = result_for(left.frame());
  DenoiseResult right_result = result_for(right.frame());
  right_result.colour[0].row(3)[4] = 77.0F;
  right_result.error[0].row(3)[4] = 78.0F;
  write_results(out, {{left, left_result}, {right, right_result}});
  CHECK(is_plane(out, "R", left_result.colour[0]));
  CHECK(is_plane(out, "right.R", right_result.colour[0]));
  CHECK(is_plane(out, "error.R", left_result.error[0]));
  CHECK(is_plane(out, "error.right.R", right_result.error[0]));
  const Names names = channel_names(out);
  for (const char* name : {"choice.V", "choice.right.V", "density.right.V", "id.Z", "depth.right.Z"})
    CHECK(has(names, name));
  for (const char* name : {"variance.R", "variance.right.R", "sampleCount", "right.sampleCount"})
    CHECK_FALSE(has(names, name));
  CHECK(read_raw(out, 0, "id.Z") == read_raw(in, 0, "id.Z"));

  write_result(out, right, right_result);
  CHECK(is_plane(out, "right.R", right_result.colour[0]));
  for (const char* name : {"R", "variance.R", "sampleCount"}) CHECK(read_raw(out, 0, name) == read_raw(in, 0, name));
  CHECK_FALSE(has(channel_names(out), "error.R"));
}

TEST_CASE("views of parts: each in its own") {
  const TemporaryFolder folder;
  const std::string in = folder / "in.exr";
  const std::string out = folder / "out.exr";
  write_two_parts(in);
  const LoadedFrame left = read_frame(in);
  const LoadedFrame right = read_frame(in, {.view = "right"});
  CHECK(left.view() == "left");
  CHECK(right.frame().features.size() == 1);
  const DenoiseResult result = result_for(left.frame());
  write_results(out, {{left, result}, {right, result}});
  for (const int part : {0, 1}) {
    const Names names = channel_names(out, part);
    CHECK(has(names, "error.R"));
    CHECK(has(names, "choice.V"));
    CHECK_FALSE(has(names, "variance.R"));
    CHECK(read_raw(out, part, "albedo.R") == read_raw(in, part, "albedo.R"));
  }
}

TEST_CASE("views: what cannot be is refused by name") {
  const TemporaryFolder folder;
  write_one_part(folder / "stereo.exr");
  write_file(folder / "mono.exr", {{"", colour_channels()}});
  expect_error(ErrorCode::kInvalidArgument, {"stereo.exr", "no view middle", "left, right"},
               [&] { (void)read_frame(folder / "stereo.exr", {.view = "middle"}); });
  expect_error(ErrorCode::kInvalidArgument, {"mono.exr", "no view right"},
               [&] { (void)read_frame(folder / "mono.exr", {.view = "right"}); });
  const LoadedFrame stereo = read_frame(folder / "stereo.exr");
  const LoadedFrame mono = read_frame(folder / "mono.exr");
  const DenoiseResult result = result_for(stereo.frame());
  expect_error(ErrorCode::kInvalidArgument, {"two files"}, [&] {
    write_results(folder / "out.exr", {{stereo, result}, {mono, result}});
  });
  expect_error(ErrorCode::kInvalidArgument, {"no result"}, [&] { write_results(folder / "out.exr", {}); });
  CHECK_FALSE(std::filesystem::exists(folder / "out.exr"));
}

}  // namespace fixture
