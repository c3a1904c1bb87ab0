// SPDX-License-Identifier: Apache-2.0
//
// read_planes and write_planes.
#include <cmath>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::ConstPlaneView;
using stein::ErrorCode;
using stein::ScalarType;
using stein::exr::NamedPlanes;
using stein::exr::read_planes;
using stein::exr::write_planes;

TEST_CASE("planes are read by name as floats") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  const auto storage = GENERATE(Storage::kScanlines, Storage::kTiles);
  const std::array<int, 4> window = {-3, 5, 19, 17};
  write_file(path, {{"main", layer("", "RGB", Imf::HALF) + colour_channels(), window, storage},
                    {"any", layer("", "Y", Imf::UINT), window},
                    {"small", layer("", "RGB", Imf::HALF), {0, 0, 3, 3}},
                    {"deep", layer("", "Q", Imf::FLOAT), window, Storage::kDeep, Imf::ZIPS_COMPRESSION}});
  const NamedPlanes rgb = read_planes(path);
  CHECK(rgb.names == std::vector<std::string>{"R", "G", "B"});
  CHECK(rgb.data_window == window);
  for (std::size_t i = 0; i < 3; ++i) CHECK(holds(rgb.planes[i].view(), rgb.names[i]));

  const NamedPlanes any = read_planes(path, {"any/Y", "sampleCount", "any.Y", "main/variance.G", "Y"});
  for (const std::size_t i : {0U, 2U, 4U}) CHECK(any.planes[i].row(3)[4] == std::floor(fixture::value_of("Y", 4, 3)));
  CHECK(holds(any.planes[3].view(), "variance.G"));
  CHECK(read_planes(path, {"small.G"}).data_window == std::array<int, 4>{0, 0, 3, 3});

  expect_error(ErrorCode::kInvalidFrame, {path, "no channel glow", "variance.G"},
               [&] { (void)read_planes(path, {"glow"}); });
  expect_error(ErrorCode::kInvalidFrame, {path, "small.G", "data window"}, [&] {
    (void)read_planes(path, {"R", "small.G"});
  });
  expect_error(ErrorCode::kUnsupported, {path, "deep.Q", "deep"}, [&] { (void)read_planes(path, {"deep.Q"}); });
}

TEST_CASE("planes are written as floats, whatever the views, and counts as uint") {
  const TemporaryFolder folder;
  const std::string path = folder / "out.exr";
  const std::vector<float> interleaved = {1, 10, 2, 20, 3, 30, 4, 40, 5, 50, 6, 60};
  const std::vector<std::uint32_t> counts = {7, 8, 9, 10, 11, 12};
  const ConstPlaneView bottom_up(interleaved.data() + 6, 3, 2, 8, -24);
  write_planes(path, {{"first", ConstPlaneView(interleaved.data(), 3, 2, 8)},
                      {"second", ConstPlaneView(interleaved.data() + 1, 3, 2, 8)},
                      {"flipped", bottom_up},
                      {"n.V", ConstPlaneView(counts.data(), ScalarType::kUint32, 3, 2)}});
  const NamedPlanes read = read_planes(path, {"first", "second", "flipped", "n.V"});
  CHECK(read.data_window == std::array<int, 4>{0, 0, 2, 1});
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const auto value = static_cast<float>(y * 3 + x + 1);
      CHECK(read.planes[0].row(y)[x] == value);
      CHECK(read.planes[1].row(y)[x] == value * 10);
      CHECK(read.planes[2].row(1 - y)[x] == value);
      CHECK(read.planes[3].row(y)[x] == value + 6);
    }
  }
  CHECK(fixture::read_raw(path, 0, "n.V").type == Imf::UINT);
  CHECK(fixture::read_raw(path, 0, "first").type == Imf::FLOAT);
  write_planes(path, {{"n.V", ConstPlaneView(counts.data(), ScalarType::kUint32, 3, 2)}}, {-3, 5});
  CHECK(read_planes(path, {"n.V"}).data_window == std::array<int, 4>{-3, 5, -1, 6});
  CHECK(folder.entries() == 1);
}

TEST_CASE("planes that make no file are refused") {
  const TemporaryFolder folder;
  const std::string path = folder / "out.exr";
  const std::vector<float> values(6);
  const ConstPlaneView wide(values.data(), 3, 2);
  const ConstPlaneView tall(values.data(), 2, 3);
  const auto code = ErrorCode::kInvalidArgument;
  expect_error(code, {path, "no planes"}, [&] { write_planes(path, {}); });
  expect_error(code, {path, "b", "2 x 3", "3 x 2"}, [&] { write_planes(path, {{"a", wide}, {"b", tall}}); });
  expect_error(code, {path, "a", "twice"}, [&] { write_planes(path, {{"a", wide}, {"a", wide}}); });
  expect_error(code, {path, "name"}, [&] { write_planes(path, {{"", wide}}); });
  expect_error(code, {path, "a", "empty"}, [&] { write_planes(path, {{"a", ConstPlaneView()}}); });
  CHECK(folder.entries() == 0);
}

}  // namespace fixture
