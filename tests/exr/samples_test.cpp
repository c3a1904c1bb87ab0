// SPDX-License-Identifier: Apache-2.0
//
// Raw samples in files: what is written is read again, and what other programs write is understood.
#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include "catch.hpp"
#include "deep_fixture.hpp"
#include "expect_error.hpp"
#include "file_size_limit.hpp"
#include "fixture.hpp"
#include "stein/exr_samples.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::exr::PlanesWriter;
using stein::exr::SampleLayer;
using stein::exr::SampleReader;
using stein::exr::SampleWriter;
using Kind = stein::exr::SampleLayer::Kind;

namespace {

constexpr int kWidth = 9;
constexpr int kHeight = 7;

const std::vector<std::string> kChannels = {"normal.X", "R", "G", "B", "random.lens.X", "depth.Z"};

void write_rows(SampleWriter& writer, int rows) {
  for (int row = 0; row < rows; ++row) {
    const std::vector<float> samples = row_samples(kChannels, kWidth, row);
    writer.write_row(row_counts(kWidth, row).data(), samples.empty() ? nullptr : samples.data());
  }
}

/// Whether all rows hold what the fixture makes of the reader's channels.
void check_rows(SampleReader& reader) {
  std::vector<std::uint32_t> counts;
  std::vector<float> samples;
  for (int row = 0; row < kHeight; ++row) {
    REQUIRE(reader.read_row(counts, samples));
    CHECK(counts == row_counts(kWidth, row));
    CHECK(samples == row_samples(reader.channels(), kWidth, row));
  }
  CHECK_FALSE(reader.read_row(counts, samples));
}

DeepSpec mixed_types(Imf::Compression compression) {
  return {{{"R", Imf::HALF},
           {"G", Imf::FLOAT},
           {"B", Imf::UINT},
           {"albedo.B", Imf::HALF},
           {"albedo.G", Imf::HALF},
           {"albedo.R", Imf::HALF},
           {"id", Imf::UINT}},
          {-3, -2, -3 + kWidth - 1, -2 + kHeight - 1},
          compression};
}

}  // namespace

TEST_CASE("samples that are written are read again") {
  const TemporaryFolder folder;
  const bool compress = GENERATE(true, false);
  SampleWriter writer(folder / "samples.exr", kWidth, kHeight, kChannels, {{-4, 3}, compress});
  write_rows(writer, kHeight);
  CHECK_FALSE(std::filesystem::exists(folder / "samples.exr"));
  writer.finish();
  CHECK(folder.entries() == 1);

  SampleReader reader(folder / "samples.exr");
  CHECK(reader.width() == kWidth);
  CHECK(reader.height() == kHeight);
  CHECK(reader.data_window() == std::array<int, 4>{-4, 3, 4, 9});
  CHECK(reader.channels() == std::vector<std::string>{"R", "G", "B", "depth.Z", "normal.X", "random.lens.X"});
  check_rows(reader);
  CHECK(fixture::header_of(folder / "samples.exr").compression() ==
        (compress ? Imf::ZIPS_COMPRESSION : Imf::NO_COMPRESSION));
}

TEST_CASE("samples of other programs: types, compression, windows") {
  const TemporaryFolder folder;
  write_deep_file(folder / "samples.exr",
                  mixed_types(GENERATE(Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION)));
  SampleReader reader(folder / "samples.exr");
  CHECK(reader.data_window() == std::array<int, 4>{-3, -2, 5, 4});
  check_rows(reader);
}

TEST_CASE("long runs and noise survive each codec") {
  const TemporaryFolder folder;
  constexpr int kWide = 700;  // rows of more than one run, of an odd number of bytes in half
  const auto compression = GENERATE(Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION);
  write_deep_file(folder / "samples.exr",
                  {{{"R", Imf::HALF}, {"G", Imf::HALF}, {"B", Imf::FLOAT}}, {0, 0, kWide - 1, 3}, compression});
  SampleReader reader(folder / "samples.exr");
  std::vector<std::uint32_t> counts;
  std::vector<float> samples;
  for (int row = 0; row < 4; ++row) {
    REQUIRE(reader.read_row(counts, samples));
    CHECK(samples == row_samples({"R", "G", "B"}, kWide, row));
  }
}

