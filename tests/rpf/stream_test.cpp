// SPDX-License-Identifier: Apache-2.0
//
// Rows, threads, cancelling, and frames side by side in time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "catch.hpp"
#include "rpf/samples.hpp"
#include "stein/error.hpp"
#include "support/temporary_folder.hpp"

namespace {

using stein::Error;
using stein::ErrorCode;
using stein::RpfParams;
using stein::test::filter_image;
using stein::test::FilteredImage;
using stein::test::make_wall;
using stein::test::SampleImage;

RpfParams tiny_boxes() {
  RpfParams params;
  params.boxes = {7, 5, 3};
  params.shares = {0.5F, 0.5F, 0.5F};
  params.return_sigma = 2;
  return params;
}

/// Rows [first, first + rows) of an image.
SampleImage rows_of(const SampleImage& image, int first, int rows) {
  const auto begin = image.pixels.begin() + static_cast<std::ptrdiff_t>(first) * image.width;
  return {image.width, rows, image.groups, {begin, begin + static_cast<std::ptrdiff_t>(rows) * image.width}};
}

}  // namespace

TEST_CASE("results have the same bits for any number of threads") {
  const SampleImage wall = make_wall(37, 61, 4);
  RpfParams params = tiny_boxes();
  params.draws = 1;
  const FilteredImage one = filter_image(wall, params, stein::test::on_threads(1));
  for (const int threads : {0, 2, 5}) {
    const FilteredImage other = filter_image(wall, params, stein::test::on_threads(threads));
    CHECK(one.colour == other.colour);
    CHECK(one.error == other.error);
  }
  params.seed = 2;
  CHECK(one.colour != filter_image(wall, params).colour);
}

TEST_CASE("rows in scratch files give the same bits, also where their pages are given back all the time") {
  const TemporaryFolder folder;
  constexpr std::int64_t kLeast = std::int64_t{1} << 27;
  const std::vector<char> ballast(static_cast<std::size_t>(kLeast), 'b');  // the process holds what it may: it trims
  SampleImage wall = make_wall(37, 90, 4);
  for (std::size_t i = 0; i < wall.pixels.size(); ++i) {  // rows that are longer than those in whose place they come
    for (std::size_t more = i / 37 / 20; more > 0; --more) {
      const std::vector<float> first(wall.pixels[i].begin(), wall.pixels[i].begin() + wall.channels());
      wall.pixels[i].insert(wall.pixels[i].end(), first.begin(), first.end());
    }
  }
  wall.pixels[37 * 30 + 3].clear();
  wall.pixels[37 * 31 + 3][0] = std::numeric_limits<float>::quiet_NaN();
  RpfParams params = tiny_boxes();
  params.draws = 1;
  const std::vector<SampleImage> others = {make_wall(37, 90, 4, 2, 3)};
  const FilteredImage plain = filter_image(wall, params, stein::test::on_threads(2), others);
  CHECK(plain.report.scratch_bytes == 0);
  stein::Execution limited = stein::test::on_threads(2);
  limited.memory = std::make_shared<stein::Memory>(stein::MemoryLimit{kLeast, folder.path().string(), 0.0});
  const FilteredImage filed = filter_image(wall, params, limited, others);
  CHECK(plain.colour == filed.colour);
  CHECK(plain.error == filed.error);
  CHECK(filed.report.scratch_bytes > 37 * 50 * 4 * 16 * 4);  // a window of the frame's records alone
  const auto& warnings = filed.report.warnings;
  CHECK(std::any_of(warnings.begin(), warnings.end(),
                    [](const std::string& text) { return text.find("windows of rows take") != std::string::npos; }));
  CHECK(folder.entries() == 0);
  CHECK(ballast.back() == 'b');
}

TEST_CASE("a tall image in a window of rows gives what its top gives alone, as far as the stages do not see the end") {
  const SampleImage tall = make_wall(9, 160, 3);  // several times the window
  const SampleImage top = rows_of(tall, 0, 60);
  const FilteredImage all = filter_image(tall, tiny_boxes());
  const FilteredImage part = filter_image(top, tiny_boxes());
  constexpr int kReach = 3 + 2 + 1 + 4;
  const auto end = static_cast<std::ptrdiff_t>((60 - kReach) * 9 * 3);
  CHECK(std::equal(part.colour.begin(), part.colour.begin() + end, all.colour.begin()));
  CHECK(!std::equal(part.colour.begin(), part.colour.end(), all.colour.begin()));
}

TEST_CASE("rows are asked for once and in time, and handed out from the top without gaps") {
  const SampleImage wall = make_wall(8, 200, 2);
  int read = 0;
  int written = 0;
  int most_ahead = 0;
  stein::SampleSource source = wall.source();
  source.next_row = [&, inner = source.next_row](auto& counts, auto& samples) {
    inner(counts, samples);
    most_ahead = std::max(most_ahead, ++read - written);
  };
  static_cast<void>(
      stein::filter_samples(source, tiny_boxes(), stein::test::on_threads(1), [&](const stein::RpfBand& band) {
        CHECK(band.y == written);
        CHECK(!band.error[0]);
        written += band.colour[0].height();
      }));
  CHECK(read == 200);
  CHECK(written == 200);
  CHECK(most_ahead < 60);
}

TEST_CASE("progress rises to 1, and can cancel") {
  const SampleImage wall = make_wall(16, 50, 2);
  std::vector<double> seen;
  const auto remember = [&](double fraction) {
    seen.push_back(fraction);
    return true;
  };
  stein::Execution execution = stein::test::on_threads(2);
  execution.progress = remember;
  static_cast<void>(filter_image(wall, tiny_boxes(), execution));
  CHECK(std::is_sorted(seen.begin(), seen.end()));
  CHECK(seen.back() == Approx(1));
  execution.progress = [](double fraction) { return fraction < 0.3; };
  try {
    static_cast<void>(filter_image(wall, tiny_boxes(), execution));
    FAIL("not cancelled");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::kCancelled);
  }
}

TEST_CASE("frames beside it lower the noise of a frame, also where things have moved") {
  const SampleImage frame = make_wall(24, 24, 4, 1);
  const std::vector<SampleImage> others = {make_wall(24, 24, 4, 2, 3), make_wall(24, 24, 4, 3, -3)};
  RpfParams params = tiny_boxes();
  params.search_radius = 3;
  const auto error = [](const FilteredImage& image) {
    double sum = 0;
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 24; ++x) sum += std::pow(image.at(x, y, 0) / (x < 12 ? 0.2 : 0.8) - 1, 2);
    }
    return sum;
  };
  const double alone = error(filter_image(frame, params));
  const FilteredImage one = filter_image(frame, params, stein::test::on_threads(1), others);
  CHECK(error(one) < 0.8 * alone);
  CHECK(one.colour == filter_image(frame, params, stein::test::on_threads(3), others).colour);
  const std::vector<SampleImage> wrong = {make_wall(24, 23, 4)};
  CHECK_THROWS_AS(filter_image(frame, params, stein::test::on_threads(1), wrong), Error);
}

TEST_CASE("rows that do not hold what they say are refused") {
  const SampleImage wall = make_wall(6, 5, 2);
  stein::SampleSource source = wall.source();
  source.next_row = [inner = source.next_row](auto& counts, auto& samples) {
    inner(counts, samples);
    samples.pop_back();
  };
  CHECK_THROWS_AS(stein::filter_samples(source, tiny_boxes(), stein::test::on_threads(1), [](const stein::RpfBand&) {}),
                  Error);
}
