// SPDX-License-Identifier: Apache-2.0
//
// The reported error where single samples of many bring light that no other pixel sees.
#include <cmath>
#include <random>
#include <string>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 384;  // so that the risk is evidence enough to be told
constexpr int kHeight = 256;
constexpr int kSamples = 16;
constexpr double kChance = 1.0 / 1600;  // of a sample to be a bright one
constexpr double kBright = 30.0;
constexpr double kBase = 1.0;
constexpr double kBaseDeviation = 0.5;  // of a sample

double truth(int x) { return kBase + 0.0015 * x + kChance * kBright; }

// Mean and variance of the mean of samples, grey.
void draw(std::mt19937& engine, OwnedFrame& frame) {
  std::normal_distribution<double> noise(0.0, kBaseDeviation);
  std::bernoulli_distribution is_bright(kChance);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0;
      double squares = 0;
      for (int s = 0; s < kSamples; ++s) {
        const double sample = kBase + 0.0015 * x + noise(engine) + (is_bright(engine) ? kBright : 0.0);
        sum += sample;
        squares += sample * sample;
      }
      const double mean = sum / kSamples;
      const double variance = (squares / kSamples - mean * mean) / (kSamples - 1);
      for (const std::string c : {"R", "G", "B"}) {
        frame.at(c, x, y) = static_cast<float>(mean);
        frame.at("variance." + c, x, y) = static_cast<float>(variance);
        frame.at("sampleCount", x, y) = kSamples;
      }
    }
  }
}

struct Told {
  Statistics told;
  Statistics error;
  Statistics outliers;
};

Told measure(const DenoiseParams& params, int realisations) {
  std::mt19937 engine(5);                              // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  OwnedFrame frame(kWidth, kHeight, {{"albedo", 3}});  // the same everywhere
  Told all;
  for (int i = 0; i < realisations; ++i) {
    draw(engine, frame);
    const DenoiseResult result = denoise(frame.frame(), params);
    double error = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) error += std::pow(result.colour[1].row(y)[x] - truth(x), 2);
    }
    all.error.add(error / (kWidth * kHeight));
    all.told.add(result.report.mean_error[1]);
    all.outliers.add(static_cast<double>(result.report.outlier_pixels));
  }
  return all;
}

}  // namespace

// A spread of 1 px gives a sixth of what a pixel lost back to itself.
TEST_CASE("outliers: the mean error is known where there are some") {
  DenoiseParams params;
  for (const float sigma : {0.7F, 1.0F}) {
    for (const float spread : {0.0F, 1.0F, 8.0F}) {
      CrossBilateralParams bank;
      bank.spatial_sigmas = {sigma};
      params.filters = {bank};
      params.outliers.spread = spread;
      const Told all = measure(params, sigma < 1.0F ? 8 : 14);  // less filtered has more of an error to tell
      INFO("sigma " << sigma << ", spread " << spread << ": told " << all.told.mean() << " +- "
                    << all.told.standard_error() << ", true " << all.error.mean() << ", outliers "
                    << all.outliers.mean());
      CHECK(all.outliers.mean() > 0.008 * kWidth * kHeight);
      CHECK(all.told.standard_error() < 0.05 * all.error.mean());
      CHECK(std::abs(all.told.mean() - all.error.mean()) < 0.03 * all.error.mean() + 3.0 * all.told.standard_error());
    }
  }
}

}  // namespace stein::test
