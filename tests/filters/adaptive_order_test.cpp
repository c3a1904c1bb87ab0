// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/adaptive_order_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

AdaptiveOrderParams small_bank() {
  AdaptiveOrderParams params;
  params.orders = {0, 1, 3};
  params.error = OrderError::kRisk;
  params.range_sigmas = {1.5F, 4.0F};
  params.spatial_sigma = 0.0F;
  params.window_radius = 4;
  params.patch_radius = 2;
  params.patch_blur = 1.0F;
  params.noise_threshold = 10.0F;
  params.ridge = 3.0F;
  params.curvature_ridge = 7.0F;
  return params;
}

AdaptiveOrderParams spatial_bank() {
  AdaptiveOrderParams params = small_bank();
  params.range_sigmas.clear();
  return params;
}

// Range sigmas of the candidates in their turn.
std::vector<double> sigmas_of(const AdaptiveOrderParams& params) {
  if (params.range_sigmas.empty()) return {AdaptiveOrderReference::kNoColour};
  return {params.range_sigmas.begin(), params.range_sigmas.end()};
}

double relative(double value, double expected) { return std::abs(value - expected) / (1.0 + std::abs(expected)); }

// Largest deviations from the reference per order of small_bank().
struct Deviations {
  std::array<double, 3> result{};
  std::array<double, 3> divergence{};  // over fill_random's variances, 0.002 to 0.004
  int compared = 0;
  int skipped = 0;  // where rounding decides on the directions
};

struct Look {
  Divergence divergence = Divergence::kPlain;
  int step = 1;             // every so many pixels
  int divergence_step = 0;  // 0: results only
};

Deviations deviations(const AdaptiveOrderParams& params, const Frame& frame, const Look& look) {
  const BankResult bank = run_filter(params, frame, {32, 16, look.divergence, {}});
  const Source source(frame, inspect(frame));
  const AdaptiveOrderReference reference(params, source);
  const std::vector<double> sigmas = sigmas_of(params);
  Deviations found;
  for (int i = 0; i < frame.width * frame.height; i += look.step) {
    const int x = i % frame.width;
    const int y = i / frame.width;
    if (reference.is_near_threshold(x, y)) {
      ++found.skipped;
      continue;
    }
    ++found.compared;
    for (std::size_t s = 0; s < sigmas.size() * params.orders.size(); ++s) {
      const std::size_t o = s % params.orders.size();
      const int order = params.orders[o];
      const double sigma = sigmas[s / params.orders.size()];
      const auto expected = reference.result(order, sigma, x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        found.result[o] = std::max(found.result[o], relative(bank.result[s][c].row(y)[x], expected[c]));
      }
      if (look.divergence_step == 0 || i / look.step % look.divergence_step != 0) continue;
      const auto divergence = reference.divergence(order, sigma, x, y, look.divergence);
      for (std::size_t c = 0; c < 3; ++c) {
        const double away = std::abs(bank.divergence[s][c].row(y)[x] - divergence[c]) / 0.003;
        found.divergence[o] = std::max(found.divergence[o], away);
      }
    }
  }
  return found;
}

// Orders 0, 1 and 3 need not agree to the same number of digits.
void check_agreement(const AdaptiveOrderParams& params, const Frame& frame, const Look& look) {
  const Deviations found = deviations(params, frame, look);
  CAPTURE(params.range_sigmas.size(), found.compared, found.skipped);
  CHECK(found.compared > 3 * found.skipped);
  for (std::size_t o = 0; o < params.orders.size(); ++o) {
    CAPTURE(params.orders[o]);
    CHECK(found.result[o] < (params.orders[o] < 3 ? 2e-5 : 1e-4));
    CHECK(found.divergence[o] < (params.orders[o] < 3 ? 1e-4 : 1e-3));
  }
}

}  // namespace

TEST_CASE("adaptive-order: equals the plain double reference for all shapes of image") {
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(1, 23), std::pair(29, 1), std::pair(2, 3), std::pair(17, 13), std::pair(37, 21)}) {
    CAPTURE(width, height);
    OwnedFrame frame(width, height, kUsualFeatures);
    fill_random(frame, static_cast<std::uint64_t>(width));
    AdaptiveOrderParams spatial = spatial_bank();
    spatial.spatial_sigma = 2.0F;
    for (const AdaptiveOrderParams& params : {small_bank(), spatial}) {
      check_agreement(params, frame.frame(), {Divergence::kPlain, width * height > 99 ? 11 : 3, 3});
    }
  }
}

