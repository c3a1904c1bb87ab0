// SPDX-License-Identifier: Apache-2.0
//
// A grey image is given three times, with its variance as the three covariances (docs/inputs.md). It has to come out as
// if there was but one channel.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 41;
constexpr int kHeight = 27;

std::vector<FilterSpec> banks() {
  CrossNlmParams nlm;  // absolute distances are means over the channels, another thing where two are empty
  nlm.window_radius = 6;
  AdaptiveOrderParams regression;
  regression.window_radius = 5;
  AdaptiveOrderParams taylor = regression;
  taylor.error = OrderError::kTaylor;
  return {nlm, regression, taylor};
}

double truth_at(int x) { return 0.5 + 0.01 * x; }

// One channel in red, a slope under noise; the others are 0, without noise.
void fill_red(OwnedFrame& red) {
  fill_random(red, 17);
  Random random(18);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double deviation = std::sqrt(red.at("variance.R", x, y));
      red.at("R", x, y) = static_cast<float>(truth_at(x) + deviation * random.normal());
    }
  }
  red.at("R", 12, 9) = std::numeric_limits<float>::quiet_NaN();
  for (const std::string& name : red.names()) {
    const bool is_of_others = name == "G" || name == "B" || name == "variance.G" || name == "variance.B" ||
                              name.rfind("covariance.G.", 0) == 0 || name.rfind("covariance.B.", 0) == 0 ||
                              name == "covariance.R.G" || name == "covariance.R.B";
    for (int y = 0; y < kHeight && is_of_others; ++y) std::fill_n(red.plane(name).row(y), kWidth, 0.0F);
  }
}

// All channels are views of the red one.
Frame grey_of(const Frame& red) {
  Frame grey = red;
  grey.colour.fill(red.colour[0]);
  grey.colour_variance.fill(red.colour_variance[0]);
  grey.colour_covariance.fill(red.colour_variance[0]);
  for (Feature& feature : grey.features) {
    std::vector<ConstPlaneView>& covariance = feature.colour_covariance;
    const std::size_t channels = feature.mean.size();
    for (std::size_t k = channels; k < covariance.size(); ++k) covariance[k] = covariance[k - channels];
  }
  return grey;
}

void leave_out_feature_covariances(Frame& frame) {
  for (Feature& feature : frame.features) feature.colour_covariance.clear();
}

// Largest difference of channels; NaN counts as larger than anything.
double difference(const Plane& a, const Plane& b) {
  double largest = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double away = std::abs(static_cast<double>(a.row(y)[x]) - b.row(y)[x]);
      if (!(away <= largest)) largest = away;
    }
  }
  return largest;
}

double difference(const std::array<Plane, 3>& three, const Plane& one) {
  return std::max({difference(three[0], one), difference(three[1], one), difference(three[2], one)});
}

BankResult run(const FilterSpec& spec, const Frame& frame, Divergence divergence) {
  return run_filter(spec, frame, {64, 32, divergence, {}});
}

}  // namespace

TEST_CASE("grey image: regression and non-local means give in three channels what they give in one") {
  OwnedFrame red(kWidth, kHeight, kUsualFeatures);
  fill_red(red);
  for (const bool has_feature_covariances : {true, false}) {
    if (!has_feature_covariances) leave_out_feature_covariances(red.frame());
    const Frame grey = grey_of(red.frame());
    for (const FilterSpec& spec : banks()) {
      CAPTURE(filter_name(spec), has_feature_covariances);
      const BankResult one = run(spec, red.frame(), has_feature_covariances ? Divergence::kJoint : Divergence::kPlain);
      const BankResult three = run(spec, grey, Divergence::kJoint);
      for (std::size_t s = 0; s < three.result.size(); ++s) {
        CHECK(difference(three.result[s], three.result[s][0]) == 0);
        CHECK(difference(three.result[s], one.result[s][0]) < 1e-5);
        CHECK(difference(three.divergence[s], one.divergence[s][0]) < 1e-5);  // of variances of 0.002 to 0.004
      }
    }
  }
}

TEST_CASE("grey image: stays grey and finite, less noisy, and knows the error that is left") {
  OwnedFrame red(kWidth, kHeight, kUsualFeatures);
  fill_red(red);
  for (const FilterSpec& spec : banks()) {
    CAPTURE(filter_name(spec));
    DenoiseParams params;
    params.filters = {spec};
    const DenoiseResult result = denoise(grey_of(red.frame()), params);
    CHECK(difference(result.colour, result.colour[0]) == 0);
    CHECK(difference(result.error, result.error[0]) < 1e-6);
    double error = 0;
    double estimate = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        error += std::pow(result.colour[0].row(y)[x] - truth_at(x), 2) / (kWidth * kHeight);
        estimate += result.error[0].row(y)[x] / (kWidth * kHeight);
      }
    }
    CAPTURE(result.report.filters.front().risk, error, estimate);
    CHECK(error < 0.1 * 0.003);  // of the input's
    CHECK(estimate > 0.4 * error);
    CHECK(estimate < error / 0.4);
  }
}

}  // namespace stein::test
