// SPDX-License-Identifier: Apache-2.0
#include <hwy/targets.h>

#include <cmath>
#include <limits>

#include "catch.hpp"
#include "support/cross_bilateral_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// Largest deviation of a result from the plain reference, relative to the size of the values involved.
double deviation(const CrossBilateralParams& params, const Frame& frame, const BankResult& bank) {
  const Source source(frame, inspect(frame));
  double largest = 0;
  for (std::size_t s = 0; s < params.spatial_sigmas.size(); ++s) {
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const std::array<double, 3> expected =
            cross_bilateral_reference(params, source, params.spatial_sigmas[s], x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          largest =
              std::max(largest, std::abs(bank.result[s][c].row(y)[x] - expected[c]) / (1.0 + std::abs(expected[c])));
        }
      }
    }
  }
  return largest;
}

double deviation(const CrossBilateralParams& params, const Frame& frame) {
  return deviation(params, frame, run_filter(params, frame, {32, 16}));
}

// Largest deviation of D from finite differences at some pixels, relative to the variances in the frame.
double divergence_deviation(const CrossBilateralParams& params, const Frame& frame, Divergence divergence) {
  const BankResult bank = run_filter(params, frame, {32, 16, divergence, {}});
  const Source source(frame, inspect(frame));
  double largest = 0;
  for (int i = 0; i < 40; ++i) {
    const int x = i * 7 % frame.width;
    const int y = i * 5 % frame.height;
    const std::size_t s = static_cast<std::size_t>(i) % params.spatial_sigmas.size();
    const auto expected = divergence_reference(params, source, params.spatial_sigmas[s], x, y, divergence);
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = std::abs(bank.divergence[s][c].row(y)[x] - expected[c]);
      largest = std::max(largest, difference / 0.003);  // fill_random's variances are 0.002 to 0.004
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("cross-bilateral: equals the plain double reference for all sizes from 1 to 40") {
  CrossBilateralParams params;
  params.spatial_sigmas = {1.0F, 2.0F, 3.0F};
  for (int size = 1; size <= 40; ++size) {
    OwnedFrame frame(size, 41 - size, kUsualFeatures);
    fill_random(frame, static_cast<std::uint64_t>(size));
    CHECK(deviation(params, frame.frame()) < 1e-5);
  }
}

TEST_CASE("cross-bilateral: equals the reference for any set of features, with and without the range term") {
  const std::vector<std::vector<FeatureShape>> sets = {{},
                                                       kUsualFeatures,
                                                       {{"depth", 1}},
                                                       {{"normal", 3}, {"position", 3}},
                                                       {{"a", 1}, {"b", 2}, {"c", 3}, {"d", 4}, {"e", 1}}};
  for (const auto& features : sets) {
    OwnedFrame frame(37, 29, features);
    fill_random(frame, 7);
    CrossBilateralParams params;
    params.spatial_sigmas = {1.0F, 3.0F};  // wider ones cost time and test nothing more here
    for (const float range_sigma : {0.0F, 0.4F}) {
      params.range_sigma = range_sigma;
      CHECK(deviation(params, frame.frame()) < 1e-5);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kPlain) < 1e-4);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kJoint) < 1e-4);
    }
  }
}

TEST_CASE("cross-bilateral: invalid pixels have no weight, and unusable features are those of the pixels around") {
  OwnedFrame frame(33, 31, kUsualFeatures);
  fill_random(frame, 3);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.at("R", 5, 5) = nan;
  frame.at("variance.B", 12, 7) = -1.0F;
  frame.at("sampleCount", 20, 20) = 0.0F;
  frame.at("G", 0, 30) = std::numeric_limits<float>::infinity();
  frame.at("albedo.variance.G", 9, 9) = nan;
  frame.at("depth.Z", 25, 4) = -std::numeric_limits<float>::infinity();
  for (int x = 24; x < 28; ++x) {
    for (int y = 20; y < 24; ++y) frame.at("albedo.R", x, y) = nan;  // in its middle the albedo drops out
  }
  CHECK(deviation(CrossBilateralParams{}, frame.frame()) < 1e-5);
  CHECK(divergence_deviation(CrossBilateralParams{}, frame.frame(), Divergence::kJoint) < 1e-4);
}