TEST_CASE("adaptive-order: equals the reference for windows, patches and spatial weights of any size") {
  OwnedFrame frame(37, 29, kUsualFeatures);
  fill_random(frame, 8);
  for (const auto& [patch_radius, window_radius, spatial_sigma] :
       {std::tuple(0, 1, 0.0F), std::tuple(1, 3, 1.5F), std::tuple(4, 6, 3.0F), std::tuple(2, 20, 0.0F)}) {
    CAPTURE(patch_radius, window_radius, spatial_sigma);
    AdaptiveOrderParams params = small_bank();
    params.patch_radius = patch_radius;
    params.patch_blur = 0.4F;
    params.window_radius = window_radius;
    params.spatial_sigma = spatial_sigma;
    check_agreement(params, frame.frame(), {Divergence::kPlain, 41, 2});
  }
}

TEST_CASE("adaptive-order: equals the reference with its own parameters") {
  OwnedFrame frame(37, 29, kUsualFeatures);
  fill_random(frame, 21);
  check_agreement(AdaptiveOrderParams{}, frame.frame(), {Divergence::kPlain, 83, 3});
  check_agreement(intermediate_adaptive_order(), frame.frame(), {Divergence::kPlain, 83, 3});
}

// As positions in a scene are that lies far from the origin.
TEST_CASE("adaptive-order: equals the reference for features that vary little next to what they are") {
  OwnedFrame frame(37, 29, {{"position", 3}});
  fill_random(frame, 22);
  for (const char* name : {"position.X", "position.Y", "position.Z"}) {
    for (int y = 0; y < 29; ++y) {
      for (int x = 0; x < 37; ++x) frame.at(name, x, y) += 2000.0F;
    }
  }
  AdaptiveOrderParams params = small_bank();
  params.guides.feature_sigmas = {{"position", 1.0F}};
  check_agreement(params, frame.frame(), {Divergence::kPlain, 7, 5});
}

TEST_CASE("adaptive-order: equals the reference for any set of features") {
  const std::vector<std::vector<FeatureShape>> sets = {
      {}, {{"depth", 1}}, {{"a", 1}, {"b", 2}, {"c", 3}, {"d", 4}, {"e", 2}}};
  for (const auto& features : sets) {
    CAPTURE(features.size());
    OwnedFrame frame(33, 21, features);
    fill_random(frame, 7);
    check_agreement(small_bank(), frame.frame(), {Divergence::kPlain, 17, 5});
  }
}

TEST_CASE("adaptive-order: takes the four strongest of many directions") {
  OwnedFrame frame(25, 17, {{"a", 4}, {"b", 2}});
  fill_random(frame, 15);
  Random random(4);
  float size = 2.0F;
  for (const std::string k : {"b.Y", "a.X", "b.X", "a.W", "a.Y", "a.Z"}) {
    const std::string variance = k.substr(0, 2) + "variance" + k.substr(1);
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 25; ++x) {
        frame.at(k, x, y) = size * static_cast<float>(random.uniform());
        frame.at(variance, x, y) = 1e-5F;
      }
    }
    size *= 0.7F;
  }
  AdaptiveOrderParams params = small_bank();
  params.window_radius = 5;
  params.guides.other_feature_sigma = 1;
  check_agreement(params, frame.frame(), {Divergence::kPlain, 37, 2});
}

