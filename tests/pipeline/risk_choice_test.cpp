// SPDX-License-Identifier: Apache-2.0
#include "pipeline/risk_choice.hpp"

#include <cmath>

#include "catch.hpp"
#include "stein/error.hpp"
#include "support/noisy_scene.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

RiskChoice choice(const Frame& frame, Risk risk, const FilterSpec& filter = CrossBilateralParams{}) {
  DenoiseParams params;
  params.risk = risk;
  return choose_risk(frame, filter, params);
}

bool has_warning(const std::vector<std::string>& warnings, const std::string& part) {
  for (const std::string& warning : warnings) {
    if (warning.find(part) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("risk: what the frame has decides, and the report says so") {
  OwnedFrame with(8, 8, kUsualFeatures);
  OwnedFrame without(8, 8, kUsualFeatures, false);

  const RiskChoice joint = choice(with.frame(), Risk::kAuto);
  CHECK(joint.method == Risk::kJoint);
  CHECK(joint.name == "joint SURE");
  CHECK(joint.reason == "the frame has the covariances; noise of few events as such");
  CHECK(choose_risk(with.frame(), AdaptiveOrderParams{}, {}).reason == "the frame has the covariances");
  CHECK(joint.warnings.empty());

  const RiskChoice plain = choice(without.frame(), Risk::kAuto);
  CHECK(plain.method == Risk::kPlain);
  CHECK(plain.reason == "covariances with the colour are missing");
  CHECK(has_warning(plain.warnings, "normal, albedo, depth"));

  const RiskChoice asked = choice(with.frame(), Risk::kPlain);
  CHECK(asked.name == "SURE");
  CHECK(has_warning(asked.warnings, "count as 0"));
  CHECK_FALSE(asked.knows_covariances);

  CHECK(choice(with.frame(), Risk::kMonteCarlo).name == "Monte Carlo joint SURE");
  CHECK(choice(without.frame(), Risk::kMonteCarlo).name == "Monte Carlo SURE");
  CHECK(has_warning(choice(without.frame(), Risk::kMonteCarlo).warnings, "count as 0"));
}

TEST_CASE("risk: the error by Taylor expansion stands in for the risk, and goes with no other") {
  OwnedFrame frame(8, 8, kUsualFeatures);
  DenoiseParams params;
  AdaptiveOrderParams regression;
  params.filters = {regression};
  CHECK(choose_risk(frame.frame(), regression, params).name == "joint SURE");
  regression.error = OrderError::kTaylor;
  CHECK(choose_risk(frame.frame(), regression, params).name == "Taylor expansion");
  const auto refusal = [&]() -> std::string {
    try {
      (void)choose_risk(frame.frame(), regression, params);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::kInvalidArgument);
      return error.what();
    }
    return "";
  };
  params.risk = Risk::kMonteCarlo;
  CHECK(refusal().find("takes the place of the risk") != std::string::npos);
  params.risk = Risk::kAuto;
  params.density.rule = DensityRule::kAllSamples;
  CHECK(refusal().find("the density of all samples") != std::string::npos);
  params.density = {};
  params.filters = {regression, GaussianParams{}};
  CHECK(refusal().find("several filters") != std::string::npos);
}

TEST_CASE("risk: weights that do not depend on the colour need no covariance of its channels") {
  OwnedFrame frame(8, 8, {}, false);
  AdaptiveOrderParams regression;
  CHECK(has_warning(choice(frame.frame(), Risk::kAuto, regression).warnings, "the colour channels"));
  regression.range_sigmas.clear();
  CHECK(choice(frame.frame(), Risk::kAuto, regression).warnings.empty());
  OwnedFrame with_features(8, 8, kUsualFeatures, false);
  CHECK(has_warning(choice(with_features.frame(), Risk::kAuto, regression).warnings, "albedo"));
  regression.orders = {0};
  CHECK(choice(with_features.frame(), Risk::kAuto, regression).warnings.empty());  // a mean reads no features
}

TEST_CASE("risk: a part of the covariances is used, and what is missing is named") {
  OwnedFrame frame(8, 8, kUsualFeatures);
  frame.frame().features[1].colour_covariance.clear();
  const RiskChoice joint = choice(frame.frame(), Risk::kAuto);
  CHECK(joint.method == Risk::kJoint);
  CHECK(has_warning(joint.warnings, "albedo are missing"));
  try {
    (void)choice(frame.frame(), Risk::kJoint);
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::kInvalidFrame);
    CHECK(std::string(error.what()).find("covariances of the colour with albedo") != std::string::npos);
  }
}

TEST_CASE("risk: features that do not guide, or are exact, need no covariances") {
  OwnedFrame without(8, 8, kUsualFeatures, false);
  const RiskChoice gaussian = choice(without.frame(), Risk::kAuto, GaussianParams{});
  CHECK(gaussian.method == Risk::kPlain);
  CHECK(gaussian.reason == "nothing that guides the filter is noisy");
  CHECK(gaussian.warnings.empty());
  for (Feature& feature : without.frame().features) feature.variance.clear();
  CHECK(choice(without.frame(), Risk::kJoint).warnings.empty());
}

TEST_CASE("risk: joint and Monte Carlo agree on the estimated error of a whole run, and plain is too low") {
  NoisyScene scene({.feature_noise = true, .seed = 17});
  double truth = 0;
  std::array<double, 3> estimated{};  // plain, joint, Monte Carlo
  for (int i = 0; i < 40; ++i) {
    scene.draw();
    for (const Risk risk : {Risk::kPlain, Risk::kJoint, Risk::kMonteCarlo}) {
      DenoiseParams params;
      params.filters = {CrossBilateralParams{}};
      params.risk = risk;
      params.monte_carlo.draws = 2;
      params.monte_carlo.seed = static_cast<std::uint64_t>(i);
      params.outliers.enabled = false;
      const DenoiseResult result = denoise(scene.frame(), params);
      estimated[static_cast<std::size_t>(risk) - 1] += result.report.mean_error[0];
      if (risk != Risk::kJoint) continue;
      for (int y = 0; y < scene.height(); ++y) {
        for (int x = 0; x < scene.width(); ++x) {
          const double error = result.colour[0].row(y)[x] - scene.truth(0, x, y);
          truth += error * error / (scene.width() * scene.height());
        }
      }
    }
  }
  CHECK(estimated[0] < 0.5 * truth);
  CHECK(estimated[1] > 0.9 * truth);
  CHECK(estimated[1] < 1.1 * truth);
  CHECK(estimated[2] == Approx(estimated[1]).epsilon(0.15));
}

TEST_CASE("risk: the error of a chosen result allows for what the choice makes of its noise") {
  NoisyScene scene({.feature_noise = true, .seed = 23});
  DenoiseParams params;
  params.filters = {CrossBilateralParams{}};
  params.risk = Risk::kJoint;  // for Gaussian noise
  params.outliers.enabled = false;
  constexpr int kDraws = 1500;
  double truth = 0;
  double estimated = 0;
  for (int i = 0; i < kDraws; ++i) {
    scene.draw();
    const DenoiseResult result = denoise(scene.frame(), params);
    for (std::size_t c = 0; c < 3; ++c) {
      estimated += result.report.mean_error[c] * scene.width() * scene.height();
      for (int y = 0; y < scene.height(); ++y) {
        for (int x = 0; x < scene.width(); ++x) {
          const double error = result.colour[c].row(y)[x] - scene.truth(c, x, y);
          truth += error * error;
        }
      }
    }
  }
  // One area: next to nothing but the divergence counts, which is a little more than the error. 0.995 if nothing is
  // added for the choice.
  CHECK(estimated / truth == Approx(1.025).epsilon(0.015));
}

}  // namespace stein::test
