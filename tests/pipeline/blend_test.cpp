// SPDX-License-Identifier: Apache-2.0
//
// Several filters, mixed.
#include "pipeline/blend.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "stein/error.hpp"
#include "support/noisy_scene.hpp"

namespace stein::test {
namespace {

CrossBilateralParams narrow() {
  CrossBilateralParams params;
  params.spatial_sigmas = {1.0F, 2.0F};
  return params;
}

AdaptiveOrderParams small() {
  AdaptiveOrderParams params;
  params.window_radius = 4;
  params.orders = {0, 1};
  params.range_sigmas = {1.41F};
  return params;
}

DenoiseResult run(const Frame& frame, const std::vector<FilterSpec>& filters) {
  DenoiseParams params;
  params.filters = filters;
  return denoise(frame, params);
}

double relative_error(const NoisyScene& scene, const DenoiseResult& result) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < scene.height(); ++y) {
      for (int x = 0; x < scene.width(); ++x) {
        const double truth = scene.truth(c, x, y);
        const double error = result.colour[c].row(y)[x] - truth;
        sum += error * error / (truth * truth + 0.01);
      }
    }
  }
  return sum / (3.0 * scene.width() * scene.height());
}

}  // namespace

TEST_CASE("several filters: the mixture is no worse than the best of them") {
  double mixed = 0;
  double bilateral = 0;
  double regression = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    NoisyScene scene({.seed = seed});
    scene.draw();
    mixed += relative_error(scene, run(scene.frame(), {narrow(), small()}));
    bilateral += relative_error(scene, run(scene.frame(), {narrow()}));
    regression += relative_error(scene, run(scene.frame(), {small()}));
  }
  CAPTURE(mixed, bilateral, regression);
  CHECK(mixed < 1.02 * std::min(bilateral, regression));
}

TEST_CASE("several filters: where the input is exact it is left alone") {
  OwnedFrame frame(48, 40, kUsualFeatures);
  fill_random(frame, 5);
  for (const std::string channel : {"R", "G", "B"}) {
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 48; ++x) frame.at("variance." + channel, x, y) = 0.0F;
    }
  }
  const DenoiseResult result = run(frame.frame(), {narrow(), GaussianParams{}});
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 48; ++x) {
        CHECK(result.colour[c].row(y)[x] == Approx(frame.frame().colour[c].at(x, y)).margin(1e-3));
      }
    }
  }
}

TEST_CASE("several filters: report and choice speak of all of them") {
  NoisyScene scene({});
  scene.draw();
  const DenoiseResult result = run(scene.frame(), {narrow(), AtrousParams{}});
  const DenoiseReport& report = result.report;
  CHECK(report.candidates ==
        std::vector<std::string>{"input", "cross-bilateral sigma_s=1", "cross-bilateral sigma_s=2", "atrous levels=5"});
  REQUIRE(report.filters.size() == 2);
  CHECK(report.filters[0].name == "cross-bilateral");
  CHECK(report.filters[0].risk == "joint SURE");
  CHECK(report.filters[1].risk == "Monte Carlo joint SURE");
  CHECK(report.filters[0].weight + report.filters[1].weight <= 1.0 + 1e-5);
  CHECK(report.filters[0].weight + report.filters[1].weight > 0.5);
  CHECK(std::accumulate(report.choice_share.begin(), report.choice_share.end(), 0.0) == Approx(1.0));
  for (int y = 0; y < scene.height(); ++y) {
    for (int x = 0; x < scene.width(); ++x) CHECK(result.choice.row(y)[x] <= 3.0F);
  }
}

TEST_CASE("several filters: none, and too many, are refused") {
  const NoisyScene scene({});
  for (const std::size_t count : {std::size_t{0}, std::size_t{kMaxFilters} + 1}) {
    try {
      (void)run(scene.frame(), std::vector<FilterSpec>(count, narrow()));
      FAIL("not refused");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::kInvalidArgument);
      CHECK(std::string(error.what()).find("number of filters") != std::string::npos);
    }
  }
}

TEST_CASE("several filters: what a choice adds to a picture's risk is mixed, but does not count against the picture") {
  constexpr int kWidth = 40;
  constexpr int kHeight = 24;
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill_random(frame, 9);
  const FrameReport report = inspect(frame.frame());
  const Source source(frame.frame(), report);
  const LayerSource layers(frame.frame(), report, source);
  exec::Runner runner(Execution{});
  const exec::RowRing first(MixtureRows::planes(0), kWidth, kHeight);
  const exec::RowRing second(MixtureRows::planes(0), kWidth, kHeight);
  const std::vector<BlendPicture> pictures = {{MixtureRows(first), false}, {MixtureRows(second), false}};
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) {  // off to either side: half of each is best
        const float mean = frame.frame().colour[static_cast<std::size_t>(c)].at(x, y);
        pictures[0].rows.result(c, y)[x] = mean + 0.2F;
        pictures[1].rows.result(c, y)[x] = mean - 0.2F;
      }
    }
  }
  const auto weights_for = [&](float optimism) {
    for (int y = 0; y < kHeight; ++y) std::fill_n(pictures[0].rows.optimism(y), kWidth, optimism);
    return Blend(source, layers, pictures, runner, 0.0).mean_weights();
  };
  const MixtureWeights without = weights_for(0.0F);
  CHECK(without[1] > 0.3F);
  CHECK(weights_for(0.5F) == without);

  const Blend blend(source, layers, pictures, runner, 0.0);
  const exec::RowRing mixed(MixtureRows::planes(0), kWidth, kHeight);
  Plane choice(kWidth, kHeight);
  std::vector<float> lines(3 * kWidth);
  blend.run({0, 0, kWidth, kHeight}, {MixtureRows(mixed), &choice}, lines.data(), kWidth);
  CHECK(MixtureRows(mixed).optimism(kHeight / 2)[kWidth / 2] == Approx(0.5F * without[1]).epsilon(0.2));
}

}  // namespace stein::test