TEST_CASE("adaptive-order: a feature that is the position changes nothing, and its noise is none of the fit's") {
  OwnedFrame with(25, 17, {{"visibility", 1}});
  OwnedFrame without(25, 17, {}, false);
  fill_random(with, 16);
  for (const std::string& name : without.names()) {
    for (int y = 0; y < 17; ++y) std::copy_n(with.plane(name).row(y), 25, without.plane(name).row(y));
  }
  for (int y = 0; y < 17; ++y) {
    for (const char* name : {"covariance.R.G", "covariance.R.B", "covariance.G.B"}) {
      std::fill_n(with.plane(name).row(y), 25, 0.0F);
    }
    for (int x = 0; x < 25; ++x) {
      with.at("visibility.V", x, y) = 0.013F * static_cast<float>(x) + 0.007F * static_cast<float>(y);
      with.at("visibility.variance.V", x, y) = 1e-8F;
      for (const char* c : {"R", "G", "B"}) with.at(std::string("covariance.") + c + ".visibility.V", x, y) = 4e-6F;
    }
  }
  AdaptiveOrderParams params = small_bank();
  params.orders = {1};
  params.ridge = 0;
  params.curvature_ridge = params.ridge;
  params.range_sigmas = {9.0F};
  const BankResult expected = run_filter(params, without.frame());
  const BankResult found = run_filter(params, with.frame());
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 25; ++x) {
        CHECK(found.result[0][c].row(y)[x] == Approx(expected.result[0][c].row(y)[x]).margin(1e-5));
        CHECK(found.divergence[0][c].row(y)[x] == Approx(expected.divergence[0][c].row(y)[x]).margin(1e-7));
      }
    }
  }
}

TEST_CASE("adaptive-order: equals the reference where features repeat each other or are constant") {
  OwnedFrame frame(33, 21, {{"depth", 1}, {"again", 1}, {"negative", 1}, {"constant", 2}});
  fill_random(frame, 12);
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 33; ++x) {
      frame.at("again.Z", x, y) = frame.at("depth.Z", x, y);
      frame.at("again.variance.Z", x, y) = frame.at("depth.variance.Z", x, y);
      frame.at("negative.Z", x, y) = 3.0F - 2.0F * frame.at("depth.Z", x, y);
      frame.at("constant.X", x, y) = 0.25F;
      frame.at("constant.Y", x, y) = 0;
      frame.at("constant.variance.Y", x, y) = 0;
    }
  }
  check_agreement(small_bank(), frame.frame(), {Divergence::kPlain, 17, 5});
  AdaptiveOrderParams without_ridge = spatial_bank();
  without_ridge.ridge = 0;
  without_ridge.curvature_ridge = without_ridge.ridge;
  without_ridge.orders = {0, 1};
  check_agreement(without_ridge, frame.frame(), {Divergence::kPlain, 17, 5});
}

TEST_CASE(
    "adaptive-order: invalid pixels have no weight, and a window goes without a feature that nothing is known of") {
  OwnedFrame frame(33, 31, kUsualFeatures);
  fill_random(frame, 3);
  frame.at("R", 5, 5) = kNaN;
  frame.at("variance.B", 12, 7) = -1.0F;
  frame.at("sampleCount", 20, 20) = 0.0F;
  frame.at("G", 0, 30) = std::numeric_limits<float>::infinity();
  for (const auto& [x, y] : {std::pair(8, 8), {9, 8}, {10, 8}, {8, 9}, {9, 9}, {10, 9}, {8, 10}, {9, 10}, {10, 10}}) {
    frame.at("albedo.variance.G", x, y) = kNaN;  // in the middle one the pixels around do not help
  }
  frame.at("normal.Y", 28, 20) = kNaN;  // here they do
  frame.at("depth.Z", 25, 4) = -std::numeric_limits<float>::infinity();
  for (const AdaptiveOrderParams& params : {small_bank(), spatial_bank()}) {
    check_agreement(params, frame.frame(), {Divergence::kPlain, 13, 8});
  }
}

TEST_CASE("adaptive-order: the joint divergence takes in covariances of colours, with any ridge") {
  OwnedFrame frame(29, 23, kUsualFeatures);
  fill_random(frame, 21);
  for (Feature& feature : frame.frame().features) feature.colour_covariance.clear();
  check_agreement(small_bank(), frame.frame(), {Divergence::kJoint, 61, 1});
}

TEST_CASE("adaptive-order: the joint divergence takes in covariances with features") {
  OwnedFrame frame(29, 23, kUsualFeatures);
  fill_random(frame, 22);
  AdaptiveOrderParams params = small_bank();
  params.ridge = 0;
  params.curvature_ridge = params.ridge;
  params.range_sigmas = {9.0F};
  params.window_radius = 6;
  check_agreement(params, frame.frame(), {Divergence::kJoint, 61, 1});
}

}  // namespace stein::test
