// SPDX-License-Identifier: Apache-2.0
//
// Files read into scratch files, filtered and written from there are what they are without a memory limit.
#include <cstring>
#include <memory>

#include "catch.hpp"
#include "expect_error.hpp"
#include "exr/file_size_limit.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::DenoiseParams;
using stein::DenoiseResult;
using stein::Memory;
using stein::MemoryLimit;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::ReadOptions;
using stein::exr::write_results;

namespace {

std::shared_ptr<Memory> all_in(const TemporaryFolder& folder) {
  return std::make_shared<Memory>(MemoryLimit{std::int64_t{1} << 27, folder.path().string(), 0.0});
}

bool same_planes(const stein::Frame& a, const stein::Frame& b) {
  const auto planes = named_planes(a);
  const auto others = named_planes(b);
  std::vector<float> row(static_cast<std::size_t>(a.width));
  std::vector<float> other(row);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].first != others.at(i).first) return false;
    for (int y = 0; y < a.height; ++y) {
      planes[i].second.read_row(y, 0, a.width, row.data());
      others[i].second.read_row(y, 0, a.width, other.data());
      if (std::memcmp(row.data(), other.data(), row.size() * sizeof(float)) != 0) return false;
    }
  }
  return planes.size() == others.size();
}

// Reads the views of a file, filters them, and writes the result.
std::vector<unsigned char> output_of(const std::string& in, const std::string& out, ReadOptions read,
                                     const std::vector<std::string>& views) {
  std::vector<LoadedFrame> frames;
  std::vector<DenoiseResult> results;
  for (const std::string& view : views) {
    read.view = view;
    frames.push_back(read_frame(in, read));
    DenoiseParams params;
    params.filters = {stein::GaussianParams{}};
    params.execution.memory = read.memory;
    results.push_back(denoise(frames.back().frame(), params));
  }
  std::vector<stein::exr::ViewResult> all;
  for (std::size_t v = 0; v < views.size(); ++v) all.push_back({frames[v], results[v]});
  write_results(out, all);
  return bytes_of(out);
}

void check_same_output(const std::string& name, const std::vector<fixture::PartSpec>& parts, ReadOptions options,
                       const std::vector<std::string>& views = {""}) {
  INFO(name);
  const TemporaryFolder folder;
  const TemporaryFolder scratch;
  write_file(folder / "in.exr", parts);
  const auto expected = output_of(folder / "in.exr", folder / "plain.exr", options, views);
  options.memory = all_in(scratch);
  const bool is_same = output_of(folder / "in.exr", folder / "limited.exr", options, views) == expected;
  CHECK(is_same);
  CHECK(options.memory->usage().scratch_bytes > 0);
  CHECK(scratch.entries() == 0);
}

fixture::PartSpec eye(const char* name) {
  fixture::PartSpec part{name, native_channels()};
  part.edit = [name](Imf::Header& header) { header.setView(name); };
  return part;
}

}  // namespace

TEST_CASE("limited memory: files of every storage give the same output") {
  check_same_output("scanlines", {{"", native_channels()}}, {});
  check_same_output("tiles", {{"", native_channels(), {0, 0, 22, 12}, Storage::kTiles}}, {});
  check_same_output("layers", {{"", native_channels() + fixture::layer("key", "RGB", Imf::HALF)}}, {.layers = {"key"}});
  check_same_output("variances of samples", {{"", native_channels()}},
                    {.variance_of = stein::exr::VarianceOf::kSample});
  check_same_output("views", {eye("left"), eye("right")}, {}, {"left", "right"});
}

TEST_CASE("limited memory: a file is read a few rows at a time") {
  const TemporaryFolder folder;
  const auto [storage, compression] =
      GENERATE(std::pair(Storage::kScanlines, Imf::ZIP_COMPRESSION),
               std::pair(Storage::kScanlines, Imf::DWAB_COMPRESSION), std::pair(Storage::kTiles, Imf::ZIP_COMPRESSION));
  // One block of rows is half of what is read at a time.
  write_file(folder / "in.exr", {{"", native_channels(), {-3, -5, 1800, 290}, storage, compression}});
  const LoadedFrame plain = read_frame(folder / "in.exr");
  std::vector<double> told;
  ReadOptions options{.memory = all_in(folder)};
  options.progress = [&told](double done) {
    told.push_back(done);
    return true;
  };
  const LoadedFrame limited = read_frame(folder / "in.exr", options);
  CHECK(same_planes(plain.frame(), limited.frame()));
  CHECK(told.size() > 3);
}

TEST_CASE("limited memory: no room for the planes of a file is told before it is read") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", colour_channels()}});
  const ReadOptions options{.memory = all_in(folder)};
  const FileSizeLimit limit(1000);
  expect_error(stein::ErrorCode::kIo, {folder.path().string(), "no room for", "bytes", "--scratch"},
               [&] { (void)read_frame(folder / "in.exr", options); });
}

}  // namespace fixture
