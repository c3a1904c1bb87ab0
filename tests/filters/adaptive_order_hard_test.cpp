// SPDX-License-Identifier: Apache-2.0
//
// Input that leaves nothing to fit, or that overflows: results stay finite.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Weights with and without the colour, either error, with and without ridge.
std::vector<AdaptiveOrderParams> banks() {
  AdaptiveOrderParams params;
  params.orders = {0, 1, 3};
  params.window_radius = 4;
  params.patch_radius = 2;
  params.spatial_sigma = 0;
  params.noise_threshold = 10;
  std::vector<AdaptiveOrderParams> banks;
  for (const OrderError error : {OrderError::kRisk, OrderError::kTaylor}) {
    for (const float ridge : {0.0F, 3.0F}) {
      params.error = error;
      params.ridge = ridge;
      if (ridge == 0.0F) params.curvature_ridge = ridge;
      params.range_sigmas = {0.7F, 4.0F};
      banks.push_back(params);
      params.range_sigmas.clear();
      banks.push_back(params);
    }
  }
  return banks;
}

int not_finite(const AdaptiveOrderParams& params, const Frame& frame) {
  const BankResult bank = run_filter(params, frame, {32, 16, Divergence::kJoint, {}});
  int count = 0;
  for (std::size_t s = 0; s < bank.result.size(); ++s) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
          if (!std::isfinite(bank.result[s][c].row(y)[x])) ++count;
          if (!std::isfinite(bank.divergence[s][c].row(y)[x])) ++count;
        }
      }
    }
  }
  return count;
}

void check_finite(const Frame& frame) {
  for (const AdaptiveOrderParams& params : banks()) {
    CAPTURE(static_cast<int>(params.error), params.ridge, params.range_sigmas.size());
    CHECK(not_finite(params, frame) == 0);
  }
}

void fill(OwnedFrame& frame, const std::string& name, float value) {
  Plane& plane = frame.plane(name);
  for (int y = 0; y < frame.frame().height; ++y) std::fill_n(plane.row(y), frame.frame().width, value);
}

}  // namespace

TEST_CASE("adaptive-order: outliers of any size leave everything finite") {
  for (const float size : {1e6F, 9.9e14F, 1e30F}) {
    CAPTURE(size);
    OwnedFrame frame(21, 13, kUsualFeatures);
    fill_random(frame, 4);
    for (const char* c : kRgb) frame.at(c, 12, 6) = size;
    frame.at("G", 19, 2) = -size;
    check_finite(frame.frame());
    for (const char* c : kRgb) frame.at(std::string("variance.") + c, 12, 6) = std::min(size * 1e8F, 9e29F);
    check_finite(frame.frame());
    for (const char* k : {"normal.X", "albedo.G", "depth.Z"}) frame.at(k, 18, 6) = size;
    frame.at("depth.variance.Z", 18, 6) = size;
    check_finite(frame.frame());
  }
}

TEST_CASE("adaptive-order: a frame of large values stays finite") {
  OwnedFrame frame(21, 13, kUsualFeatures);
  fill_random(frame, 4);
  for (const char* c : kRgb) {
    for (int y = 0; y < 13; ++y) {
      for (int x = 0; x < 21; ++x) frame.at(c, x, y) *= 5e14F;
    }
    fill(frame, std::string("variance.") + c, 9e29F);
  }
  check_finite(frame.frame());
}

TEST_CASE("adaptive-order: the largest values there may be, and holes that have to be extrapolated, stay finite") {
  OwnedFrame frame(33, 19, kUsualFeatures);
  fill_random(frame, 4);
  Random random(2);
  for (int y = 0; y < 19; ++y) {
    for (int x = 0; x < 33; ++x) {
      for (const char* c : kRgb) frame.at(c, x, y) = random.uniform() < 0.5 ? -9.9e14F : 9.9e14F;
      if (x < 14 && y > 3) frame.at("sampleCount", x, y) = 0;
    }
  }
  check_finite(frame.frame());
  for (const char* c : kRgb) fill(frame, std::string("variance.") + c, 9.9e29F);
  check_finite(frame.frame());
  frame.at("sampleCount", 2, 12) = 8;
  frame.at("sampleCount", 5, 9) = 8;
  check_finite(frame.frame());
}