TEST_CASE("channels are understood by their names") {
  const TemporaryFolder folder;
  DeepSpec spec = mixed_types(Imf::ZIPS_COMPRESSION);
  for (const char* name : {"random.time.V", "normal.Z", "normal.Y", "normal.X", "A", "Z", "albedo.A", "variance.R",
                           "position2.X", "random.lens.Y", "random.lens.X"}) {
    spec.channels.push_back({name, Imf::FLOAT});
  }
  write_deep_file(folder / "samples.exr", spec);
  SampleReader reader(folder / "samples.exr");
  const std::vector<SampleLayer>& layers = reader.layers();
  std::vector<std::string> names;
  for (const SampleLayer& layer : layers) names.push_back(layer.name);
  CHECK(names == std::vector<std::string>{"", "albedo", "normal", "position2", "random.lens", "random.time", "A", "Z",
                                          "albedo.A", "id", "variance.R"});
  CHECK(layers[0].kind == Kind::kColour);
  CHECK(layers[1].kind == Kind::kFeature);
  CHECK(layers[1].channels == std::vector<std::string>{"albedo.R", "albedo.G", "albedo.B"});
  CHECK(layers[2].channels == std::vector<std::string>{"normal.X", "normal.Y", "normal.Z"});
  CHECK(layers[4].kind == Kind::kRandom);
  CHECK(layers[6].kind == Kind::kOther);

  reader.select({"random.lens.Y", "R", "albedo.G"});
  CHECK(reader.channels() == std::vector<std::string>{"random.lens.Y", "R", "albedo.G"});
  check_rows(reader);
  expect_error(ErrorCode::kInvalidArgument, {"albedo.X"}, [&] { reader.select({"albedo.X"}); });
  expect_error(ErrorCode::kInvalidArgument, {"R", "twice"}, [&] { reader.select({"R", "R"}); });
  expect_error(ErrorCode::kInvalidArgument, {"no channels"}, [&] { reader.select({}); });
}

TEST_CASE("files that hold no samples are told apart") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  const auto open = [&] { SampleReader reader(path); };
  fixture::write_file(path, {{"", fixture::native_channels()}});
  expect_error(ErrorCode::kUnsupported, {path, "planes, not samples", "deep scanlines"}, open);
  write_deep_file(path, {{{"R"}, {"G"}, {"b"}, {"Z"}}});
  expect_error(ErrorCode::kInvalidFrame, {path, "no channel B", "G, R, Z, b"}, open);
  DeepSpec wide = mixed_types(Imf::ZIPS_COMPRESSION);
  for (const char* name : {"foo.p", "foo.q", "foo.r", "foo.s", "foo.t"}) wide.channels.push_back({name});
  write_deep_file(path, wide);
  expect_error(ErrorCode::kInvalidFrame, {path, "foo", "5 channels"}, open);
  fixture::write_bytes(path, {'t', 'e', 'x', 't', ' ', 't', 'e', 'x', 't'});
  expect_error(ErrorCode::kIo, {path, "not an OpenEXR file"}, open);
  std::filesystem::remove(path);
  expect_error(ErrorCode::kIo, {path, "no such file"}, open);
}

TEST_CASE("the samples may be one part of many") {
  const TemporaryFolder folder;
  const auto layer = fixture::layer("", "RGB", Imf::FLOAT);
  fixture::write_file(
      folder / "in.exr",
      {{"flat", layer}, {"deep", layer, {0, 0, 22, 12}, fixture::Storage::kDeep, Imf::ZIPS_COMPRESSION}});
  SampleReader reader(folder / "in.exr");
  std::vector<std::uint32_t> counts;
  std::vector<float> samples;
  REQUIRE(reader.read_row(counts, samples));
  CHECK(counts[1] == 1);
  CHECK(counts[2] == 2);
  CHECK(samples == [] {  // as the fixture makes them
    std::vector<float> expected;
    for (int x = 0; x < 23; ++x) {
      const auto value = static_cast<float>(x);
      if (x % 3 >= 1) expected.insert(expected.end(), 3, value);
      if (x % 3 == 2) expected.insert(expected.end(), 3, -value);
    }
    return expected;
  }());
}

