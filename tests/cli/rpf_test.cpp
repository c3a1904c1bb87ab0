// SPDX-License-Identifier: Apache-2.0
//
// Random parameter filtering of raw samples by the program.
#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "stein/exr.hpp"
#include "stein/exr_samples.hpp"

namespace {

constexpr int kWidth = 14;
constexpr int kHeight = 11;

/// Noise of random.light over an albedo with an edge in the middle.
void write_samples(const std::string& path, unsigned seed, float broken = 1) {
  stein::exr::SampleWriter writer(
      path, kWidth, kHeight,
      {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "random.light.X", "random.pixel.X", "random.pixel.Y"},
      {{3, 5}, true});
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<float>(random() % 10'000) / 10'000.0F; };
  for (int y = 0; y < kHeight; ++y) {
    const std::vector<std::uint32_t> counts(kWidth, 4);
    std::vector<float> samples;
    for (int x = 0; x < kWidth; ++x) {
      for (int i = 0; i < 4; ++i) {
        const float albedo = x < kWidth / 2 ? 0.25F : 0.75F;
        const float light = uniform();
        const float colour = 2 * light * albedo * (x == 2 && y == 2 && i == 0 ? broken : 1);
        const float px = uniform();
        samples.insert(samples.end(), {colour, colour, colour, albedo, albedo, albedo, light, px, uniform()});
      }
    }
    writer.write_row(counts.data(), samples.data());
  }
  writer.finish();
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("samples are denoised to planes, with the error if it is asked for") {
  const TemporaryFolder folder;
  write_samples(folder / "samples.exr", 1, std::numeric_limits<float>::quiet_NaN());
  const Outcome plain = run_stein({"denoise", folder / "samples.exr", "-o", folder / "a.exr", "--filter", "rpf"});
  INFO(plain.err);
  REQUIRE(plain.exit_code == 0);
  CHECK(contains(plain.out, "random    random.light"));
  CHECK(contains(plain.err, "1 samples rejected"));
  const auto planes = stein::exr::read_planes(folder / "a.exr");
  CHECK(planes.data_window == std::array<int, 4>{3, 5, 3 + kWidth - 1, 5 + kHeight - 1});
  CHECK(planes.planes[0].row(5)[1] == Approx(0.25).margin(0.1));
  CHECK(planes.planes[0].row(5)[12] == Approx(0.75).margin(0.25));

  const Outcome error = run_stein({"denoise", folder / "samples.exr", "-o", folder / "b.exr", "--filter", "rpf",
                                   "--risk", "monte-carlo", "--draws", "1", "--threads", "2", "--quiet"});
  REQUIRE(error.exit_code == 0);
  CHECK(error.out.empty());
  const auto with_error = stein::exr::read_planes(folder / "b.exr", {"R", "error.G"});
  CHECK(with_error.planes[0].row(3)[3] == planes.planes[0].row(3)[3]);
  CHECK(with_error.planes[1].row(5)[5] < 0.02F);
}

TEST_CASE("frames beside it, presets and names reach the filter") {
  const TemporaryFolder folder;
  for (const unsigned frame : {1U, 2U}) write_samples(folder / std::to_string(frame), frame);
  const auto pixel = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"denoise", folder / "1", "-o", folder / "out.exr", "--filter", "rpf"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_stein(arguments);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return stein::exr::read_planes(folder / "out.exr").planes[0].row(4)[4];
  };
  const float usual = pixel({});
  CHECK(pixel({}) == usual);
  CHECK(pixel({"--adjacent", folder / "2"}) != usual);
  CHECK(pixel({"--rpf-preset", "paper-detail"}) != usual);
  CHECK(pixel({"--features", "albedo", "--randoms", "random.light"}) == usual);
  CHECK(pixel({"--seed", "2"}) != usual);
}

TEST_CASE("what does not fit the filter of samples is refused, and no file is left") {
  const TemporaryFolder folder;
  write_samples(folder / "samples.exr", 1);
  const auto refusal = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"denoise", folder / "samples.exr", "-o", folder / "out.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_stein(arguments);
    CHECK(outcome.exit_code != 0);
    return outcome.err;
  };
  CHECK(contains(refusal({"--filter", "rpf", "--bank", "final"}), "--bank: the filter 'rpf' has no such parameter"));
  CHECK(contains(refusal({"--filter", "rpf", "--half"}), "--half: the filter 'rpf'"));
  CHECK(contains(refusal({"--filter", "rpf", "--risk", "joint"}), "monte-carlo"));
  CHECK(contains(refusal({"--filter", "rpf", "--features", "normal"}), "they have: albedo"));
  CHECK(contains(refusal({"--adjacent", "x.exr"}), "--adjacent: only the filter 'rpf'"));
  CHECK(contains(refusal({}), "accumulate raw samples"));
  CHECK(folder.names() == std::vector<std::string>{"samples.exr"});

  REQUIRE(run_stein({"accumulate", folder / "samples.exr", "-o", folder / "flat.exr", "--quiet"}).exit_code == 0);
  const Outcome flat = run_stein({"denoise", folder / "flat.exr", "-o", folder / "out.exr", "--filter", "rpf"});
  CHECK(flat.exit_code != 0);
  CHECK(contains(flat.err, "--filter rpf reads raw samples"));
}
