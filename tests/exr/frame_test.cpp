// SPDX-License-Identifier: Apache-2.0
//
// write_frame: a frame in place of the source's own, and what is read back.
#include <ImfFloatAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <algorithm>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"
#include "stein/accumulate.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::Frame;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::write_frame;
using Names = std::vector<std::string>;

namespace {

const std::vector<ChannelSpec> kStrangers = {{"A", Imf::HALF}, {"id", Imf::UINT, true}};

/// A frame of the fixture's size, of two estimates of 4 samples: 1 degree of freedom.
stein::Moments two_estimates(const stein::SampleLayout& layout) {
  stein::Accumulator film(23, 13, layout);
  for (int y = 0; y < 13; ++y) {
    for (int x = 0; x < 23; ++x) {
      std::vector<float> values(static_cast<std::size_t>(layout.channels()), static_cast<float>(x + 2 * y));
      film.add(x, y, stein::Estimate{.samples = 4, .mean = values.data()});
      std::fill(values.begin(), values.end(), static_cast<float>(x));
      film.add(x, y, stein::Estimate{.samples = 4, .mean = values.data()});
    }
  }
  return film.moments();
}

void check_equal(const Frame& found, const Frame& expected) {
  const auto a = named_planes(found);
  const auto b = named_planes(expected);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    INFO(b[i].first);
    CHECK(a[i].first == b[i].first);
    for (int y = 0; y < 13; ++y) {
      for (int x = 0; x < 23; ++x) REQUIRE(a[i].second.at(x, y) == b[i].second.at(x, y));
    }
  }
}

}  // namespace

TEST_CASE("a frame replaces the source's own; the rest is carried over") {
  const TemporaryFolder folder;
  const auto storage = GENERATE(Storage::kScanlines, Storage::kTiles);
  const auto edit = [](Imf::Header& header) {
    header.insert("owner", Imf::StringAttribute("somebody"));
    header.insert("samplesPerPixel", Imf::IntAttribute(4));
  };
  const auto depth_by_another_name = layer("depth", "T", Imf::HALF);
  write_file(folder / "in.exr", {{"",
                                  colour_channels() + kStrangers + layer("albedo", "RGB", Imf::HALF) +
                                      depth_by_another_name + layer("error", "RGB", Imf::FLOAT),
                                  {0, 0, 22, 12},
                                  storage,
                                  Imf::ZIP_COMPRESSION,
                                  edit}});
  const stein::Moments moments = two_estimates({.features = {{"albedo", 3}, {"depth", 1}}});
  write_frame(folder / "out.exr", moments.frame(), read_frame(folder / "in.exr"));

  const LoadedFrame read = read_frame(folder / "out.exr");
  check_equal(read.frame(), moments.frame());
  CHECK(read.frame().degrees_of_freedom == 1);
  for (const std::string name : {"A", "id"})
    CHECK(read_raw(folder / "in.exr", 0, name) == read_raw(folder / "out.exr", 0, name));
  const Names names = channel_names(folder / "out.exr");
  CHECK(std::find(names.begin(), names.end(), "depth.T") == names.end());
  CHECK(std::find(names.begin(), names.end(), "error.R") == names.end());
  const Imf::Header header = header_of(folder / "out.exr");
  CHECK(header.findTypedAttribute<Imf::StringAttribute>("owner") != nullptr);
  CHECK(header.findTypedAttribute<Imf::IntAttribute>("samplesPerPixel") == nullptr);
  CHECK(folder.entries() == 2);
}

TEST_CASE("a frame replaces features in other parts; one number of samples is an attribute") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"beauty", colour_channels() + kStrangers},
                                 {"albedo", {{"R"}, {"G"}, {"B"}}},
                                 {"ids", {{"mask", Imf::UINT, true}}}});
  const stein::Moments moments = two_estimates({.features = {{"albedo", 3}}, .covariances = false});
  Frame frame = moments.frame();
  frame.sample_count = {};
  frame.uniform_sample_count = 7.5F;
  frame.degrees_of_freedom = 0;
  write_frame(folder / "out.exr", frame, read_frame(folder / "in.exr"));
  CHECK(parts_of(folder / "out.exr") == 2);
  CHECK(read_raw(folder / "in.exr", 2, "mask") == read_raw(folder / "out.exr", 1, "mask"));
  const LoadedFrame read = read_frame(folder / "out.exr");
  check_equal(read.frame(), frame);
  CHECK(read.frame().uniform_sample_count == 7.5F);
  CHECK(read.frame().degrees_of_freedom == 0);
}

TEST_CASE("frames that cannot be written") {
  const TemporaryFolder folder;
  write_file(folder / "in.exr", {{"", colour_channels()}});
  const LoadedFrame source = read_frame(folder / "in.exr");
  stein::Accumulator film(2, 2, {});
  const stein::Moments small = film.moments();
  expect_error(ErrorCode::kInvalidArgument, {"out.exr", "2 x 2", "23 x 13", "in.exr"},
               [&] { write_frame(folder / "out.exr", small.frame(), source); });
  Frame frame = source.frame();
  frame.degrees_of_freedom = -1;
  expect_error(ErrorCode::kInvalidFrame, {"degrees of freedom", "-1"},
               [&] { write_frame(folder / "out.exr", frame, source); });
  CHECK(folder.entries() == 1);
}

TEST_CASE("files without variances are read where they need not have any") {
  const TemporaryFolder folder;
  const std::vector<ChannelSpec> colour = {{"R"}, {"G"}, {"B"}, {"sampleCount"}};
  write_file(folder / "in.exr", {{"", colour + layer("albedo", "RGB", Imf::HALF)}});
  write_file(folder / "half.exr", {{"", colour + std::vector<ChannelSpec>{{"variance.R"}}}});
  expect_error(ErrorCode::kInvalidFrame, {"variance.R, variance.G"}, [&] { (void)read_frame(folder / "in.exr"); });
  const LoadedFrame read = read_frame(folder / "in.exr", {.require_variance = false});
  CHECK_FALSE(read.frame().colour_variance[0]);
  CHECK(fixture::holds(read.frame().colour[1], "G"));
  CHECK(fixture::holds(read.frame().features.at(0).mean[2], "albedo.B"));
  expect_error(ErrorCode::kInvalidFrame, {"variance.R"}, [&] { check(read.frame()); });
  expect_error(ErrorCode::kInvalidFrame, {"variance.G, variance.B"},
               [&] { (void)read_frame(folder / "half.exr", {.require_variance = false}); });
}

}  // namespace fixture
