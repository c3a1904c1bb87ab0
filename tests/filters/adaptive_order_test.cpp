// SPDX-License-Identifier: Apache-2.0
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "filters/smooth_features.hpp"
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
      const Deviations found = deviations(params, frame.frame(), {Divergence::kPlain, 7, 2});
      CAPTURE(params.range_sigmas.size(), found.compared, found.skipped);
      CAPTURE(found.result[0], found.result[1], found.result[2]);
      CAPTURE(found.divergence[0], found.divergence[1], found.divergence[2]);
      CHECK(found.skipped < 10);
      CHECK(found.result[0] < 1e-5);
      CHECK(found.result[1] < 1e-5);
      CHECK(found.result[2] < 1e-5);
      CHECK(found.divergence[0] < 1e-5);
      CHECK(found.divergence[1] < 1e-5);
      CHECK(found.divergence[2] < 1e-5);
    }
  }
}

}  // namespace stein::test
