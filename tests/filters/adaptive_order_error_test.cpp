// SPDX-License-Identifier: Apache-2.0
//
// AOS Eq. 11 to 16: the error that is predicted is the variance of the fit and the square of its bias.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "filters/exact_feature.hpp"
#include "support/adaptive_order_reference.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 13;
constexpr int kHeight = 11;
using Place = std::pair<int, int>;

AdaptiveOrderParams taylor(std::vector<int> orders) {
  AdaptiveOrderParams params = plain_fit(std::move(orders));
  params.error = OrderError::kTaylor;
  params.spatial_sigma = 3;
  params.window_radius = 5;
  return params;
}

// Noise differs from pixel to pixel.
float variance_at(int x, int y) { return 0.01F * static_cast<float>(1 + (2 * x + 3 * y) % 5); }

void set_variances(OwnedFrame& frame, bool has_noise) {
  for (const char* c : kRgb) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        frame.at(std::string("variance.") + c, x, y) = has_noise ? variance_at(x, y) : 0.0F;
      }
    }
  }
}

double polynomial(int order, int x, int y, double feature) {
  double value = 0.5;
  for (int power = 1; power <= order; ++power) {
    value += std::pow((x - 6.0) / 4.0, power) / power - std::pow((y - 3.0) / 5.0, power) + std::pow(feature, power);
  }
  return value;
}

double truth_at(OwnedFrame& frame, int order, int x, int y) {
  return polynomial(order, x, y, frame.at("visibility.V", x, y));
}

// A polynomial, and noise of variance_at() if there is a source of it.
void fill_colours(OwnedFrame& frame, int order, Random* noise) {
  for (const char* c : kRgb) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double away = noise != nullptr ? std::sqrt(variance_at(x, y)) * noise->normal() : 0.0;
        frame.at(c, x, y) = static_cast<float>(truth_at(frame, order, x, y) + away);
      }
    }
  }
}

// What the risk of the pipeline is: (F - y)^2 - V + 2 D.
double predicted_error(OwnedFrame& frame, const BankResult& bank, std::size_t candidate, std::size_t c, Place at) {
  const auto [x, y] = at;
  const double change = static_cast<double>(bank.result[candidate][c].row(y)[x]) - frame.at(kRgb[c], x, y);
  return change * change - frame.at(std::string("variance.") + kRgb[c], x, y) +
         2.0 * bank.divergence[candidate][c].row(y)[x];
}

// Expected squares of what noise does to the fit, and to the estimate of its bias.
struct NoiseShares {
  double variance = 0;
  double bias = 0;
};

// From the responses to an impulse in each pixel.
std::vector<NoiseShares> noise_shares(const AdaptiveOrderParams& params, OwnedFrame& frame,
                                      const std::vector<Place>& watched) {
  set_variances(frame, false);
  std::vector<NoiseShares> shares(watched.size());
  for (int j = 0; j < kWidth * kHeight; ++j) {
    for (int y = 0; y < kHeight; ++y) std::fill_n(frame.plane("R").row(y), kWidth, 0.0F);
    frame.at("R", j % kWidth, j / kWidth) = 1;
    const double variance = variance_at(j % kWidth, j / kWidth);
    const BankResult bank = run_filter(params, frame.frame());
    for (std::size_t w = 0; w < watched.size(); ++w) {
      const double kernel = bank.result[0][0].row(watched[w].second)[watched[w].first];
      shares[w].variance += kernel * kernel * variance;
      shares[w].bias += predicted_error(frame, bank, 0, 0, watched[w]) * variance;
    }
  }
  return shares;
}

}  // namespace

TEST_CASE("adaptive-order, Taylor: the variance is that of the fit, over many draws of the noise") {
  const std::vector<Place> watched = {{6, 5}, {0, 0}, {12, 4}};
  OwnedFrame frame(kWidth, kHeight, {{"visibility", 1}});
  fill_exact_feature(frame, 9);
  for (const int order : {0, 1}) {
    const AdaptiveOrderParams params = taylor({order});
    const std::vector<NoiseShares> shares = noise_shares(params, frame, watched);
    set_variances(frame, true);
    std::vector<Statistics> square(watched.size());
    std::vector<Statistics> predicted(watched.size());
    Random random(77);
    for (int draw = 0; draw < 334; ++draw) {
      fill_colours(frame, order, &random);
      const BankResult bank = run_filter(params, frame.frame());
      for (std::size_t w = 0; w < watched.size(); ++w) {
        const auto [x, y] = watched[w];
        for (std::size_t c = 0; c < 3; ++c) {
          const double truth = truth_at(frame, order, x, y);
          const double away = bank.result[0][c].row(y)[x] - truth;
          square[w].add(away * away);
          const double error = predicted_error(frame, bank, 0, c, watched[w]);
          predicted[w].add(error);
          CHECK(error > 0.999 * shares[w].variance);  // the bias comes on top
        }
      }
    }
    for (std::size_t w = 0; w < watched.size(); ++w) {
      CAPTURE(order, watched[w].first, watched[w].second, shares[w].variance, shares[w].bias);
      CAPTURE(square[w].mean(), predicted[w].mean());
      CHECK(square[w].agrees_with(shares[w].variance));
      CHECK(predicted[w].agrees_with(shares[w].variance + shares[w].bias));
    }
  }
}