TEST_CASE("cross-bilateral: high dynamic range keeps its precision") {
  OwnedFrame frame(40, 24, kUsualFeatures);
  fill_random(frame, 11);
  for (int y = 0; y < 24; ++y) {
    for (int x = 20; x < 40; ++x) {
      for (const char* name : {"R", "G", "B"}) frame.at(name, x, y) *= 1e4F;
      for (const char* name : {"normal.X", "normal.Y"}) frame.at(name, x, y) += 3.0F;
    }
    for (int x = 0; x < 20; ++x) {
      for (const char* name : {"R", "G", "B"}) frame.at(name, x, y) *= 1e-4F;
    }
  }
  const BankResult bank = run_filter(CrossBilateralParams{}, frame.frame());
  const Source source(frame.frame(), inspect(frame.frame()));
  for (int y = 0; y < 24; y += 5) {
    for (int x = 0; x < 40; ++x) {
      const std::array<double, 3> expected = cross_bilateral_reference(CrossBilateralParams{}, source, 8.0, x, y);
      // Relative to the dark side's own level: nothing of the bright side may leak in through rounding.
      CHECK(bank.result[6][1].row(y)[x] == Approx(expected[1]).epsilon(1e-4));
    }
  }
}

TEST_CASE("cross-bilateral: the divergence is that of finite differences in colours and features") {
  for (const bool has_covariances : {false, true}) {
    OwnedFrame frame(21, 19, kUsualFeatures, has_covariances);
    fill_random(frame, 5);
    for (const float range_sigma : {0.0F, 0.25F, 0.6F}) {
      CrossBilateralParams params;
      params.range_sigma = range_sigma;
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kPlain) < 1e-4);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kJoint) < 1e-4);
    }
  }
}

TEST_CASE("cross-bilateral: covariances matter, and do not where they are zero") {
  OwnedFrame frame(21, 19, kUsualFeatures);
  fill_random(frame, 6);
  const auto divergences = [&](Divergence divergence) {
    const BankResult bank = run_filter(CrossBilateralParams{}, frame.frame(), {32, 16, divergence, {}});
    return std::pair(bank.divergence[3][0].row(9)[10], bank.divergence[6][2].row(3)[4]);
  };
  const auto plain = divergences(Divergence::kPlain);
  const auto joint = divergences(Divergence::kJoint);
  CHECK(std::abs(plain.first - joint.first) > 1e-6);
  CHECK(std::abs(plain.second - joint.second) > 1e-6);
  for (const std::string& name : frame.names()) {
    if (name.rfind("covariance.", 0) != 0) continue;
    for (int y = 0; y < 19; ++y) std::fill_n(frame.plane(name).row(y), 21, 0.0F);
  }
  CHECK(divergences(Divergence::kJoint) == plain);
}

TEST_CASE("cross-bilateral: a scale gives the same alone and in a bank") {
  OwnedFrame frame(50, 30, kUsualFeatures);
  fill_random(frame, 9);
  const BankResult bank = run_filter(CrossBilateralParams{}, frame.frame());
  CrossBilateralParams alone;
  alone.spatial_sigmas = {4.0F};
  const BankResult single = run_filter(alone, frame.frame());
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 50; ++x) {
      CHECK(single.result[0][0].row(y)[x] == Approx(bank.result[4][0].row(y)[x]).epsilon(2e-6));
    }
  }
}

TEST_CASE("cross-bilateral: all instruction sets of this machine agree") {
  OwnedFrame frame(45, 23, kUsualFeatures);
  fill_random(frame, 13);
  CrossBilateralParams params;
  params.spatial_sigmas = {1.0F, 1.41421356F, 2.0F, 4.0F};
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    const double result = deviation(params, frame.frame());
    const double divergence = divergence_deviation(params, frame.frame(), Divergence::kJoint);
    hwy::SetSupportedTargetsForTest(0);
    INFO(hwy::TargetName(targets & -targets));
    CHECK(result < 1e-5);
    CHECK(divergence < 1e-4);
  }
}

}  // namespace stein::test
