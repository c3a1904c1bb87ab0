// SPDX-License-Identifier: Apache-2.0
//
// What a run says of variances that cannot be true.
#include "pipeline/survey.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/noisy_scene.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kSide = 160;
constexpr double kDeviation = 0.25;

// A smooth image with a step; noise as given by noise(x, y, channel), and kDeviation^2 as its variance.
template <class Noise>
OwnedFrame& fill(OwnedFrame& frame, Noise noise) {
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    Plane& colour = frame.plane(kRgb[c]);
    Plane& variance = frame.plane(std::string("variance.") + kRgb[c]);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double truth = 0.8 + 0.3 * std::sin(0.05 * x) + (y > 70 ? 0.6 : 0.0);
        colour.row(y)[x] = static_cast<float>(truth + noise(x, y, c));
        variance.row(y)[x] = static_cast<float>(kDeviation * kDeviation);
      }
    }
  }
  for (const std::string& name : frame.names()) {
    if (name.find(".variance.") == std::string::npos) continue;
    for (int y = 0; y < kSide; ++y) std::fill_n(frame.plane(name).row(y), kSide, 0.0F);
  }
  return frame;
}

struct WhiteNoise {
  std::array<Plane, 3> planes;
  explicit WhiteNoise(std::uint64_t seed) {
    Random random(seed);
    for (Plane& plane : planes) {
      plane = Plane(kSide + 2, kSide + 2);
      for (int y = 0; y < kSide + 2; ++y) {
        for (int x = 0; x < kSide + 2; ++x) plane.row(y)[x] = static_cast<float>(kDeviation * random.normal());
      }
    }
  }
  [[nodiscard]] double at(int x, int y, std::size_t c) const { return planes[c].row(y + 1)[x + 1]; }
  // Through a pixel filter as wide as three pixels.
  [[nodiscard]] double filtered(int x, int y, std::size_t c) const {
    double sum = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) sum += at(x + dx, y + dy, c) * (dx == 0 ? 2 : 1) * (dy == 0 ? 2 : 1) / 16.0;
    }
    return sum;
  }
};

bool warns_of(const Frame& frame, const std::string& part) {
  for (const std::string& warning : denoise(frame).report.warnings) {
    if (warning.find(part) != std::string::npos) return true;
  }
  return false;
}

constexpr const char* kCorrelated = "noise of neighbouring pixels is correlated";
constexpr const char* kOverstated = "variance given is more than the noise is";

}  // namespace

TEST_CASE("survey: noise as it is said to be raises no doubt") {
  for (const std::uint64_t seed : {1ULL, 2ULL, 3ULL}) {
    const WhiteNoise white(seed);
    OwnedFrame frame(kSide, kSide, kUsualFeatures);
    fill(frame, [&](int x, int y, std::size_t c) { return white.at(x, y, c); });
    CHECK_FALSE(warns_of(frame.frame(), kCorrelated));
    CHECK_FALSE(warns_of(frame.frame(), kOverstated));
  }
}

TEST_CASE("survey: a wide pixel filter is noticed by the correlation of neighbours") {
  const WhiteNoise white(4);
  OwnedFrame frame(kSide, kSide, kUsualFeatures);
  fill(frame, [&](int x, int y, std::size_t c) { return white.filtered(x, y, c); });
  CHECK(warns_of(frame.frame(), kCorrelated));
}

TEST_CASE("survey: a stratified sampler is noticed by noise below the variance of its samples") {
  const WhiteNoise white(5);
  OwnedFrame frame(kSide, kSide, kUsualFeatures);
  fill(frame, [&](int x, int y, std::size_t c) { return white.at(x, y, c) / std::sqrt(1.5); });
  CHECK(warns_of(frame.frame(), kOverstated));
  CHECK_FALSE(warns_of(frame.frame(), kCorrelated));
}

TEST_CASE("survey: noisy features whose covariances are missing are not taken for a wrong variance") {
  NoisyScene scene({.feature_noise = true, .seed = 6});
  scene.draw();
  Frame frame = scene.frame();
  for (Feature& feature : frame.features) feature.colour_covariance.clear();
  CHECK_FALSE(warns_of(frame, kOverstated));
  CHECK_FALSE(warns_of(scene.frame(), kOverstated));
}

TEST_CASE("survey: detail that the filter loses is no doubt either") {
  const WhiteNoise white(7);
  OwnedFrame frame(kSide, kSide, kUsualFeatures);
  fill(frame,
       [&](int x, int y, std::size_t c) { return white.at(x, y, c) + 0.5 * std::sin(0.9 * x) * std::cos(0.7 * y); });
  CHECK_FALSE(warns_of(frame.frame(), kCorrelated));
  CHECK_FALSE(warns_of(frame.frame(), kOverstated));
}

// A sixteenth of the rows is looked at there.
TEST_CASE("survey: of an image of many rows, in any tiles") {
  constexpr int kWidth = 20;
  constexpr int kHeight = 1100;
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill_random(frame, 8);
  DenoiseParams params;
  params.filters = {CrossBilateralParams{}};
  std::vector<DenoiseResult> results;
  for (const int tile_height : {7, 32, 200}) {
    params.execution.tile_height = tile_height;
    params.execution.threads = tile_height % 3;
    results.push_back(denoise(frame.frame(), params));
  }
  for (int y = 0; y < kHeight; ++y) {
    const float* row = results[0].colour[0].row(y);
    CHECK(std::equal(row, row + kWidth, results[1].colour[0].row(y)));
    CHECK(std::equal(row, row + kWidth, results[2].colour[0].row(y)));
  }
}

}  // namespace stein::test
