// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <algorithm>
#include <csignal>
#include <string>
#include <vector>

#include "catch.hpp"
#include "stein/exr.hpp"
#include "stein/exr_samples.hpp"

namespace {

Outcome run_pathtracer(const std::vector<std::string>& arguments) { return run_stein(arguments); }

}  // namespace

TEST_CASE("pathtracer: writes planes with features and covariances") {
  const TemporaryFolder folder;
  const std::string file = folder / "noisy.exr";
  const Outcome outcome = run_pathtracer({"--scene", "cornell", "--size", "40x30", "--samples", "4", "-o", file});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("cornell, 40x30, 4 samples") != std::string::npos);
  const stein::exr::LoadedFrame loaded = stein::exr::read_frame(file);
  const stein::Frame& frame = loaded.frame();
  CHECK(frame.width == 40);
  CHECK(frame.sample_count.at(7, 8) == 4);
  CHECK(frame.colour_covariance[0]);
  std::vector<std::string> names;
  for (const stein::Feature& feature : frame.features) {
    names.push_back(feature.name);
    CHECK(feature.variance.size() == feature.mean.size());
    CHECK(feature.colour_covariance.size() == 3 * feature.mean.size());
  }
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"albedo", "depth", "normal", "position", "visibility"});
  CHECK(folder.names() == std::vector<std::string>{"noisy.exr"});
}

TEST_CASE("pathtracer: dumps hold the samples of the planes") {
  const TemporaryFolder folder;
  const Outcome outcome = run_pathtracer({"--scene", "motion", "--size", "20x15", "--samples", "3", "-o",
                                          folder / "noisy.exr", "--dump", folder / "samples.exr", "--quiet"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.empty());
  const stein::exr::NamedPlanes planes = stein::exr::read_planes(folder / "noisy.exr", {"R"});
  stein::exr::SampleReader reader(folder / "samples.exr");
  CHECK(reader.channels().size() == 27);
  reader.select({"R", "random.time.T"});
  std::vector<std::uint32_t> counts;
  std::vector<float> samples;
  for (int y = 0; y < 15; ++y) {
    REQUIRE(reader.read_row(counts, samples));
    REQUIRE(samples.size() == 20 * 3 * 2);
    for (std::size_t x = 0; x < 20; ++x) {
      const float* s = samples.data() + x * 6;
      CHECK(planes.planes[0].row(y)[x] == Approx((s[0] + s[2] + s[4]) / 3).margin(1e-6));
      CHECK(s[1] != s[3]);
    }
  }
}

TEST_CASE("pathtracer: references hold the colour and its variance") {
  const TemporaryFolder folder;
  REQUIRE(run_pathtracer(
              {"--scene", "spheres", "--size", "8x6", "--samples", "5", "--reference", "-o", folder / "reference.exr"})
              .exit_code == 0);
  const stein::exr::LoadedFrame loaded = stein::exr::read_frame(folder / "reference.exr");
  CHECK(loaded.frame().features.empty());
  CHECK(loaded.channels().size() == 7);
}

TEST_CASE("pathtracer: adaptive sampling spends the budget exactly") {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_pathtracer({"--scene", "motion", "--size", "48x36", "--samples", "9", "--adaptive", "--iterations", "2", "-o",
                      folder / "noisy.exr", "--denoised", folder / "clean.exr"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("9 samples per pixel on average") != std::string::npos);
  const stein::exr::NamedPlanes counts = stein::exr::read_planes(folder / "noisy.exr", {"sampleCount"});
  double sum = 0;
  float least = 1e9F;
  float most = 0;
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 48; ++x) {
      const float n = counts.planes[0].row(y)[x];
      sum += n;
      least = std::min(least, n);
      most = std::max(most, n);
    }
  }
  CHECK(sum == 48 * 36 * 9);
  CHECK(least >= 4);
  CHECK(most > 12);
  CHECK(stein::exr::read_planes(folder / "clean.exr", {"R", "error.G", "density.V", "choice.V"}).planes.size() == 4);
}

