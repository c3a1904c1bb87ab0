// SPDX-License-Identifier: Apache-2.0
//
// What a polynomial regression has to do whatever its formulas are.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "filters/exact_feature.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// Sums of powers up to `order` of the position and the feature; of size 1 with differences of that size in a window.
void fill_polynomial(OwnedFrame& frame, int order) {
  const double coefficients[3][3] = {{0.5, -0.3, 0.4}, {-0.2, 0.6, 0.9}, {0.4, 0.5, -0.7}};
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame.frame().height; ++y) {
      for (int x = 0; x < frame.frame().width; ++x) {
        const std::array<double, 3> at = {(x - 8.0) / 4.0, (y - 7.0) / 4.0, frame.at("visibility.V", x, y)};
        double value = 0.7;
        for (int power = 1; power <= order; ++power) {
          for (std::size_t k = 0; k < 3; ++k) value += coefficients[(c + k) % 3][power - 1] * std::pow(at[k], power);
        }
        frame.at(kRgb[c], x, y) = static_cast<float>(value);
      }
    }
  }
}

// Largest distance of a candidate from the frame's colour, relative to 1 or more.
double largest_change(const BankResult& bank, std::size_t candidate, OwnedFrame& frame) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame.frame().height; ++y) {
      for (int x = 0; x < frame.frame().width; ++x) {
        const double colour = frame.at(kRgb[c], x, y);
        largest = std::max(largest, std::abs(bank.result[candidate][c].row(y)[x] - colour) / (1.0 + std::abs(colour)));
      }
    }
  }
  return largest;
}

constexpr std::array<const char*, 3> kNormal = {"X", "Y", "Z"};

float covariance_of(std::size_t channel, std::size_t k) {
  constexpr std::array<float, 3> kCovariance = {4e-5F, -3e-5F, 2e-5F};
  return kCovariance[(channel + k) % 3];
}

// Normals far apart in units of their noise, so that smoothing leaves them as they are and every direction is kept.
// Only they have covariances.
void fill_distinct_normals(OwnedFrame& frame) {
  fill_random(frame, 31);
  Random random(5);
  for (int y = 0; y < frame.frame().height; ++y) {
    for (int x = 0; x < frame.frame().width; ++x) {
      for (std::size_t k = 0; k < 3; ++k) {
        frame.at(std::string("normal.") + kNormal[k], x, y) = static_cast<float>(2.0 * random.uniform() - 1.0);
        frame.at(std::string("normal.variance.") + kNormal[k], x, y) = 1e-6F;
        for (std::size_t c = 0; c < 3; ++c) {
          frame.at(std::string("covariance.") + kRgb[c] + ".normal." + kNormal[k], x, y) = covariance_of(c, k);
        }
      }
      for (const char* name : {"covariance.R.G", "covariance.R.B", "covariance.G.B"}) frame.at(name, x, y) = 0;
    }
  }
}

// [colour channel][normal channel]: how a pixel's result moves with its normal times their covariance, by running the
// filter on frames with another normal.
std::array<std::array<double, 3>, 3> moved_by_normals(const AdaptiveOrderParams& params, OwnedFrame& frame, int x,
                                                      int y) {
  std::array<std::array<double, 3>, 3> moved{};
  for (std::size_t k = 0; k < 3; ++k) {
    float& own = frame.at(std::string("normal.") + kNormal[k], x, y);
    const float centre = own;
    own = centre + 0.02F;
    const double above = own;
    const BankResult up = run_filter(params, frame.frame());
    own = centre - 0.02F;
    const double distance = above - own;
    const BankResult down = run_filter(params, frame.frame());
    own = centre;
    for (std::size_t c = 0; c < 3; ++c) {
      const double change = static_cast<double>(up.result[0][c].row(y)[x]) - down.result[0][c].row(y)[x];
      moved[c][k] = change / distance * covariance_of(c, k);
    }
  }
  return moved;
}

}  // namespace

