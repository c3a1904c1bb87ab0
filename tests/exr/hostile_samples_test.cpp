// SPDX-License-Identifier: Apache-2.0
//
// Damaged and hostile files of samples end in an Error, never in a crash, a huge allocation or silent zeros.
#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <string_view>

#include "catch.hpp"
#include "deep_fixture.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"
#include "stein/exr_samples.hpp"

namespace fixture {

using stein::Error;
using stein::ErrorCode;
using stein::exr::SampleReader;
using Bytes = std::vector<unsigned char>;

namespace {

constexpr int kWidth = 9;
constexpr int kHeight = 7;
constexpr int kDamagedRow = 1;

void write_small(const std::string& path, Imf::Compression compression) {
  write_deep_file(path, {{{"R"}, {"G"}, {"B"}, {"depth.Z", Imf::HALF}}, {0, 0, kWidth - 1, kHeight - 1}, compression});
}

/// Reads all rows; every sample is looked at.
float read_all(const std::string& path) {
  SampleReader reader(path);
  std::vector<std::uint32_t> counts;
  std::vector<float> samples;
  float sum = 0;
  while (reader.read_row(counts, samples)) {
    for (const float value : samples) sum += value;
  }
  return sum;
}

/// False if reading ended in an Error with a message.
bool survives(const std::string& path) {
  try {
    static_cast<void>(read_all(path));
    return true;
  } catch (const Error& error) {
    CHECK(std::string(error.what()).size() > 10);
    return false;
  }
}

template <class Value>
void put(Bytes& bytes, std::size_t offset, Value value) {
  std::memcpy(&bytes[offset], &value, sizeof value);
}

template <class Value>
Value get(const Bytes& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, &bytes[offset], sizeof value);
  return value;
}

/// Where the chunk of a row begins: the table of offsets stands before the first chunk.
std::size_t chunk_of(const Bytes& bytes, int row) {
  const std::uint64_t rows = kHeight;
  for (std::size_t at = 0; at + 8 * rows < bytes.size(); ++at) {
    if (get<std::uint64_t>(bytes, at) == at + 8 * rows && get<std::int32_t>(bytes, at + 8 * rows) == 0) {
      return get<std::uint64_t>(bytes, at + 8 * static_cast<std::size_t>(row));
    }
  }
  FAIL("no table of offsets");
  return 0;
}

constexpr std::size_t kTableSize = 4;  // within a chunk
constexpr std::size_t kPackedSize = 12;
constexpr std::size_t kTable = 28;

}  // namespace

