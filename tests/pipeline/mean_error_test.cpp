// SPDX-License-Identifier: Apache-2.0
#include "pipeline/mean_error.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "catch.hpp"

namespace stein {
namespace {

// Areas of equal divergence whose risks scatter around the same error.
MeanError scattered(double error, double divergence, double scatter, int areas, std::mt19937& engine) {
  std::normal_distribution<double> normal;
  MeanError sums;
  for (int i = 0; i < areas; ++i) sums.add(error + scatter * normal(engine), divergence, 1.0);
  return sums;
}

}  // namespace

// A signal, its mean over three pixels, and the mixture of both that is best: there D is the error.
TEST_CASE("mean error: the divergence of the best mixture of a filter and its input is its error") {
  constexpr int kPixels = 600;
  constexpr double kVariance = 0.04;
  const auto x = [](int i) { return std::sin(1.1 * i); };
  const auto error = [&](double s) {  // of s box + (1 - s) y: squared bias and variance
    double bias = 0;
    for (int i = 0; i < kPixels; ++i) bias += std::pow(s * ((x(i - 1) + x(i) + x(i + 1)) / 3.0 - x(i)), 2);
    const double own = s / 3.0 + 1.0 - s;
    return bias / kPixels + kVariance * (own * own + 2.0 * s * s / 9.0);
  };
  const auto divergence = [&](double s) { return kVariance * (s / 3.0 + 1.0 - s); };
  double best = 0;
  for (int i = 0; i <= 10000; ++i) best = error(i * 1e-4) < error(best) ? i * 1e-4 : best;
  REQUIRE(best > 0.1);
  REQUIRE(best < 0.9);
  CHECK(divergence(best) == Approx(error(best)).epsilon(1e-3));
  CHECK(divergence(1.0) < 0.5 * error(1.0));  // too much of the filter
  CHECK(divergence(0.5 * best) > error(0.5 * best));
}

TEST_CASE(
    "mean error: nearer to the truth than the better of risk and divergence where both tell as much, else as near") {
  std::mt19937 engine(5);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<double> normal;
  constexpr int kAreas = 64;
  constexpr int kDraws = 4000;
  for (const double noise : {0.04, 0.15, 1.5}) {  // standard error of the risk
    double squares[3] = {};
    double bias = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      const double truth = 1.0 + 0.15 * normal(engine);
      const MeanError sums = scattered(truth, 1.0, noise * std::sqrt(kAreas), kAreas, engine);
      const double estimate = sums.mean();
      const double risk = 1.0 + (estimate - 1.0) / sums.evidence();
      squares[0] += std::pow(estimate - truth, 2);
      squares[1] += std::pow(risk - truth, 2);
      squares[2] += std::pow(1.0 - truth, 2);
      bias += estimate - truth;
    }
    INFO("noise " << noise << ": " << std::sqrt(squares[0] / kDraws) << " risk " << std::sqrt(squares[1] / kDraws)
                  << " divergence " << std::sqrt(squares[2] / kDraws));
    // Noise is taken for certain one time in a few hundred.
    CHECK(squares[0] < (noise == 0.15 ? 0.6 : 1.25) * std::min(squares[1], squares[2]));
    CHECK(std::abs(bias) / kDraws < 0.02);
  }
}

TEST_CASE("mean error: what is certain counts, whatever the divergence") {
  std::mt19937 engine(6);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  constexpr int kAreas = 256;
  // A picture that is far too smooth: no divergence to speak of, and an error that every area shows.
  CHECK(scattered(1.0, 0.001, 0.5, kAreas, engine).mean() == Approx(1.0).epsilon(0.1));
  // One that is nearly all noise removed.
  CHECK(scattered(0.0, 1.0, 0.5, kAreas, engine).mean() < 0.1);
  CHECK(scattered(-1.0, 1.0, 0.5, kAreas, engine).mean() == 0.0);
}

TEST_CASE("mean error: one area alone is no evidence") {
  constexpr int kAreas = 256;
  MeanError sums;
  for (int i = 0; i < kAreas; ++i) sums.add(i == 77 ? kAreas * 9.0 : 1.0, 1.0, 1.0);
  CHECK(sums.mean() < 1.1);  // the mean risk is 10
  CHECK(sums.mean() > 1.0);
}

TEST_CASE("mean error: areas of another size are no noise") {
  MeanError sums;
  for (int i = 0; i < 9; ++i) sums.add(i < 6 ? 20.0 : 2.0, i < 6 ? 10.0 : 1.0, i < 6 ? 10.0 : 1.0);
  CHECK(sums.evidence() == Approx(1.0));
  CHECK(sums.mean() == Approx(2.0));
}

TEST_CASE("mean error: without noise it is the risk, and of nothing it is 0") {
  MeanError sums;
  for (int i = 0; i < 9; ++i) sums.add(2.0, 2.0, 1.0);
  CHECK(sums.mean() == 2.0);
  CHECK(sums.evidence() == 1.0);
  CHECK(MeanError().mean() == 0.0);
  MeanError one;
  one.add(3.0, 1.0, 1.0);
  CHECK(one.mean() == Approx(1.0 + 2.0 * 0.0225 / (0.0225 + 4.0)));
  MeanError flat;
  for (int i = 0; i < 9; ++i) flat.add(0.0, 0.0, 1.0);
  CHECK(flat.mean() == 0.0);
}

}  // namespace stein
