// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <numeric>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

// Noise in the right half alone.
Channels half_noisy() {
  Channels image = noisy_image(kWidth, kHeight);
  for (const char* c : {"R", "G", "B"}) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth / 2; ++x) {
        image.at(c, x, y) = 0.5F;
        image.at(std::string("variance.") + c, x, y) = 1e-9F;
      }
    }
  }
  return image;
}

double sum(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

TEST_CASE("sample-map: the budget goes, exactly and within bounds, where the error is") {
  const TemporaryFolder folder;
  write(folder / "pass1.exr", half_noisy());
  const std::string counts = folder / "counts.exr";
  const Outcome result = run_stein({"sample-map", folder / "pass1.exr", "-o", counts, "--budget", "54321",
                                    "--min-samples", "1", "--max-samples", "30"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.out.find("54321 samples") != std::string::npos);
  const std::vector<float> samples = read_channel(counts, "samples.V");
  CHECK(sum(samples) == 54321);
  CHECK(*std::min_element(samples.begin(), samples.end()) >= 1);
  CHECK(*std::max_element(samples.begin(), samples.end()) <= 30);
  double left = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2 - 16; ++x) left += samples[static_cast<std::size_t>(y * kWidth + x)];
  }
  CHECK(left / (kHeight * (kWidth / 2 - 16)) < 2);
  CHECK(folder.names() == std::vector<std::string>{"counts.exr", "pass1.exr"});
}

TEST_CASE("sample-map: what counts follow can be chosen, for a regression too") {
  const TemporaryFolder folder;
  write(folder / "pass1.exr", half_noisy());
  const std::string counts = folder / "counts.exr";
  std::vector<std::vector<float>> all;
  for (const char* density : {"all-samples", "error-reduction", "next-samples"}) {
    const Outcome result = run_stein({"sample-map", folder / "pass1.exr", "-o", counts, "--budget", "20000", "--filter",
                                      "adaptive-order", "--density", density});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    all.push_back(read_channel(counts, "samples.V"));
    CHECK(sum(all.back()) == 20000);
  }
  CHECK(all[0] != all[1]);
  CHECK(all[1] != all[2]);
}

TEST_CASE("sample-map: counts that cannot be used are none") {
  const TemporaryFolder folder;
  Channels image = noisy_image(kWidth, kHeight);
  image.at("sampleCount", 3, 3) = std::numeric_limits<float>::quiet_NaN();
  image.at("sampleCount", 4, 3) = -4;
  write(folder / "pass1.exr", image);
  const Outcome result =
      run_stein({"sample-map", folder / "pass1.exr", "-o", folder / "counts.exr", "--budget", "10000"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.find("2 pixels had no usable colour") != std::string::npos);
  CHECK(sum(read_channel(folder / "counts.exr", "samples.V")) == 10000);
}

TEST_CASE("sample-map: samples that are there count") {
  const TemporaryFolder folder;
  Channels image = noisy_image(kWidth, kHeight);
  const auto top_share = [&](float already) {
    for (int y = 0; y < kHeight / 2; ++y) {
      for (int x = 0; x < kWidth; ++x) image.at("sampleCount", x, y) = already;
    }
    write(folder / "pass1.exr", image);
    const Outcome result =
        run_stein({"sample-map", folder / "pass1.exr", "-o", folder / "counts.exr", "--budget", "50000", "--quiet"});
    REQUIRE(result.exit_code == 0);
    CHECK(result.out.empty());
    const std::vector<float> samples = read_channel(folder / "counts.exr", "samples.V");
    const auto middle = samples.begin() + kWidth * kHeight / 2;
    return std::accumulate(samples.begin(), middle, 0.0) / 50000;
  };
  CHECK(top_share(8) > 0.3);
  // An error e after n samples is worth sqrt(e n) of all samples: ten times those of the bottom, and there are more.
  CHECK(top_share(800) < 0.05);
}
