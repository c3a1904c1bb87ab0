// SPDX-License-Identifier: Apache-2.0
//
// The isotropic Gaussian bank against plain sums, and its divergence against finite differences.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/cross_bilateral_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

GaussianParams bank() {
  GaussianParams params;
  params.spatial_sigmas = {0.7F, 1.5F, 3.0F};
  return params;
}

// Of the valid pixels within two standard deviations, as ScaleTaps has them; `nudge` is added to the pixel's own.
double mean_around(const Frame& frame, std::size_t c, double sigma, int x, int y, double nudge) {
  double weights = 0;
  double sum = 0;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const double square = (u - x) * (u - x) + (v - y) * (v - y);
      if (square > 4.0 * sigma * sigma || !is_valid(frame, u, v)) continue;
      const double weight = std::exp(-square / (2.0 * sigma * sigma));
      weights += weight;
      sum += weight * (frame.colour[c].at(u, v) + (square == 0.0 ? nudge : 0.0));
    }
  }
  return sum / weights;
}

}  // namespace

TEST_CASE("gaussian: equals plain sums, and its divergence the finite difference, whatever the features") {
  OwnedFrame frame(29, 23, kUsualFeatures);
  fill_random(frame, 17);
  frame.at("G", 12, 9) = std::nanf("");
  const GaussianParams params = bank();
  for (const Divergence divergence : {Divergence::kPlain, Divergence::kJoint}) {
    const BankResult found = run_filter(params, frame.frame(), {.divergence = divergence});
    for (std::size_t s = 0; s < params.spatial_sigmas.size(); ++s) {
      const double sigma = params.spatial_sigmas[s];
      for (int y = 0; y < 23; y += 2) {
        for (int x = 0; x < 29; ++x) {
          if (!is_valid(frame.frame(), x, y)) continue;
          for (std::size_t c = 0; c < 3; ++c) {
            const double F = mean_around(frame.frame(), c, sigma, x, y, 0.0);
            CHECK(found.result[s][c].row(y)[x] == Approx(F).epsilon(1e-5).margin(1e-6));
            constexpr double kStep = 1e-3;  // of a linear function: any will do
            const double slope = (mean_around(frame.frame(), c, sigma, x, y, kStep) - F) / kStep;
            const double expected = slope * frame.frame().colour_variance[c].at(x, y);
            CHECK(found.divergence[s][c].row(y)[x] == Approx(expected).epsilon(1e-5));
          }
        }
      }
    }
  }
}

// What a wide candidate blurs into a lamp's surroundings is wrong by orders of magnitude there; with votes clipped as
// those of guided filters the root mean square is twice as much as it may be here.
TEST_CASE("gaussian: little light leaks from a lamp, in the image that is chosen") {
  constexpr int kSize = 96;
  constexpr float kWall = 0.1F;
  constexpr float kLamp = 300.0F;
  std::mt19937 engine(3);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<float> noise;
  OwnedFrame frame(kSize, kSize, {});
  const auto is_lamp = [](int x, int y) { return std::max(std::abs(x - 40), std::abs(y - 50)) <= 4; };
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float mean = is_lamp(x, y) ? kLamp : kWall;
      for (const std::string c : {"R", "G", "B"}) {
        frame.at(c, x, y) = mean * (1.0F + 0.3F * noise(engine));
        frame.at("variance." + c, x, y) = 0.09F * mean * mean;
      }
    }
  }
  DenoiseParams params;
  params.filters = {GaussianParams{}};
  const DenoiseResult result = denoise(frame.frame(), params);
  double square = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (!is_lamp(x, y)) square += std::pow(result.colour[1].row(y)[x] - kWall, 2);
    }
  }
  CHECK(std::sqrt(square / (kSize * kSize - 81)) < 0.004 * kLamp);
}

}  // namespace stein::test