TEST_CASE("adaptive-order, Taylor: of a polynomial of the fit's own order the error is the variance alone") {
  const std::vector<Place> watched = {{6, 5}, {0, 10}, {12, 4}};
  OwnedFrame frame(kWidth, kHeight, {{"visibility", 1}});
  fill_exact_feature(frame, 9);
  for (const int order : {0, 1, 3}) {
    const AdaptiveOrderParams params = taylor({order});
    const std::vector<NoiseShares> shares = noise_shares(params, frame, watched);
    set_variances(frame, true);
    fill_colours(frame, order, nullptr);
    const BankResult bank = run_filter(params, frame.frame());
    for (std::size_t w = 0; w < watched.size(); ++w) {
      CAPTURE(order, watched[w].first, watched[w].second);
      const double margin = order < 3 ? 1e-3 : 1e-2;
      CHECK(predicted_error(frame, bank, 0, 1, watched[w]) == Approx(shares[w].variance).epsilon(margin));
    }
  }
}

TEST_CASE("adaptive-order, Taylor: without noise the error is the square of the bias") {
  OwnedFrame frame(kWidth, kHeight, {{"visibility", 1}});
  fill_exact_feature(frame, 9);
  set_variances(frame, false);
  for (const auto& [order, truth] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2), std::pair(1, 3)}) {
    fill_colours(frame, truth, nullptr);
    const BankResult bank = run_filter(taylor({order}), frame.frame());
    double largest = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        CAPTURE(order, truth, x, y);
        const double bias = static_cast<double>(bank.result[0][2].row(y)[x]) - frame.at("B", x, y);
        CHECK(predicted_error(frame, bank, 0, 2, {x, y}) == Approx(bias * bias).epsilon(0.02).margin(1e-6));
        largest = std::max(largest, bias * bias);
      }
    }
    CHECK(largest > 1e-2);
  }
}

TEST_CASE("adaptive-order, Taylor: the error equals the plain double reference") {
  OwnedFrame frame(27, 19, kUsualFeatures);
  fill_random(frame, 14);
  frame.at("R", 11, 8) = std::numeric_limits<float>::quiet_NaN();
  AdaptiveOrderParams params = taylor({0, 1, 3});
  params.ridge = 3;
  params.curvature_ridge = params.ridge;
  for (const std::vector<float>& sigmas : {std::vector<float>{}, std::vector<float>{2.0F, 6.0F}}) {
    params.range_sigmas = sigmas;
    const Source source(frame.frame(), inspect(frame.frame()));
    const AdaptiveOrderReference reference(params, source);
    const BankResult bank = run_filter(params, frame.frame());
    std::array<double, 3> worst{};
    for (int i = 0; i < 27 * 19; i += 31) {
      const int x = i % 27;
      const int y = i / 27;
      if (reference.is_near_threshold(x, y) || !is_valid(frame.frame(), x, y)) continue;
      for (std::size_t s = 0; s < bank.result.size(); ++s) {
        const double sigma = sigmas.empty() ? AdaptiveOrderReference::kNoColour : sigmas[s / 3];
        const auto expected = reference.taylor_error(params.orders[s % 3], sigma, x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          const double found = predicted_error(frame, bank, s, c, {x, y});
          worst[s % 3] = std::max(worst[s % 3], std::abs(found - expected[c]) / (expected[c] + 1e-3));
        }
      }
    }
    CAPTURE(sigmas.size(), worst[0], worst[1], worst[2]);
    CHECK(worst[0] < 1e-3);
    CHECK(worst[1] < 1e-3);
    CHECK(worst[2] < 1e-2);
  }
}

}  // namespace stein::test
