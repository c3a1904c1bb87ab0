// SPDX-License-Identifier: Apache-2.0
//
// Raw samples to planes: the moments, what is left out, and what becomes of damaged input and full disks.
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "stein/exr.hpp"
#include "stein/exr_samples.hpp"
#include "synthetic.hpp"

namespace {

using stein::exr::SampleWriter;

constexpr int kWidth = 13;
constexpr int kHeight = 37;  // bands of 16 rows, and a rest
const std::vector<std::string> kChannels = {"R",        "G",       "B",       "albedo.R",      "albedo.G",
                                            "albedo.B", "gloss.v", "gloss.u", "random.lens.X", "random.lens.Y"};

/// All samples of an image, by pixel; those of a pixel one after the other, as many floats each as kChannels.
struct Dump {
  std::vector<std::vector<float>> pixels;

  [[nodiscard]] std::size_t count(std::size_t pixel) const { return pixels[pixel].size() / kChannels.size(); }
  /// Of all samples of a pixel, one channel.
  [[nodiscard]] std::vector<double> values(std::size_t pixel, const std::string& channel) const {
    const auto at = std::find(kChannels.begin(), kChannels.end(), channel) - kChannels.begin();
    std::vector<double> values;
    for (auto i = static_cast<std::size_t>(at); i < pixels[pixel].size(); i += kChannels.size()) {
      values.push_back(pixels[pixel][i]);
    }
    return values;
  }
};

/// Correlated channels; 2 to 6 samples, but none in pixel 5 and one in pixel 6.
Dump make_dump() {
  std::mt19937 random(11);
  const auto uniform = [&] { return static_cast<float>(random() % 10'000) / 10'000.0F; };
  Dump dump;
  for (std::size_t pixel = 0; pixel < std::size_t{kWidth} * kHeight; ++pixel) {
    std::vector<float>& samples = dump.pixels.emplace_back();
    const std::size_t count = pixel == 5 ? 0 : pixel == 6 ? 1 : 2 + random() % 5;
    for (std::size_t i = 0; i < count; ++i) {
      const float shared = uniform();
      for (std::size_t k = 0; k < kChannels.size(); ++k) samples.push_back(shared + static_cast<float>(k) * uniform());
    }
  }
  return dump;
}

void write_dump(const std::string& path, const Dump& dump, std::array<int, 2> origin = {0, 0}) {
  SampleWriter writer(path, kWidth, kHeight, kChannels, {origin, true});
  for (int y = 0; y < kHeight; ++y) {
    std::vector<std::uint32_t> counts;
    std::vector<float> samples;
    for (std::size_t x = 0; x < kWidth; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * kWidth + x;
      counts.push_back(static_cast<std::uint32_t>(dump.count(pixel)));
      samples.insert(samples.end(), dump.pixels[pixel].begin(), dump.pixels[pixel].end());
    }
    writer.write_row(counts.data(), samples.data());
  }
  writer.finish();
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// Of the means.
double covariance(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < 2) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean(a)) * (b[i] - mean(b));
  return sum / static_cast<double>(a.size() * (a.size() - 1));
}

template <class Expected>
void check_plane(const std::string& path, const std::string& name, const Expected& expected) {
  const std::vector<float> plane = read_channel(path, name);
  REQUIRE(plane.size() == std::size_t{kWidth} * kHeight);
  std::size_t wrong = 0;
  for (std::size_t pixel = 0; pixel < plane.size(); ++pixel) {
    wrong += std::abs(plane[pixel] - expected(pixel)) <= 1e-6 * (1 + std::abs(expected(pixel))) ? 0 : 1;
  }
  INFO(name);
  CHECK(wrong == 0);
}

void check_moments(const std::string& path, const Dump& dump) {
  const auto values = [&](std::size_t pixel, const std::string& name) { return dump.values(pixel, name); };
  check_plane(path, "sampleCount", [&](std::size_t p) { return static_cast<double>(dump.count(p)); });
  for (const std::string channel : {"R", "G", "B", "albedo.G", "gloss.u", "gloss.v"}) {
    check_plane(path, channel, [&](std::size_t p) { return mean(values(p, channel)); });
  }
  const std::vector<std::array<std::string, 3>> covariances = {
      {"variance.R", "R", "R"},
      {"variance.B", "B", "B"},
      {"covariance.R.G", "R", "G"},
      {"covariance.G.B", "G", "B"},
      {"albedo.variance.B", "albedo.B", "albedo.B"},
      {"gloss.variance.u", "gloss.u", "gloss.u"},
      {"covariance.B.albedo.R", "B", "albedo.R"},
      {"covariance.G.gloss.v", "G", "gloss.v"},
  };
  for (const std::array<std::string, 3>& names : covariances) {
    check_plane(path, names[0], [&](std::size_t p) { return covariance(values(p, names[1]), values(p, names[2])); });
  }
}

void check_fails(const std::vector<std::string>& arguments, int exit_code, const std::vector<std::string>& words,
                 long file_size_limit = 0) {
  const Outcome outcome = run_stein(arguments, file_size_limit);
  INFO(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  for (const std::string& word : words) {
    CHECK(outcome.err.find(word) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("accumulate: samples to the moments of each pixel") {
  const TemporaryFolder folder;
  const std::string out = folder / "planes.exr";
  const Dump dump = make_dump();
  write_dump(folder / "samples.exr", dump, {-3, 2});
  const Outcome outcome = run_stein({"accumulate", folder / "samples.exr", "-o", out});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  check_moments(out, dump);
  CHECK_FALSE(has_channel(out, "random.lens.X"));
  CHECK(stein::exr::read_planes(out).data_window == std::array<int, 4>{-3, 2, 9, 38});
  CHECK(outcome.out.find("left out  random.lens\n") != std::string::npos);
  CHECK(outcome.out.find("feature   gloss (2 channels)\n") != std::string::npos);
  CHECK(outcome.out.find("0 to 6 per pixel\n") != std::string::npos);
  CHECK(outcome.out.find("rejected  0 samples\n") != std::string::npos);
  CHECK(outcome.out.find("empty     1 pixels\n") != std::string::npos);
  CHECK(outcome.err.find("1 pixels with one sample") != std::string::npos);
  CHECK(outcome.err.find("100%\n") != std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"planes.exr", "samples.exr"});

  const Outcome info = run_stein({"info", out});
  CHECK(info.exit_code == 0);
  CHECK(info.out.find("covariance.R.G ") != std::string::npos);
  CHECK(info.out.find("missing\n  no normal") != std::string::npos);
  CHECK(run_stein({"denoise", out, "-o", folder / "clean.exr", "--quiet"}).exit_code == 0);
}

TEST_CASE("accumulate: what is left out") {
  const TemporaryFolder folder;
  const std::string out = folder / "planes.exr";
  const Dump dump = make_dump();
  write_dump(folder / "samples.exr", dump);
  const Outcome outcome = run_stein(
      {"accumulate", folder / "samples.exr", "-o", out, "--leave-out", "gloss", "--no-covariances", "--quiet"});
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find('%') == std::string::npos);
  check_plane(out, "albedo.B", [&](std::size_t p) { return mean(dump.values(p, "albedo.B")); });
  CHECK(has_channel(out, "albedo.variance.R"));
  for (const char* name : {"gloss.u", "gloss.variance.u", "covariance.R.G", "covariance.R.albedo.G"}) {
    CHECK_FALSE(has_channel(out, name));
  }
  check_fails({"accumulate", folder / "samples.exr", "-o", out, "--leave-out", "normal"}, 2,
              {"normal", "albedo gloss"});
  check_fails({"accumulate", folder / "samples.exr", "-o", folder / "samples.exr"}, 2, {"is the input"});
  check_fails({"accumulate", folder / "samples.exr"}, 2, {"--output"});
}

TEST_CASE("accumulate: samples that are not finite are rejected and counted") {
  const TemporaryFolder folder;
  const std::string out = folder / "planes.exr";
  Dump dump = make_dump();
  Dump kept = dump;
  const std::size_t channels = kChannels.size();
  dump.pixels[20][1] = std::numeric_limits<float>::quiet_NaN();
  dump.pixels[50][channels + 2] = std::numeric_limits<float>::infinity();
  dump.pixels[60][4] = std::numeric_limits<float>::quiet_NaN();  // of a feature
  const auto first = [](std::vector<float>& samples) { return samples.begin(); };
  kept.pixels[20].erase(first(kept.pixels[20]), first(kept.pixels[20]) + static_cast<std::ptrdiff_t>(channels));
  kept.pixels[50].erase(first(kept.pixels[50]) + static_cast<std::ptrdiff_t>(channels),
                        first(kept.pixels[50]) + static_cast<std::ptrdiff_t>(2 * channels));
  std::fill_n(kept.pixels[60].begin() + 3, 3, 0.0F);
  write_dump(folder / "samples.exr", dump);
  const Outcome outcome = run_stein({"accumulate", folder / "samples.exr", "-o", out});
  REQUIRE(outcome.exit_code == 0);
  check_moments(out, kept);
  CHECK(outcome.out.find("rejected  2 samples\n") != std::string::npos);
  CHECK(outcome.err.find("warning: 2 samples rejected") != std::string::npos);
  CHECK(outcome.err.find("warning: 1 samples with a feature") != std::string::npos);

  std::fill_n(dump.pixels.begin(), dump.pixels.size(), std::vector<float>());
  write_dump(folder / "none.exr", dump);
  check_fails({"accumulate", folder / "none.exr", "-o", folder / "out.exr"}, 3, {"none.exr", "no sample"});
  CHECK(folder.names() == std::vector<std::string>{"none.exr", "planes.exr", "samples.exr"});
}

TEST_CASE("accumulate: unusable input leaves nothing behind") {
  const TemporaryFolder folder;
  const std::string out = folder / "planes.exr";
  write_dump(folder / "samples.exr", make_dump());
  std::filesystem::resize_file(folder / "samples.exr", std::filesystem::file_size(folder / "samples.exr") * 2 / 3);
  check_fails({"accumulate", folder / "samples.exr", "-o", out}, 4, {"samples.exr", "row y = ", "truncated"});
  write(folder / "flat.exr", flat_image(8, 8, 1));
  check_fails({"accumulate", folder / "flat.exr", "-o", out}, 3, {"flat.exr", "planes, not samples"});
  check_fails({"accumulate", folder / "absent.exr", "-o", out}, 4, {"absent.exr", "no such file"});
  check_fails({"accumulate", folder / "flat.exr", "-o", folder / "no/planes.exr"}, 4, {"no/planes.exr"});
  CHECK(folder.names() == std::vector<std::string>{"flat.exr", "samples.exr"});
}

TEST_CASE("accumulate: a full disk leaves no half file") {
  const TemporaryFolder folder;
  write_dump(folder / "samples.exr", make_dump());
  for (const long limit : {300L, 20'000L}) {  // within the header, and within the rows
    check_fails({"accumulate", folder / "samples.exr", "-o", folder / "planes.exr", "--quiet"}, 4, {"planes.exr"},
                limit);
  }
  CHECK(folder.names() == std::vector<std::string>{"samples.exr"});
}

TEST_CASE("accumulate: an interrupt cancels and leaves nothing behind") {
  const TemporaryFolder folder;
  constexpr int kRows = 400;
  {
    SampleWriter writer(folder / "samples.exr", 2, kRows, {"R", "G", "B"});
    const std::vector<std::uint32_t> counts(2, 1);
    const std::vector<float> samples(6, 1.0F);
    for (int y = 0; y < kRows; ++y) writer.write_row(counts.data(), samples.data());
    writer.finish();
  }
  HaltedProgram program({"accumulate", folder / "samples.exr", "-o", folder / "planes.exr"});
  REQUIRE(program.wait_for_progress());
  program.send(SIGINT);
  program.drain();
  CHECK(program.outcome().exit_code == 5);
  CHECK(program.outcome().err.find("stein: cancelled\n") != std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"samples.exr"});
}
