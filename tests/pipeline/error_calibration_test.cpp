// SPDX-License-Identifier: Apache-2.0
#include "pipeline/error_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "catch.hpp"

namespace stein {
namespace {

// One pixel per predictor and risk.
struct Pixels {
  std::vector<float> predictors;
  std::vector<float> risks;
  std::vector<float> likely;
  void add(float predictor, float risk, float error = 0.0F) {
    predictors.push_back(predictor);
    risks.push_back(risk);
    likely.push_back(error);
  }
  [[nodiscard]] ErrorCalibration fitted(double evidence = 1.0) const {
    ErrorCalibration calibration(1, static_cast<std::int64_t>(risks.size()));
    const std::vector<float> mask(risks.size(), 1.0F);
    calibration.add(0, predictors.data(), risks.data(), likely.data(), mask.data(), static_cast<int>(risks.size()));
    calibration.fit(evidence);
    return calibration;
  }
};

}  // namespace

TEST_CASE("error calibration: finds how the error depends on the predictor under noise a hundred times as large") {
  std::mt19937 engine(3);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> exponent(-4.0F, -1.0F);
  const auto truth = [](float predictor) { return 0.3F * std::sqrt(predictor); };
  Pixels pixels;
  for (int i = 0; i < 1000000; ++i) {
    const float predictor = std::pow(10.0F, exponent(engine));
    pixels.add(predictor, truth(predictor) * (1.0F + 100.0F * normal(engine)), 1.1F * truth(predictor));
  }
  const ErrorCalibration calibration = pixels.fitted();
  double mean = 0;
  double expected = 0;
  for (std::size_t i = 0; i < pixels.risks.size(); ++i) {
    mean += static_cast<double>(calibration.error(pixels.predictors[i]));
    expected += static_cast<double>(pixels.risks[i]);
  }
  CHECK(mean / expected == Approx(1.0).epsilon(0.01));  // but for what lies between the centres of bins
  for (const float predictor : {3e-4F, 1e-3F, 1e-2F, 5e-2F})
    CHECK(calibration.error(predictor) == Approx(truth(predictor)).epsilon(0.3));
}

TEST_CASE("error calibration: ascends, and is not below 0") {
  Pixels pixels;
  const float risks[] = {-3.0F, 1.0F, 2.5F, 2.0F, 1.5F, 6.0F};
  for (int step = 0; step < 6; ++step) {
    for (int i = 0; i < 100; ++i) pixels.add(std::exp2(static_cast<float>(step)), risks[step], risks[step]);
  }
  const ErrorCalibration calibration = pixels.fitted();
  const auto at = [&](int step) { return calibration.error(std::exp2(static_cast<float>(step))); };
  // -3, 1, and what it takes of the 2 that 2.5, 2 and 1.5 are pooled to: 4 / 5.
  CHECK(at(0) == Approx(0.8));
  CHECK(at(4) == Approx(0.8));
  CHECK(at(5) == Approx(6.0));
  CHECK(calibration.error(0.0F) == Approx(0.8));
  CHECK(calibration.error(1e30F) == Approx(6.0));
}

TEST_CASE("error calibration: a pixel counts with its weight") {
  ErrorCalibration calibration(1, 1000);
  for (int i = 0; i < 500; ++i) {
    const float predictors[] = {0.5F, 0.5F};
    const float errors[] = {1.0F, 4.0F};
    const float weights[] = {0.75F, 0.25F};
    calibration.add(0, predictors, errors, errors, weights, 2);
  }
  calibration.fit(1.0);
  CHECK(calibration.error(0.5F) == Approx(1.75));
}

TEST_CASE("error calibration: in the mean it lies between the likely error and the risk as the evidence says") {
  Pixels pixels;
  for (int i = 0; i < 3000; ++i) pixels.add(0.01F, i % 2 == 0 ? -4.0F : 8.0F, i % 2 == 0 ? -1.0F : 2.0F);
  for (int i = 0; i < 1000; ++i) pixels.add(1.0F, 7.0F, 3.0F);
  for (const double evidence : {0.0, 0.25, 1.0}) {
    const ErrorCalibration calibration = pixels.fitted(evidence);
    CHECK(0.75 * calibration.error(0.01F) + 0.25 * calibration.error(1.0F) ==
          Approx(0.75 * (0.5 + evidence * 1.5) + 0.25 * (3.0 + evidence * 4.0)));
  }
}

TEST_CASE("error calibration: where every bin is sure of less than 0, but not the image, each has what is likely") {
  Pixels pixels;
  for (int i = 0; i < 900; ++i) pixels.add(1.0F, -2.0F, 1.0F);
  for (int i = 0; i < 100; ++i) pixels.add(16.0F, -20.0F, 16.0F);
  const ErrorCalibration calibration = pixels.fitted(0.1);  // likely 2.5 in the mean, with a risk of -3.8
  CHECK(0.9 * calibration.error(1.0F) + 0.1 * calibration.error(16.0F) == Approx(2.5 - 0.1 * 6.3));
  CHECK(calibration.error(16.0F) / calibration.error(1.0F) == Approx(16.0));
}

TEST_CASE("error calibration: a few large risks do not speak for a bin, many small ones do") {
  for (const float low : {0x1p-7F, 0x1p-13F, 0x1p-17F}) {
    Pixels pixels;
    for (int i = 0; i < 1000; ++i) pixels.add(low, i == 500 ? 1e4F * low : low, low);  // their mean is 11 times D
    for (int i = 0; i < 1000; ++i) pixels.add(128.0F * low, i % 2 == 0 ? 300.0F * low : 500.0F * low, 100.0F * low);
    const ErrorCalibration calibration = pixels.fitted(1.0);
    CHECK(calibration.error(128.0F * low) / calibration.error(low) == Approx(400.0).epsilon(0.05));
  }
  Pixels one;
  for (int i = 0; i < 1000; ++i) one.add(1e-6F, i == 500 ? 1.0F : 1e-6F, 1e-6F);
  for (int i = 0; i < 1000; ++i) one.add(1.0F, 1.0F, 1.0F);
  CHECK(one.fitted(1.0).error(1e-6F) < 2e-6F);
}

TEST_CASE("error calibration: sums of an image of any size fit, whatever its risks") {
  constexpr int kRow = 1 << 16;
  const std::vector<float> predictors(kRow, 1.0F);
  const std::vector<float> risks(kRow, 1e20F);
  const std::vector<float> mask(kRow, 1.0F);
  ErrorCalibration calibration(2, std::int64_t{kRow} << 10);  // 67 million: 1e4 each do not fit
  for (int y = 0; y < 1 << 10; ++y)
    calibration.add(y % 2, predictors.data(), risks.data(), risks.data(), mask.data(), kRow);
  calibration.fit(1.0);
  CHECK(calibration.error(1.0F) == Approx(4096.0));
}

TEST_CASE("error calibration: few pixels do not stand for themselves") {
  Pixels pixels;
  for (int i = 0; i < 1000; ++i) pixels.add(0.01F, 1.0F);
  for (int i = 0; i < 10; ++i) pixels.add(1.0F, 102.0F);
  CHECK(pixels.fitted().error(1.0F) == Approx(2.0));
}

TEST_CASE("error calibration: nothing but negative risks, or no pixels, give 0") {
  Pixels pixels;
  for (int i = 0; i < 1000; ++i) pixels.add(0.01F * static_cast<float>(i), -1.0F);
  CHECK(pixels.fitted().error(0.5F) == 0.0F);
  CHECK(Pixels().fitted().error(0.5F) == 0.0F);
}

TEST_CASE("error calibration: the order of pixels and the slots make no difference, and masked ones do not count") {
  std::mt19937 engine(4);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<float> normal;
  Pixels pixels;
  for (int i = 0; i < 4096; ++i)
    pixels.add(std::exp(3.0F * normal(engine)), 1.0F + 5.0F * normal(engine), normal(engine));
  const ErrorCalibration one = pixels.fitted(0.5);
  ErrorCalibration parts(3, 4096);
  for (int part = 31; part >= 0; --part) {
    const std::vector<float> mask(128, 1.0F);
    parts.add(part % 3, pixels.predictors.data() + part * 128, pixels.risks.data() + part * 128,
              pixels.likely.data() + part * 128, mask.data(), 128);
  }
  const std::vector<float> none(128, 0.0F);
  parts.add(1, pixels.predictors.data(), pixels.risks.data(), pixels.likely.data(), none.data(), 128);
  parts.fit(0.5);
  for (const float predictor : {0.01F, 0.3F, 1.0F, 8.0F}) CHECK(one.error(predictor) == parts.error(predictor));
}

}  // namespace stein