TEST_CASE("adaptive-order: a polynomial of position and feature is reproduced, by its own order and no lower one") {
  OwnedFrame frame(17, 15, {{"visibility", 1}});
  fill_exact_feature(frame, 5);
  for (const float spatial_sigma : {0.0F, 3.0F}) {
    AdaptiveOrderParams params = plain_fit({0, 1, 3});
    params.spatial_sigma = spatial_sigma;
    for (const int order : {0, 1, 2, 3}) {
      CAPTURE(spatial_sigma, order);
      fill_polynomial(frame, order);
      const BankResult bank = run_filter(params, frame.frame());
      const std::array<double, 3> change = {largest_change(bank, 0, frame), largest_change(bank, 1, frame),
                                            largest_change(bank, 2, frame)};
      CAPTURE(change[0], change[1], change[2]);
      CHECK((change[0] < 1e-5) == (order == 0));
      CHECK((change[1] < 1e-4) == (order <= 1));
      CHECK(change[2] < 1e-4);
      if (order > 0) CHECK(change[0] > 0.1);
      if (order > 1) CHECK(change[1] > 0.1);
    }
  }
}

TEST_CASE("adaptive-order: features without a sigma are not regressed on") {
  OwnedFrame frame(17, 15, {{"visibility", 1}});
  fill_exact_feature(frame, 5);
  fill_polynomial(frame, 1);
  AdaptiveOrderParams params = plain_fit({1});
  params.guides.feature_sigmas = {{"visibility", 0.0F}};
  CHECK(largest_change(run_filter(params, frame.frame()), 0, frame) > 0.1);
  params.guides.feature_sigmas = {{"visibility", 7.0F}};
  CHECK(largest_change(run_filter(params, frame.frame()), 0, frame) < 1e-4);
}

TEST_CASE("adaptive-order: more ridge brings polynomials closer to the mean") {
  OwnedFrame frame(17, 15, {{"visibility", 1}});
  fill_exact_feature(frame, 6);
  fill_polynomial(frame, 1);
  double before = 0;
  for (const float ridge : {0.0F, 10.0F, 100.0F, 1000.0F}) {
    AdaptiveOrderParams params = plain_fit({1});
    params.ridge = ridge;
    params.curvature_ridge = params.ridge;
    const double change = largest_change(run_filter(params, frame.frame()), 0, frame);
    CHECK(change >= before);
    before = change;
  }
  const double mean = largest_change(run_filter(plain_fit({0}), frame.frame()), 0, frame);
  CHECK(before > 0.8 * mean);
  CHECK(before < mean);
}

TEST_CASE(
    "adaptive-order: the ridge of powers 2 and 3 brings order 3 closer to order 1, and is 30 unless the error is "
    "Taylor's") {
  OwnedFrame frame(17, 15, {{"visibility", 1}});
  fill_exact_feature(frame, 6);
  fill_polynomial(frame, 3);
  const auto distance = [&](OrderError error, std::optional<float> curvature_ridge) {
    AdaptiveOrderParams params = plain_fit({1, 3});
    params.error = error;
    params.ridge = 0.5F;
    params.curvature_ridge = curvature_ridge;
    const BankResult bank = run_filter(params, frame.frame());
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < 15; ++y) {
        for (int x = 0; x < 17; ++x) sum += std::abs(bank.result[0][c].row(y)[x] - bank.result[1][c].row(y)[x]);
      }
    }
    return sum;
  };
  const double free = distance(OrderError::kRisk, 0.5F);
  const double usual = distance(OrderError::kRisk, 30.0F);
  CHECK(usual < 0.9 * free);
  CHECK(distance(OrderError::kRisk, 1e6F) < 0.01 * usual);
  CHECK(distance(OrderError::kRisk, {}) == usual);
  CHECK(distance(OrderError::kTaylor, {}) == free);
}

