// SPDX-License-Identifier: Apache-2.0
//
// Damaged and hostile files end in an Error, never in a crash, a huge allocation or silent zeros.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::Error;
using stein::ErrorCode;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::write_result;
using Bytes = std::vector<unsigned char>;

namespace {

std::vector<PartSpec> small_file(Storage storage, bool more_parts) {
  const std::array<int, 4> window = {-2, 1, 14, 20};
  std::vector<PartSpec> parts = {{"main", native_channels(), window, storage}};
  if (more_parts) {
    parts.push_back({"tiles", layer("", "XY", Imf::HALF), window, Storage::kMipmap, Imf::PIZ_COMPRESSION});
    parts.push_back({"deep", layer("", "Z", Imf::FLOAT), window, Storage::kDeep, Imf::ZIPS_COMPRESSION});
  }
  return parts;
}

/// Reads and rewrites; true if both worked. Anything thrown must be an Error with a message.
bool survives(const std::string& path, const std::string& out) {
  try {
    const LoadedFrame loaded = read_frame(path, {.samples_per_pixel = 4, .layers = {"all"}});
    write_result(out, loaded, result_for(loaded.frame()));
    return true;
  } catch (const Error& error) {
    CHECK(std::string(error.what()).size() > 10);
    return false;
  }
}

/// Offset of the value of an attribute in the header.
std::size_t value_offset(const Bytes& bytes, const std::string& name, const std::string& type) {
  const std::string key = name + '\0' + type + '\0';
  const auto at = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
  REQUIRE(at != bytes.end());
  return static_cast<std::size_t>(at - bytes.begin()) + key.size() + 4;
}

void put(Bytes& bytes, std::size_t offset, std::int32_t value) { std::memcpy(&bytes[offset], &value, sizeof value); }

}  // namespace

