// SPDX-License-Identifier: Apache-2.0
//
// How much noise a chain of guided passes leaves.
#include <array>
#include <cmath>

#include "catch.hpp"
#include "select/guided_pass_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// Sum of the squared weights of three box passes with steps 1, 2 and 4: every way to a pixel counts 1/125 along an
// axis.
double squared_weights_of_124() {
  std::array<double, 29> ways{};
  for (int i = 0; i < 125; ++i)
    ways.at(static_cast<std::size_t>(14 + i % 5 - 2 + 2 * (i / 5 % 5 - 2) + 4 * (i / 25 - 2))) += 1.0 / 125.0;
  double along_axis = 0;
  for (const double w : ways) along_axis += w * w;
  return along_axis * along_axis;
}

}  // namespace

TEST_CASE("guided pass: overlap factors are those of the chain's own weights") {
  for (const PassKernel kernel : {PassKernel::kBox, PassKernel::kB3Spline}) {
    const std::vector<float> factors = overlap_factors(kernel, {1, 2, 4});
    CHECK(factors[0] == Approx(1.0));
    CHECK(factors[1] > 1.5F);
    CHECK(factors[2] > 1.5F);
  }
  // Two boxes, 1 and 2 apart, weigh 1 1 2 2 3 2 3 2 2... along an axis: squares by hand.
  const std::vector<double> chain = {1, 1, 2, 2, 3, 2, 3, 2, 3, 2, 2, 1, 1};
  double squares = 0;
  for (const double w : chain) squares += w * w / 625.0;
  CHECK(overlap_factors(PassKernel::kBox, {1, 2})[1] == Approx(std::pow(squares / (0.2 * 0.2), 2)));
}

TEST_CASE("guided pass: inverse counts give the variance of smoothed noise, with and without edges") {
  constexpr int kSide = 96;
  constexpr int kNoises = kMaps * 40;
  const std::vector<int> steps = {1, 2, 4};
  const std::vector<float> overlaps = overlap_factors(PassKernel::kBox, steps);
  for (const bool has_edges : {false, true}) {
    OwnedFrame frame(kSide, kSide, kUsualFeatures);
    for (int y = 0; y < kSide && has_edges; ++y) {  // strips of 9 pixels
      for (int x = 0; x < kSide; ++x) frame.at("albedo.R", x, y) = x / 9 % 2 == 0 ? 0.1F : 0.9F;
    }
    const Setting setting(frame.frame());
    double variance = 0;
    double predicted = 0;
    for (int seed = 0; seed < kNoises / kMaps; ++seed) {
      exec::RowRing rings[4];
      for (exec::RowRing& ring : rings) ring = exec::RowRing(kMaps + 1, kSide, kSide);
      Random random(static_cast<std::uint64_t>(seed) + 1);
      for (int y = 0; y < kSide; ++y) {
        for (int m = 0; m < kMaps; ++m) {
          for (int x = 0; x < kSide; ++x) rings[0].row(m, y)[x] = random.uniform() < 0.5 ? -1.0F : 1.0F;
        }
        std::fill_n(rings[0].row(kMaps, y), kSide, 1.0F);
      }
      for (std::size_t p = 0; p < steps.size(); ++p) {
        const GuidedPass pass{PassKernel::kBox, steps[p], 2.0F, overlaps[p]};
        run_guided_pass(pass, setting.guides, kSide, {0, 0, kSide, kSide}, {&rings[p], kMaps, kMaps},
                        {&rings[p + 1], kMaps, kMaps});
      }
      for (int y = 20; y < kSide - 20; ++y) {
        for (int x = 20; x < kSide - 20; ++x) {
          predicted += rings[3].row(kMaps, y)[x];
          for (int m = 0; m < kMaps; ++m) variance += std::pow(rings[3].row(m, y)[x], 2) / kMaps;
        }
      }
    }
    INFO("variance over prediction: " << variance / predicted);
    if (has_edges) {  // a model: within a factor of 2.5
      CHECK(variance > predicted / 2.5);
      CHECK(variance < predicted * 2.5);
    } else {
      CHECK(variance == Approx(predicted).epsilon(0.2));  // four standard errors of this many draws
      CHECK(predicted / (120.0 / kMaps * 56 * 56) == Approx(squared_weights_of_124()).epsilon(1e-4));
    }
  }
}

}  // namespace stein::test
