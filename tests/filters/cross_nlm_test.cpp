// SPDX-License-Identifier: Apache-2.0
#include <hwy/targets.h>

#include <cmath>
#include <limits>

#include "catch.hpp"
#include "support/cross_nlm_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr PatchDistance kDistances[] = {PatchDistance::kAbsolute, PatchDistance::kVarianceNormalised};

// A small window, and sigmas that give weights of all sizes on fill_random's images.
CrossNlmParams small_bank(PatchDistance distance, int patch_radius = 2) {
  CrossNlmParams params;
  params.distance = distance;
  params.window_radius = 4;
  params.patch_radius = patch_radius;
  params.range_sigmas = distance == PatchDistance::kAbsolute ? std::vector<float>{0.08F, 0.15F, 0.4F}
                                                             : std::vector<float>{1.5F, 4.0F, 9.0F};
  return params;
}

// Steps of sqrt(2) around those sigmas: most weights are squares of the next candidate's.
CrossNlmParams squares_bank(PatchDistance distance) {
  CrossNlmParams params = small_bank(distance);
  params.range_sigmas.clear();
  const double least = distance == PatchDistance::kAbsolute ? 0.05 : 0.5;
  for (int s = 0; s < 9; ++s) params.range_sigmas.push_back(static_cast<float>(least * std::exp2(0.5 * s)));
  return params;
}

// Largest deviation of a result from the plain reference, relative to the size of the values involved.
double deviation(const CrossNlmParams& params, const Frame& frame, const BankResult& bank, int step = 1) {
  const Source source(frame, inspect(frame));
  const CrossNlmReference reference(params, source);
  double largest = 0;
  int i = 0;
  for (std::size_t s = 0; s < params.range_sigmas.size(); ++s) {
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        if (i++ % step != 0) continue;
        const std::array<double, 3> expected = reference.result(params.range_sigmas[s], x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          largest =
              std::max(largest, std::abs(bank.result[s][c].row(y)[x] - expected[c]) / (1.0 + std::abs(expected[c])));
        }
      }
    }
  }
  return largest;
}

double deviation(const CrossNlmParams& params, const Frame& frame, int step = 1) {
  return deviation(params, frame, run_filter(params, frame, {32, 16}), step);
}

// Largest deviation of D from finite differences at some pixels, relative to the variances in the frame.
double divergence_deviation(const CrossNlmParams& params, const Frame& frame, Divergence divergence) {
  const BankResult bank = run_filter(params, frame, {32, 16, divergence, {}});
  const Source source(frame, inspect(frame));
  const CrossNlmReference reference(params, source);
  double largest = 0;
  for (int i = 0; i < 30; ++i) {
    const int x = i * 7 % frame.width;
    const int y = i * 5 % frame.height;
    const std::size_t s = static_cast<std::size_t>(i) % params.range_sigmas.size();
    const auto expected = reference.divergence(params.range_sigmas[s], x, y, divergence);
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = std::abs(bank.divergence[s][c].row(y)[x] - expected[c]);
      largest = std::max(largest, difference / 0.003);  // fill_random's variances are 0.002 to 0.004
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("cross-nlm: equals the plain double reference for all sizes from 1 to 40") {
  for (int size = 1; size <= 40; ++size) {
    OwnedFrame frame(size, 41 - size, kUsualFeatures);
    fill_random(frame, static_cast<std::uint64_t>(size));
    const CrossNlmParams params = small_bank(kDistances[size % 2]);
    CHECK(deviation(params, frame.frame(), 3) < 1e-5);
  }
}

TEST_CASE("cross-nlm: result and divergence equal the reference for patches and windows of any size") {
  OwnedFrame frame(37, 29, kUsualFeatures);
  fill_random(frame, 8);
  for (const PatchDistance distance : kDistances) {
    for (const auto& [patch_radius, window_radius] :
         {std::pair(0, 4), std::pair(1, 3), std::pair(2, 1), std::pair(2, 7), std::pair(4, 6)}) {
      CAPTURE(static_cast<int>(distance), patch_radius, window_radius);
      CrossNlmParams params = small_bank(distance, patch_radius);
      params.patch_blur = window_radius == 7 ? 0.0F : 0.4F;
      params.window_radius = window_radius;
      CHECK(deviation(params, frame.frame(), 7) < 1e-5);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kPlain) < 1e-4);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kJoint) < 1e-4);
    }
  }
}

TEST_CASE("cross-nlm: equals the reference for any set of features") {
  const std::vector<std::vector<FeatureShape>> sets = {
      {}, {{"depth", 1}}, {{"normal", 3}, {"position", 3}}, {{"a", 1}, {"b", 2}, {"c", 3}, {"d", 4}, {"e", 1}}};
  for (const auto& features : sets) {
    for (const PatchDistance distance : kDistances) {
      CAPTURE(features.size(), static_cast<int>(distance));
      OwnedFrame frame(37, 29, features);
      fill_random(frame, 7);
      const CrossNlmParams params = small_bank(distance);
      CHECK(deviation(params, frame.frame(), 7) < 1e-5);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kPlain) < 1e-4);
      CHECK(divergence_deviation(params, frame.frame(), Divergence::kJoint) < 1e-4);
    }
  }
}

TEST_CASE("cross-nlm: invalid pixels have no weight in window and patches, unusable features are those around") {
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
  for (const PatchDistance distance : kDistances) {
    CHECK(deviation(small_bank(distance), frame.frame()) < 1e-5);
    CHECK(divergence_deviation(small_bank(distance), frame.frame(), Divergence::kJoint) < 1e-4);
    CHECK(deviation(squares_bank(distance), frame.frame()) < 1e-5);
    CHECK(divergence_deviation(squares_bank(distance), frame.frame(), Divergence::kJoint) < 1e-4);
  }
}