TEST_CASE("a truncated file is an error at every length") {
  const TemporaryFolder folder;
  const auto storage = GENERATE(Storage::kScanlines, Storage::kTiles);
  const bool more_parts = GENERATE(false, true);
  write_file(folder / "whole.exr", small_file(storage, more_parts));
  const Bytes whole = bytes_of(folder / "whole.exr");
  for (std::size_t length = 0; length < whole.size(); length += 1 + length / 97) {
    write_bytes(folder / "cut.exr", Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    INFO("length " << length << " of " << whole.size());
    CHECK_FALSE(survives(folder / "cut.exr", folder / "out.exr"));
  }
  write_bytes(folder / "cut.exr", Bytes(whole.begin(), whole.end() - 1));
  CHECK_FALSE(survives(folder / "cut.exr", folder / "out.exr"));
  CHECK(survives(folder / "whole.exr", folder / "out.exr"));
}

TEST_CASE("a file that was not written to its end names its missing rows") {
  const TemporaryFolder folder;
  {
    Imf::Header header(40, 64);
    const std::vector<float> plane(std::size_t{40} * 64);
    Imf::FrameBuffer buffer;
    for (const auto& channel : colour_channels()) {
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
      buffer.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, plane.data(), header.dataWindow()));
    }
    Imf::OutputFile file((folder / "half.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(32);
  }
  expect_error(ErrorCode::kIo, {folder / "half.exr", "scanlines are missing", "not written to its end"},
               [&] { (void)read_frame(folder / "half.exr"); });
}

TEST_CASE("what is no OpenEXR file is said to be none") {
  const TemporaryFolder folder;
  write_bytes(folder / "text.exr", Bytes(200, 'x'));
  expect_error(ErrorCode::kIo, {folder / "text.exr", "not an OpenEXR file"},
               [&] { (void)read_frame(folder / "text.exr"); });
  expect_error(ErrorCode::kIo, {folder / "none.exr", "no such file"}, [&] { (void)read_frame(folder / "none.exr"); });
  expect_error(ErrorCode::kIo, {folder.path().string(), "not a regular file"},
               [&] { (void)read_frame(folder.path().string()); });
}

TEST_CASE("headers that promise more than the file holds are refused before memory is asked for") {
  const TemporaryFolder folder;
  const auto storage = GENERATE(Storage::kScanlines, Storage::kTiles);
  write_file(folder / "in.exr", small_file(storage, false));
  Bytes bytes = bytes_of(folder / "in.exr");
  const std::string path = folder / "hostile.exr";
  SECTION("window") {
    const std::size_t at = value_offset(bytes, "dataWindow", "box2i");
    // Right and bottom ends: wide, tall, both, beyond int, inside out.
    const std::vector<std::pair<int, int>> ends = {{1'000'000'000, 20}, {14, 1'000'000'000}, {60'000, 60'000},
                                                   {30'000, 30'000},    {2'147'483'647, 20}, {-9, 20},
                                                   {500'000, 20},       {14, 500'000}};
    for (const auto& [right, bottom] : ends) {
      put(bytes, at + 8, right);
      put(bytes, at + 12, bottom);
      write_bytes(path, bytes);
      INFO(right << " " << bottom);
      // With more rows or tiles the table of chunks is too short already, and OpenEXR refuses widths near 2^31 itself.
      const bool same_chunks = storage == Storage::kScanlines && bottom == 20 && right > 0 && right < 2'000'000'000;
      const char* why = right > 1 << 20 ? "larger than any image" : "cannot fit in its";
      expect_error(ErrorCode::kIo, {path, same_chunks ? why : "cannot read"}, [&] { (void)read_frame(path); });
    }
  }
  SECTION("attribute") {
    for (const std::int32_t size : {2'000'000'000, -1, static_cast<std::int32_t>(bytes.size())}) {
      put(bytes, value_offset(bytes, "screenWindowCenter", "v2f") - 4, size);
      write_bytes(path, bytes);
      expect_error(ErrorCode::kIo, {path, "longer than the file"}, [&] { (void)read_frame(path); });
    }
  }
  SECTION("tiles") {
    write_file(folder / "in.exr", small_file(Storage::kTiles, false));
    bytes = bytes_of(folder / "in.exr");
    const std::size_t at = value_offset(bytes, "tiles", "tiledesc");
    for (const std::int32_t size : {1'000'000, 2'000'000'000, 0, -1}) {
      put(bytes, at, size);
      put(bytes, at + 4, size);
      write_bytes(path, bytes);
      expect_error(ErrorCode::kIo, {path}, [&] { (void)read_frame(path); });
    }
  }
}

TEST_CASE("chunks of carried-over parts that claim impossible sizes are refused") {
  const TemporaryFolder folder;
  const bool deep = GENERATE(false, true);
  const std::array<int, 4> window = {0, 0, 16, 19};
  PartSpec second = {"tiles", layer("", "XY", Imf::HALF), window, Storage::kTiles};
  second.edit = [](Imf::Header& header) { header.lineOrder() = Imf::RANDOM_Y; };
  if (deep) second = {"deep", layer("", "Z", Imf::FLOAT), window, Storage::kDeep, Imf::ZIPS_COMPRESSION};
  write_file(folder / "in.exr", {{"main", native_channels(), window}, second});
  const LoadedFrame source = read_frame(folder / "in.exr");
  write_result(folder / "whole.exr", source, result_for(source.frame()));
  // A chunk begins with its part; then the first tile's place (0, 0, 0, 0), or the first row (0); then its size.
  Bytes bytes = bytes_of(folder / "in.exr");
  std::vector<std::int32_t> begin = {1, 0, 0, 0, 0};
  if (deep) begin.resize(2);
  const auto* first = reinterpret_cast<const unsigned char*>(begin.data());
  const auto at = std::find_end(bytes.begin(), bytes.end(), first, first + begin.size() * 4);
  REQUIRE(at != bytes.end());
  const std::size_t size = static_cast<std::size_t>(at - bytes.begin()) + begin.size() * 4;
  put(bytes, size, deep ? 1'000'000 : -117'000'000);
  write_bytes(folder / "in.exr", bytes);
  expect_error(ErrorCode::kIo, {folder / "in.exr", deep ? "longer than the file" : "negative size"},
               [&] { write_result(folder / "out.exr", source, result_for(source.frame())); });
  CHECK(folder.entries() == 2);
}

TEST_CASE("flipped bits never crash, and never leave a file behind on failure") {
  const TemporaryFolder folder;
  write_file(folder / "whole.exr", small_file(GENERATE(Storage::kScanlines, Storage::kTiles), GENERATE(false, true)));
  const Bytes whole = bytes_of(folder / "whole.exr");
  std::minstd_rand random(20240229);
  for (int i = 0; i < 400; ++i) {
    Bytes bytes = whole;
    // Half of the flips fall into the header, which is small next to the pixels.
    const std::size_t range = i % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1500);
    for (int flip = 0; flip < 1 + i % 3; ++flip)
      bytes[random() % range] ^= static_cast<unsigned char>(1U << random() % 8);
    write_bytes(folder / "flipped.exr", bytes);
    std::filesystem::remove(folder / "out.exr");
    const bool written = survives(folder / "flipped.exr", folder / "out.exr");
    CHECK(std::filesystem::exists(folder / "out.exr") == written);
    CHECK(folder.entries() == (written ? 3U : 2U));
  }
}

}  // namespace fixture