TEST_CASE("pathtracer: counts come from a file") {
  const TemporaryFolder folder;
  std::vector<std::uint32_t> counts(24 * 16);
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<std::uint32_t>(i % 5);
  const stein::ConstPlaneView view(counts.data(), stein::ScalarType::kUint32, 24, 16);
  stein::exr::write_planes(folder / "counts.exr", {{"samples.V", view}});
  const Outcome outcome =
      run_pathtracer({"--scene", "spheres", "--counts", folder / "counts.exr", "-o", folder / "batch.exr", "--quiet"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const stein::exr::NamedPlanes planes = stein::exr::read_planes(folder / "batch.exr", {"sampleCount"});
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      REQUIRE(planes.planes[0].row(y)[x] == static_cast<float>(counts[static_cast<std::size_t>(24 * y + x)]));
    }
  }
  const std::vector<float> bad(24 * 16, -1.0F);
  stein::exr::write_planes(folder / "bad.exr", {{"samples.V", stein::ConstPlaneView(bad.data(), 24, 16)}});
  const Outcome refused =
      run_pathtracer({"--scene", "spheres", "--counts", folder / "bad.exr", "-o", folder / "batch2.exr"});
  CHECK(refused.exit_code == 3);
  CHECK(refused.err.find("at pixel (0, 0)") != std::string::npos);
  const Outcome same =
      run_pathtracer({"--scene", "spheres", "--counts", folder / "counts.exr", "-o", folder / "counts.exr"});
  CHECK(same.exit_code == 2);
  CHECK(folder.names() == std::vector<std::string>{"bad.exr", "batch.exr", "counts.exr"});
}

TEST_CASE("pathtracer: if one file cannot be written, the other does not stay") {
  const TemporaryFolder folder;
  const std::vector<std::string> size = {"--scene", "spheres", "--size", "16x12", "--samples", "4", "--quiet"};
  const auto refused = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), size.begin(), size.end());
    const Outcome outcome = run_pathtracer(arguments);
    INFO(outcome.err);
    CHECK(outcome.exit_code == 4);
    CHECK(folder.names().empty());
  };
  refused({"-o", "/dev/full", "--dump", folder / "samples.exr"});
  refused({"-o", "/dev/full", "--adaptive", "--denoised", folder / "clean.exr"});
  refused({"-o", folder / "noisy.exr", "--adaptive", "--denoised", "/dev/full"});
}

TEST_CASE("pathtracer: bad arguments are told before anything is rendered") {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const auto fails = [&](std::vector<std::string> arguments, int code, const char* what) {
    const Outcome outcome = run_pathtracer(arguments);
    INFO(outcome.err);
    CHECK(outcome.exit_code == code);
    CHECK(outcome.err.find(what) != std::string::npos);
  };
  fails({"--scene", "teapot", "-o", out}, 2, "there is no scene 'teapot'; there are: cornell,");
  fails({"--scene", "cornell", "--size", "40", "-o", out}, 2, "--size: '40' is not WIDTHxHEIGHT");
  fails({"--scene", "cornell", "--size", "0x4", "-o", out}, 2, "each side must be 1 to");
  fails({"--scene", "cornell", "--samples", "0", "-o", out}, 2, "--samples");
  fails({"--scene", "cornell"}, 2, "--output is required");
  fails({"--scene", "cornell", "-o", folder / "none/out.exr"}, 4, "there is no folder");
  fails({"--scene", "cornell", "-o", out, "--dump", out}, 2, "same file");
  fails({"--scene", "cornell", "-o", out, "--dump", folder / "d.exr", "--reference"}, 2, "--reference");
  CHECK(folder.names().empty());
}

TEST_CASE("pathtracer: help names the scenes") {
  const Outcome outcome = run_pathtracer({"--help"});
  CHECK(outcome.exit_code == 0);
  for (const char* name : {"cornell", "cornell-defocus", "spheres", "tea-table", "motion", "colonnade"}) {
    CHECK(outcome.out.find(name) != std::string::npos);
  }
}

TEST_CASE("pathtracer: an interrupt leaves nothing behind") {
  const TemporaryFolder folder;
  const std::vector<std::string> dump = {"--dump", folder / "samples.exr"};
  std::vector<std::string> arguments = {"--scene", "spheres",   "--size", "64x200", "--samples",
                                        "1",       "--threads", "1",      "-o",     folder / "noisy.exr"};
  if (GENERATE(false, true)) arguments.insert(arguments.end(), dump.begin(), dump.end());
  HaltedProgram program(arguments);
  REQUIRE(program.wait_for_progress());
  program.send(SIGINT);
  program.drain();
  CHECK(program.outcome().exit_code == 5);
  CHECK(program.outcome().err.find("pathtracer: cancelled\n") != std::string::npos);
  CHECK(folder.names().empty());
}