TEST_CASE("adaptive-order: unusable features leave everything finite") {
  OwnedFrame frame(33, 19, kUsualFeatures);
  fill_random(frame, 4);
  frame.at("normal.X", 3, 3) = kInfinity;
  frame.at("normal.variance.Y", 12, 9) = -1;
  frame.at("albedo.R", 13, 9) = std::numeric_limits<float>::quiet_NaN();
  fill(frame, "depth.Z", kInfinity);
  check_finite(frame.frame());
}

TEST_CASE("adaptive-order: features that repeat each other or are constant, and exact ones, leave everything finite") {
  OwnedFrame frame(33, 19, kUsualFeatures);
  fill_random(frame, 4);
  for (int y = 0; y < 19; ++y) {
    for (int x = 0; x < 33; ++x) {
      for (const char* name : {"normal.X", "normal.Y", "normal.Z"}) frame.at(name, x, y) = frame.at("depth.Z", x, y);
      for (const char* name : {"albedo.R", "albedo.G", "albedo.B"}) frame.at(name, x, y) = x < 16 ? 0.0F : 1.0F;
    }
  }
  for (const char* name : {"albedo.variance.R", "albedo.variance.G", "albedo.variance.B"}) fill(frame, name, 0);
  check_finite(frame.frame());
  fill(frame, "depth.variance.Z", 0);
  fill(frame, "normal.X", 0);
  fill(frame, "normal.variance.X", 0);
  check_finite(frame.frame());
}

TEST_CASE("adaptive-order: few pixels, valid or not, leave everything finite") {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 1), std::pair(1, 3), std::pair(5, 5)}) {
    OwnedFrame frame(width, height, kUsualFeatures);
    fill_random(frame, 4);
    check_finite(frame.frame());
    for (const char* k : {"normal.X", "depth.Z"}) frame.at(k, width - 1, 0) = kInfinity;
    if (width * height > 1) frame.at("sampleCount", 0, 0) = 0;
    check_finite(frame.frame());
  }
}

TEST_CASE("adaptive-order: a single pixel stays as it is") {
  OwnedFrame frame(1, 1, kUsualFeatures);
  fill_random(frame, 4);
  for (AdaptiveOrderParams params : banks()) {
    const BankResult bank = run_filter(params, frame.frame(), {64, 32, Divergence::kPlain, {}});
    for (std::size_t s = 0; s < bank.result.size(); ++s) {
      CHECK(bank.result[s][1].row(0)[0] == frame.at("G", 0, 0));
      CHECK(bank.divergence[s][1].row(0)[0] == Approx(frame.at("variance.G", 0, 0)));
    }
  }
}

TEST_CASE("adaptive-order: an image of one colour stays exactly as it is") {
  OwnedFrame frame(33, 19, kUsualFeatures);
  fill_random(frame, 4);
  for (const bool has_noise : {true, false}) {
    for (const char* c : kRgb) {
      fill(frame, c, 0.3F);
      if (!has_noise) fill(frame, std::string("variance.") + c, 0);
    }
    for (const AdaptiveOrderParams& params : banks()) {
      const BankResult bank = run_filter(params, frame.frame());
      int changed = 0;
      for (const auto& result : bank.result) {
        for (int y = 0; y < 19; ++y) {
          for (int x = 0; x < 33; ++x) changed += result[2].row(y)[x] != 0.3F ? 1 : 0;
        }
      }
      CHECK(changed == 0);
    }
  }
}

TEST_CASE("adaptive-order: an outlier does not reach pixels beyond the window") {
  OwnedFrame frame(33, 19, kUsualFeatures);
  fill_random(frame, 4);
  for (const AdaptiveOrderParams& params : banks()) {
    if (!params.range_sigmas.empty()) continue;
    const BankResult before = run_filter(params, frame.frame());
    const float own = frame.at("R", 16, 9);
    frame.at("R", 16, 9) = 1e12F;
    const BankResult after = run_filter(params, frame.frame());
    frame.at("R", 16, 9) = own;
    for (std::size_t s = 0; s < before.result.size(); ++s) {
      for (int x = 0; x < 33; ++x) {
        const bool is_near = x >= 12 && x <= 20;
        if (!is_near) CHECK(before.result[s][0].row(9)[x] == after.result[s][0].row(9)[x]);
      }
      CHECK(std::abs(after.result[s][0].row(9)[14]) > 1e6F);
    }
  }
}

}  // namespace stein::test
