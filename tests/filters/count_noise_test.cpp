// SPDX-License-Identifier: Apache-2.0
//
// Noise of pixels of which a few samples see a lamp: by an independent look at what one sample less would give, and
// over many realisations against the true error.
#include <array>
#include <cmath>

#include "catch.hpp"
#include "support/cross_bilateral_reference.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kSamples = 8;
constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
constexpr std::array<double, 3> kLamp = {20.0, 14.0, 6.0};  // what the lamp adds to the wall
constexpr double kWall = 0.1;
constexpr double kWallAlbedo = 0.7;  // a lamp has none

// A pixel that has seen the lamp k times: means, their variances and covariances as a renderer measures them.
void see(OwnedFrame& frame, int x, int y, int k) {
  const double share = static_cast<double>(k) / kSamples;
  const double variance = share * (1.0 - share) / (kSamples - 1);
  for (std::size_t c = 0; c < 3; ++c) {
    frame.at(kRgb[c], x, y) = static_cast<float>(kWall + share * kLamp[c]);
    frame.at(std::string("variance.") + kRgb[c], x, y) = static_cast<float>(variance * kLamp[c] * kLamp[c]);
    frame.at(std::string("albedo.") + kRgb[c], x, y) = static_cast<float>(kWallAlbedo * (1.0 - share));
    frame.at(std::string("albedo.variance.") + kRgb[c], x, y) =
        static_cast<float>(variance * kWallAlbedo * kWallAlbedo);
    for (std::size_t o = 0; o < 3; ++o) {
      if (o > c) {
        frame.at(std::string("covariance.") + kRgb[c] + "." + kRgb[o], x, y) =
            static_cast<float>(variance * kLamp[c] * kLamp[o]);
      }
      frame.at(std::string("covariance.") + kRgb[c] + ".albedo." + kRgb[o], x, y) =
          static_cast<float>(-variance * kLamp[c] * kWallAlbedo);
    }
  }
  frame.at("sampleCount", x, y) = kSamples;
}

CrossBilateralParams bank() {
  CrossBilateralParams params;
  params.spatial_sigmas = {1.0F, 2.0F, 4.0F};
  return params;
}

BankResult run(const Frame& frame, bool counts) {
  return run_filter(bank(), frame, {64, 32, Divergence::kJoint, std::nullopt, counts});
}

// How much of the lamp a pixel sees in truth: its rim is some pixels wide.
double coverage(int x) { return 1.0 / (1.0 + std::exp(0.9 * (x - 6))); }

}  // namespace

TEST_CASE("count noise: the divergence is what one event less makes of the result") {
  for (const int k : {1, 2, 3}) {
    constexpr int kX = 11;
    constexpr int kY = 10;
    OwnedFrame frame(23, 21, {{"albedo", 3}});
    OwnedFrame less(23, 21, {{"albedo", 3}});
    for (OwnedFrame* each : {&frame, &less}) {
      for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 23; ++x) see(*each, x, y, (x * 5 + y * 3) % 7 == 0 ? 1 : 0);
      }
      see(*each, kX, kY, k);
    }
    const BankResult bank_result = run(frame.frame(), true);

    double brightness = 0;
    double variance = 0;
    std::array<double, 3> with_brightness{};
    double lamp = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      brightness += frame.at(kRgb[c], kX, kY) / 3.0;
      lamp += kLamp[c] / 3.0;
    }
    const double share = static_cast<double>(k) / kSamples;
    const double unit = share * (1.0 - share) / (kSamples - 1);
    variance = unit * lamp * lamp;
    for (std::size_t c = 0; c < 3; ++c) with_brightness[c] = unit * lamp * kLamp[c];
    const double events = std::max(1.0, brightness * brightness / variance);
    const double event = brightness / events;  // what one adds to the brightness

    for (std::size_t c = 0; c < 3; ++c) {
      less.at(kRgb[c], kX, kY) -= static_cast<float>(event * with_brightness[c] / variance);
      less.at(std::string("albedo.") + kRgb[c], kX, kY) += static_cast<float>(event * kWallAlbedo / lamp);
      less.at(std::string("albedo.variance.") + kRgb[c], kX, kY) *= static_cast<float>(1.0 - 1.0 / events);
    }
    const Source now(frame.frame(), inspect(frame.frame()));
    const Source then(less.frame(), inspect(less.frame()));
    for (std::size_t s = 0; s < 3; ++s) {
      const auto F = cross_bilateral_reference(bank(), now, bank().spatial_sigmas[s], kX, kY);
      const auto F_less = cross_bilateral_reference(bank(), then, bank().spatial_sigmas[s], kX, kY);
      for (std::size_t c = 0; c < 3; ++c) {
        INFO(k << " of " << kSamples << ", scale " << s << ", channel " << c);
        const double expected = with_brightness[c] / event * (F[c] - F_less[c]);
        CHECK(bank_result.divergence[s][c].row(kY)[kX] == Approx(expected).epsilon(2e-4).margin(1e-5));
      }
    }
  }
}

TEST_CASE("count noise: the mean risk at a lamp's rim is the mean error, where the derivative's is too high") {
  constexpr int kWidth = 16;
  constexpr int kHeight = 16;
  constexpr int kRealisations = 600;
  OwnedFrame frame(kWidth, kHeight, {{"albedo", 3}});
  Random random(7);
  // A binomial count is taken for a Poisson one, which leaves a tenth.
  std::array<Statistics, 3> by_slope;
  std::array<Statistics, 3> by_count;
  std::array<Statistics, 3> truth;
  for (int i = 0; i < kRealisations; ++i) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        int k = 0;
        for (int sample = 0; sample < kSamples; ++sample) k += random.uniform() < coverage(x) ? 1 : 0;
        see(frame, x, y, k);
      }
    }
    const BankResult slope = run(frame.frame(), false);
    const BankResult count = run(frame.frame(), true);
    for (std::size_t s = 0; s < 3; ++s) {
      std::array<double, 3> sum{};
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const double right = kWall + coverage(x) * kLamp[0];
          const double weight = 1.0 / (right * right + 0.01);
          const double F = slope.result[s][0].row(y)[x];
          const double away = F - frame.frame().colour[0].at(x, y);
          const double base = away * away - frame.frame().colour_variance[0].at(x, y);
          sum[0] += weight * (base + 2.0 * slope.divergence[s][0].row(y)[x]);
          sum[1] += weight * (base + 2.0 * count.divergence[s][0].row(y)[x]);
          sum[2] += weight * (F - right) * (F - right);
        }
      }
      by_slope[s].add(sum[0]);
      by_count[s].add(sum[1]);
      truth[s].add(sum[2]);
    }
  }
  for (std::size_t s = 0; s < 3; ++s) {
    INFO("scale " << s << ": true " << truth[s].mean() << ", by the slope " << by_slope[s].mean() << " +- "
                  << by_slope[s].standard_error() << ", by the count " << by_count[s].mean() << " +- "
                  << by_count[s].standard_error());
    const double error = truth[s].mean();
    CHECK(std::abs(by_count[s].mean() - error) < 0.12 * error + 4.0 * by_count[s].standard_error());
    CHECK(by_slope[s].mean() > 2.0 * error);
  }
}

}  // namespace stein::test