TEST_CASE("cross-nlm: high dynamic range keeps its precision") {
  OwnedFrame frame(40, 24, kUsualFeatures);
  fill_random(frame, 11);
  const std::vector<std::string> names = frame.names();
  for (const std::string& name : names) {
    if (name == "sampleCount") continue;
    const bool is_colour = name.size() == 1;
    const bool is_square = name.rfind("variance.", 0) == 0 || name.size() == std::string("covariance.R.G").size();
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 40; ++x) {
        const float unit = x < 20 ? 1e-4F : 1e4F;
        if (is_colour) frame.at(name, x, y) = std::abs(frame.at(name, x, y)) * unit;
        if (is_square) frame.at(name, x, y) *= unit * unit;
      }
    }
  }
  for (const PatchDistance distance : kDistances) {
    CrossNlmParams params = squares_bank(distance);
    if (distance == PatchDistance::kAbsolute) params.range_sigmas = {2e-5F, 1e-4F, 1.0F, 1.41421356F, 2.0F};
    const BankResult bank = run_filter(params, frame.frame(), {32, 16, Divergence::kPlain, {}});
    const Source source(frame.frame(), inspect(frame.frame()));
    const CrossNlmReference reference(params, source);
    for (int y = 0; y < 24; y += 5) {
      for (int x = 0; x < 40; ++x) {
        const std::size_t s = static_cast<std::size_t>(x) % params.range_sigmas.size();
        const double expected = reference.result(params.range_sigmas[s], x, y)[1];
        // Relative to the dark side's own level: nothing of the bright side may leak in through rounding.
        CHECK(bank.result[s][1].row(y)[x] == Approx(expected).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("cross-nlm: the divergence vanishes with the noise, and is the variance where nothing is alike") {
  OwnedFrame frame(24, 20, kUsualFeatures, false);
  fill_random(frame, 5);
  CrossNlmParams params = small_bank(PatchDistance::kAbsolute);
  params.range_sigmas = {1e-3F};
  const BankResult bank = run_filter(params, frame.frame());
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      CHECK(bank.result[0][2].row(y)[x] == frame.at("B", x, y));
      CHECK(bank.divergence[0][2].row(y)[x] == frame.at("variance.B", x, y));
    }
  }
  for (const char* name : {"variance.R", "variance.G", "variance.B"}) {
    for (int y = 0; y < 20; ++y) std::fill_n(frame.plane(name).row(y), 24, 0.0F);
  }
  const BankResult exact = run_filter(small_bank(PatchDistance::kVarianceNormalised), frame.frame());
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      CHECK(exact.result[2][1].row(y)[x] == frame.at("G", x, y));  // exact and different: no noise explains it
      CHECK(exact.divergence[2][1].row(y)[x] == 0.0F);
    }
  }
}

TEST_CASE("cross-nlm: weights that are squares of the next candidate's, in steps of sqrt(2), equal the reference too") {
  OwnedFrame frame(37, 25, kUsualFeatures);
  fill_random(frame, 21);
  CrossNlmParams params = small_bank(PatchDistance::kVarianceNormalised);
  params.range_sigmas.clear();
  for (int s = -5; s <= 6; ++s) params.range_sigmas.push_back(static_cast<float>(std::exp2(0.5 * s)));
  CHECK(deviation(params, frame.frame()) < 1e-5);
  CHECK(divergence_deviation(params, frame.frame(), Divergence::kJoint) < 1e-4);
  // A break in the steps, and a new start.
  params.range_sigmas = {0.25F, 0.5F, 0.70710678F, 1.0F, 1.5F, 3.0F, 4.2426407F, 6.0F};
  CHECK(deviation(params, frame.frame()) < 1e-5);
  CHECK(divergence_deviation(params, frame.frame(), Divergence::kJoint) < 1e-4);
}

TEST_CASE("cross-nlm: a candidate gives the same bits alone and in a bank of other steps") {
  OwnedFrame frame(50, 30, kUsualFeatures);
  fill_random(frame, 9);
  for (const PatchDistance distance : kDistances) {
    const CrossNlmParams params = small_bank(distance);
    const BankResult bank = run_filter(params, frame.frame());
    for (std::size_t s = 0; s < 3; ++s) {
      CrossNlmParams alone = params;
      alone.range_sigmas = {params.range_sigmas[s]};
      const BankResult single = run_filter(alone, frame.frame());
      for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 50; ++x) {
          CHECK(single.result[0][0].row(y)[x] == bank.result[s][0].row(y)[x]);
          CHECK(single.divergence[0][1].row(y)[x] == bank.divergence[s][1].row(y)[x]);
        }
      }
    }
  }
}

TEST_CASE("cross-nlm: all instruction sets of this machine agree") {
  OwnedFrame frame(45, 23, kUsualFeatures);
  fill_random(frame, 13);
  frame.at("R", 30, 11) = std::numeric_limits<float>::quiet_NaN();
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    for (const PatchDistance distance : kDistances) {
      hwy::SetSupportedTargetsForTest(targets & -targets);
      const double result = deviation(small_bank(distance), frame.frame(), 5);
      const double divergence = divergence_deviation(small_bank(distance), frame.frame(), Divergence::kJoint);
      const double squares = deviation(squares_bank(distance), frame.frame(), 5);
      hwy::SetSupportedTargetsForTest(0);
      INFO(hwy::TargetName(targets & -targets));
      CHECK(result < 1e-5);
      CHECK(divergence < 1e-4);
      CHECK(squares < 1e-5);
    }
  }
}

}  // namespace stein::test