TEST_CASE("a truncated file of samples is an error at every length") {
  const TemporaryFolder folder;
  write_small(folder / "whole.exr", GENERATE(Imf::NO_COMPRESSION, Imf::ZIPS_COMPRESSION));
  const Bytes whole = bytes_of(folder / "whole.exr");
  for (std::size_t length = 0; length < whole.size(); length += 1 + length / 97) {
    write_bytes(folder / "cut.exr", Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    INFO("length " << length << " of " << whole.size());
    CHECK_FALSE(survives(folder / "cut.exr"));
  }
  write_bytes(folder / "cut.exr", Bytes(whole.begin(), whole.end() - 1));
  expect_error(ErrorCode::kIo, {folder / "cut.exr", "row y = 6", "truncated"}, [&] { read_all(folder / "cut.exr"); });
  CHECK(survives(folder / "whole.exr"));
}

TEST_CASE("a file of samples that was not written to its end is refused on opening") {
  const TemporaryFolder folder;
  const std::string path = folder / "half.exr";
  write_small(path, Imf::ZIPS_COMPRESSION);
  Bytes bytes = bytes_of(path);
  const std::size_t first = chunk_of(bytes, 0);
  put(bytes, first - 8, std::uint64_t{0});
  write_bytes(path, bytes);
  expect_error(ErrorCode::kIo, {path, "scanlines are missing", "not written to its end"},
               [&] { SampleReader reader(path); });
}

TEST_CASE("sample counts that the file cannot hold are refused before memory is asked for") {
  const TemporaryFolder folder;
  const std::string path = folder / "hostile.exr";
  write_small(path, Imf::NO_COMPRESSION);
  Bytes bytes = bytes_of(path);
  const std::size_t table = chunk_of(bytes, kDamagedRow) + kTable;
  const auto last = table + 4 * (kWidth - 1);
  SECTION("terabytes") {
    put(bytes, last, std::uint32_t{0x7FFFFFFF});
    write_bytes(path, bytes);
    expect_error(ErrorCode::kIo, {path, "row y = 1", "2147483647 samples", "2^31 bytes"}, [&] { read_all(path); });
  }
  SECTION("negative") {
    put(bytes, last, std::int32_t{-1});
    write_bytes(path, bytes);
    expect_error(ErrorCode::kIo, {path, "row y = 1", "column 8", "damaged"}, [&] { read_all(path); });
  }
  SECTION("decreasing") {
    put(bytes, table + 4, std::uint32_t{0});
    write_bytes(path, bytes);
    expect_error(ErrorCode::kIo, {path, "row y = 1", "column 1", "decrease"}, [&] { read_all(path); });
  }
  SECTION("a gigabyte") {
    put(bytes, last, std::uint32_t{100'000'000});
    write_bytes(path, bytes);
    expect_error(ErrorCode::kIo, {path, "row y = 1", "100000000 samples", "cannot come out"}, [&] { read_all(path); });
  }
  SECTION("one more or less than there are") {
    const auto count = static_cast<std::uint32_t>(get<std::int32_t>(bytes, last) + GENERATE(-1, 1));
    put(bytes, last, count);
    write_bytes(path, bytes);
    expect_error(ErrorCode::kIo, {path, "row y = 1", "damaged"}, [&] { read_all(path); });
  }
}

TEST_CASE("chunks of samples that claim impossible sizes are refused") {
  const TemporaryFolder folder;
  const std::string path = folder / "hostile.exr";
  const auto compression = GENERATE(Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION);
  write_small(path, compression);
  const Bytes whole = bytes_of(path);
  const std::size_t chunk = chunk_of(whole, kDamagedRow);
  for (const std::size_t at : {kTableSize, kPackedSize}) {
    const auto size = get<std::uint64_t>(whole, chunk + at);
    for (const std::uint64_t claim : {std::uint64_t{0}, size - 1, size + 1, std::uint64_t{1'000'000},
                                      std::uint64_t{5'000'000'000}, ~std::uint64_t{0}, ~size + 1}) {
      Bytes bytes = whole;
      put(bytes, chunk + at, claim);
      write_bytes(path, bytes);
      INFO("offset " << at << " claims " << claim);
      const char* why = claim == 5'000'000'000 ? "longer than the file" : "cannot read";
      expect_error(ErrorCode::kIo, {path, "row y = 1", why}, [&] { read_all(path); });
    }
  }
  // Sizes that exceed 2^64 in sum: what comes out is right, or too small for anything.
  const auto table = get<std::uint64_t>(whole, chunk + kTableSize);
  const auto packed = get<std::uint64_t>(whole, chunk + kPackedSize);
  const std::vector<std::array<std::uint64_t, 2>> sums = {{table - 1000, packed + 1000}, {table, 0 - table - 20}};
  for (const auto& [table_claim, packed_claim] : sums) {
    Bytes bytes = whole;
    put(bytes, chunk + kTableSize, table_claim);
    put(bytes, chunk + kPackedSize, packed_claim);
    write_bytes(path, bytes);
    expect_error(ErrorCode::kIo, {path, "row y = 1", table_claim == table ? "impossible size" : "contradict"},
                 [&] { read_all(path); });
  }
}

TEST_CASE("headers of samples that promise more than the file holds are refused") {
  const TemporaryFolder folder;
  const std::string path = folder / "hostile.exr";
  write_small(path, Imf::ZIPS_COMPRESSION);
  Bytes bytes = bytes_of(path);
  constexpr std::string_view key("dataWindow\0box2i\0", 17);
  const auto at = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
  REQUIRE(at != bytes.end());
  const std::size_t right = static_cast<std::size_t>(at - bytes.begin()) + key.size() + 4 + 8;
  const std::vector<std::pair<std::int32_t, std::int32_t>> ends = {
      {1'000'000, 6}, {8, 1'000'000}, {30'000, 30'000}, {2'000'000'000, 6}, {-9, 6}};
  for (const auto& [max_x, max_y] : ends) {
    put(bytes, right, max_x);
    put(bytes, right + 4, max_y);
    write_bytes(path, bytes);
    INFO(max_x << " " << max_y);
    expect_error(ErrorCode::kIo, {path}, [&] { read_all(path); });
  }
  put(bytes, right, std::int32_t{1'000'000});
  put(bytes, right + 4, std::int32_t{6});
  write_bytes(path, bytes);
  expect_error(ErrorCode::kIo, {path, "cannot fit"}, [&] { SampleReader reader(path); });
}

TEST_CASE("flipped bits in samples never crash") {
  const TemporaryFolder folder;
  write_small(folder / "whole.exr", GENERATE(Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION));
  const Bytes whole = bytes_of(folder / "whole.exr");
  std::minstd_rand random(20240229);
  for (int i = 0; i < 1000; ++i) {
    Bytes bytes = whole;
    for (int flip = 0; flip < 1 + i % 3; ++flip)
      bytes[random() % bytes.size()] ^= static_cast<unsigned char>(1U << random() % 8);
    write_bytes(folder / "flipped.exr", bytes);
    static_cast<void>(survives(folder / "flipped.exr"));
  }
  CHECK(folder.entries() == 2);
}

}  // namespace fixture