TEST_CASE("adaptive-order: a constant added to the colour is added to the result") {
  OwnedFrame frame(33, 21, kUsualFeatures);
  fill_random(frame, 8);
  AdaptiveOrderParams params = plain_fit({0, 1, 3});
  params.ridge = 3;
  const BankResult before = run_filter(params, frame.frame());
  for (const char* name : kRgb) {
    for (int y = 0; y < 21; ++y) {
      for (int x = 0; x < 33; ++x) frame.at(name, x, y) += 1.0F;
    }
  }
  const BankResult after = run_filter(params, frame.frame());
  for (std::size_t s = 0; s < 3; ++s) {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 33; ++x) {
          const double added = static_cast<double>(after.result[s][c].row(y)[x]) - before.result[s][c].row(y)[x];
          largest = std::max(largest, std::abs(added - 1.0));
        }
      }
    }
    CHECK(largest < 2e-5);
  }
}

TEST_CASE("adaptive-order: the responses to unit impulses sum to 1, and the pixel's own is the divergence") {
  constexpr int kWidth = 12;
  constexpr int kHeight = 9;
  const std::vector<std::pair<int, int>> watched = {{0, 0}, {5, 4}, {11, 3}, {7, 8}};
  OwnedFrame frame(kWidth, kHeight, {{"visibility", 1}});
  fill_exact_feature(frame, 2);
  AdaptiveOrderParams params = plain_fit({0, 1, 3});
  params.ridge = 1;
  std::vector<std::array<double, 3>> sums(watched.size());
  for (int i = 0; i < kWidth * kHeight; i += 3) {  // one impulse in each channel
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < kHeight; ++y) std::fill_n(frame.plane(kRgb[c]).row(y), kWidth, 0.0F);
      const int j = i + static_cast<int>(c);
      frame.at(kRgb[c], j % kWidth, j / kWidth) = 1;
    }
    const BankResult bank = run_filter(params, frame.frame(), {64, 32, Divergence::kPlain, {}});
    for (std::size_t w = 0; w < watched.size(); ++w) {
      const auto [x, y] = watched[w];
      for (std::size_t c = 0; c < 3; ++c) {
        const int j = i + static_cast<int>(c);
        for (std::size_t s = 0; s < 3; ++s) {
          const double response = bank.result[s][c].row(y)[x];
          sums[w][s] += response;
          const bool is_far = std::abs(j % kWidth - x) > 4 || std::abs(j / kWidth - y) > 4;
          if (is_far) CHECK(response == 0.0);
          if (j != y * kWidth + x) continue;
          CHECK(bank.divergence[s][c].row(y)[x] / frame.at("variance.R", x, y) == Approx(response).epsilon(1e-4));
        }
      }
    }
  }
  for (const auto& sum : sums) {
    for (const double total : sum) CHECK(total == Approx(1.0).margin(1e-5));
  }
}

TEST_CASE("adaptive-order: the features' part of the divergence is the derivative of the filter") {
  OwnedFrame frame(15, 13, {{"normal", 3}});
  fill_distinct_normals(frame);
  for (const std::vector<float>& range_sigmas : {std::vector<float>{}, std::vector<float>{9.0F}}) {
    AdaptiveOrderParams params = plain_fit({1});  // without ridge it depends on what the directions span alone
    params.range_sigmas = range_sigmas;
    const BankResult joint = run_filter(params, frame.frame(), {64, 32, Divergence::kJoint, {}});
    const BankResult plain = run_filter(params, frame.frame(), {64, 32, Divergence::kPlain, {}});
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(7, 6), std::pair(14, 5), std::pair(3, 11)}) {
      CAPTURE(range_sigmas.size(), x, y);
      const auto moved = moved_by_normals(params, frame, x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        const double found = static_cast<double>(joint.divergence[0][c].row(y)[x]) - plain.divergence[0][c].row(y)[x];
        const double size = std::abs(moved[c][0]) + std::abs(moved[c][1]) + std::abs(moved[c][2]);
        CHECK(std::abs(found - (moved[c][0] + moved[c][1] + moved[c][2])) < 0.01 * size);
      }
    }
  }
}

}  // namespace stein::test
