// SPDX-License-Identifier: Apache-2.0
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "catch.hpp"
#include "support/adaptive_order_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

double relative(double value, double expected) { return std::abs(value - expected) / (1.0 + std::abs(expected)); }

// Largest differences of two banks' results per order.
struct Differences {
  std::array<double, 3> result{};
  std::array<double, 3> divergence{};  // over fill_random's variances, 0.002 to 0.004
  int compared = 0;
};

// Leaves out where rounding decides on the directions.
Differences differences(const AdaptiveOrderParams& params, const Frame& frame, const BankResult& a,
                        const BankResult& b) {
  const Source source(frame, inspect(frame));
  const AdaptiveOrderReference reference(params, source);
  Differences found;
  for (int i = 0; i < frame.width * frame.height; ++i) {
    const int x = i % frame.width;
    const int y = i / frame.width;
    if (reference.is_near_threshold(x, y)) continue;
    ++found.compared;
    for (std::size_t s = 0; s < a.result.size(); ++s) {
      const std::size_t o = s % params.orders.size();
      for (std::size_t c = 0; c < 3; ++c) {
        const double away = relative(a.result[s][c].row(y)[x], b.result[s][c].row(y)[x]);
        found.result[o] = std::max(found.result[o], away);
        const double moved = static_cast<double>(a.divergence[s][c].row(y)[x]) - b.divergence[s][c].row(y)[x];
        found.divergence[o] = std::max(found.divergence[o], std::abs(moved) / 0.003);
      }
    }
  }
  return found;
}

}  // namespace

// The usual set is compared with the reference elsewhere.
TEST_CASE("adaptive-order: all instruction sets of this machine agree, over the whole bank with all covariances") {
  OwnedFrame frame(23, 13, kUsualFeatures);
  fill_random(frame, 13);
  frame.at("R", 17, 8) = std::numeric_limits<float>::quiet_NaN();
  const AdaptiveOrderParams bank;
  const RunOptions joint{32, 16, Divergence::kJoint, {}};
  const BankResult usual = run_filter(bank, frame.frame(), joint);
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    INFO(hwy::TargetName(targets & -targets));
    hwy::SetSupportedTargetsForTest(targets & -targets);
    const BankResult other = run_filter(bank, frame.frame(), joint);
    hwy::SetSupportedTargetsForTest(0);
    const Differences found = differences(bank, frame.frame(), other, usual);
    CHECK(found.compared > 200);
    for (std::size_t o = 0; o < bank.orders.size(); ++o) {
      CAPTURE(bank.orders[o]);
      CHECK(found.result[o] < 2e-5);
      CHECK(found.divergence[o] < 1e-4);
    }
  }
}

}  // namespace stein::test