TEST_CASE("a writer says what it cannot write") {
  const TemporaryFolder folder;
  const std::string path = folder / "samples.exr";
  const auto fails = [&](int width, int height, const std::vector<std::string>& channels,
                         const std::vector<std::string>& words) {
    expect_error(ErrorCode::kInvalidArgument, words, [&] { SampleWriter(path, width, height, channels); });
  };
  fails(0, 5, kChannels, {path, "0 x 5"});
  fails(5, 2'000'000, kChannels, {path, "5 x 2000000"});
  fails(5, 5, {"R", "G", "depth.Z"}, {path, "no channel B"});
  fails(5, 5, {"R", "G", "B", "G"}, {path, "channel G", "twice"});
  fails(5, 5, {"R", "G", "B", ""}, {path, "1 to 255 characters"});
  fails(5, 5, {}, {path, "no channels"});
  expect_error(ErrorCode::kInvalidArgument, {path, "origin"}, [&] {
    SampleWriter(path, 5, 5, kChannels, {{2'000'000'000, 0}, true});
  });
  const std::string nowhere = folder / "no/samples.exr";
  expect_error(ErrorCode::kIo, {nowhere, "No such file"}, [&] { SampleWriter(nowhere, 5, 5, kChannels); });
  CHECK(folder.entries() == 0);
}

TEST_CASE("rows of a file of samples are counted") {
  const TemporaryFolder folder;
  const std::string path = folder / "samples.exr";
  {
    SampleWriter writer(path, kWidth, kHeight, kChannels);
    write_rows(writer, kHeight - 1);
    expect_error(ErrorCode::kInvalidArgument, {path, "6 of its 7 rows"}, [&] { writer.finish(); });
    const std::vector<std::uint32_t> many(kWidth, 100'000'000);
    expect_error(ErrorCode::kInvalidArgument, {path, "row 6", "900000000 samples", "2^31"},
                 [&] { writer.write_row(many.data(), nullptr); });
    const std::vector<std::uint32_t> few(kWidth, 1);
    expect_error(ErrorCode::kInvalidArgument, {path, "none are given"}, [&] { writer.write_row(few.data(), nullptr); });
    CHECK(folder.entries() == 1);  // the temporary one
  }
  CHECK(folder.entries() == 0);
  SampleWriter writer(path, kWidth, kHeight, kChannels);
  write_rows(writer, kHeight);
  expect_error(ErrorCode::kInvalidArgument, {path, "already written"}, [&] { write_rows(writer, 1); });
  writer.finish();
  expect_error(ErrorCode::kInvalidArgument, {path, "finished"}, [&] { writer.finish(); });
}

TEST_CASE("a full disk leaves no file of samples") {
  const TemporaryFolder folder;
  const std::string path = folder / "samples.exr";
  const auto write = [&] {
    SampleWriter writer(path, kWidth, kHeight, kChannels);
    write_rows(writer, kHeight);
    writer.finish();
  };
  write();
  const auto size = static_cast<rlim_t>(std::filesystem::file_size(path));
  fixture::write_bytes(path, {'o', 'l', 'd'});
  for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, size / 2, size - 1}) {
    const FileSizeLimit full_disk(limit);
    expect_error(ErrorCode::kIo, {path}, write);
  }
  CHECK(fixture::bytes_of(path) == std::vector<unsigned char>{'o', 'l', 'd'});
  CHECK(folder.entries() == 1);
}

TEST_CASE("planes next to samples keep the window and the attributes") {
  const TemporaryFolder folder;
  const std::string path = folder / "planes.exr";
  write_deep_file(folder / "samples.exr", mixed_types(Imf::ZIPS_COMPRESSION));
  const SampleReader source(folder / "samples.exr");
  std::vector<float> values(std::size_t{2} * kWidth * kHeight);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  const auto band = [&](int first, int rows) {
    const float* at = values.data() + static_cast<std::ptrdiff_t>(first) * kWidth;
    return std::vector<std::pair<std::string, stein::ConstPlaneView>>{{"R", {at, kWidth, rows}},
                                                                      {"x", {at + kWidth * kHeight, kWidth, rows}}};
  };
  {
    PlanesWriter writer(path, source, {"R", "x"});
    writer.write_rows(band(0, 4));
    expect_error(ErrorCode::kInvalidArgument, {path, "3 rows"}, [&] { writer.finish(); });
    expect_error(ErrorCode::kInvalidArgument, {path, "only 3 are left"}, [&] { writer.write_rows(band(0, 4)); });
    auto other = band(4, 3);
    other[1].first = "y";
    expect_error(ErrorCode::kInvalidArgument, {path, "plane y", "x"}, [&] { writer.write_rows(other); });
    other[1] = {"x", {values.data(), kWidth, 2}};
    expect_error(ErrorCode::kInvalidArgument, {path, "9 x 2", "9 x 3"}, [&] { writer.write_rows(other); });
    other.pop_back();
    expect_error(ErrorCode::kInvalidArgument, {path, "1 planes", "2 channels"}, [&] { writer.write_rows(other); });
    writer.write_rows(band(4, 3));
    CHECK_FALSE(std::filesystem::exists(path));
    writer.finish();
  }
  const stein::exr::NamedPlanes planes = stein::exr::read_planes(path, {"R", "x"});
  CHECK(planes.data_window == source.data_window());
  CHECK(planes.planes[0].row(6)[8] == 62);
  CHECK(planes.planes[1].row(5)[1] == 63 + 46);
  CHECK(Imf::owner(fixture::header_of(path)) == "a studio");
  CHECK(folder.entries() == 2);
}

}  // namespace fixture
