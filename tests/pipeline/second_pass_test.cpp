// SPDX-License-Identifier: Apache-2.0
//
// DenoiseParams::second_pass.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "stein/error.hpp"
#include "stein/options.hpp"
#include "support/same_bits.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 56;
constexpr int kHeight = 40;

// A slope with a step and much noise. The albedo tells the step apart.
void fill(OwnedFrame& frame) {
  std::mt19937 engine(9);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<float> noise;
  fill_random(frame, 71);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (const std::string c : {"R", "G", "B"}) {
        frame.at(c, x, y) = 2.0F + 0.02F * static_cast<float>(x) + (x < 30 ? 0.0F : 2.0F) + 0.3F * noise(engine);
        frame.at("variance." + c, x, y) = 0.09F;
        frame.at("albedo." + c, x, y) = x < 30 ? 0.2F : 0.8F;
        frame.at("albedo.variance." + c, x, y) = 1e-6F;
      }
      for (const std::string c : {"X", "Y", "Z"}) {
        frame.at("normal." + c, x, y) = c == "Z" ? 1.0F : 0.0F;
        frame.at("normal.variance." + c, x, y) = 1e-6F;
      }
    }
  }
}

DenoiseParams cheap() {
  DenoiseParams params;
  CrossBilateralParams narrow;
  narrow.spatial_sigmas = {1.0F};
  params.filters = {narrow};
  params.second_pass = true;
  return params;
}

DenoiseResult first_pass(const Frame& frame) {
  DenoiseParams params;
  params.filters = filters_of(Quality::kDefault);
  return denoise(frame, params);
}

std::array<Plane, 3> second_pass(const Frame& frame, DenoiseResult first) {
  for (Plane& error : first.error) {
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) error.row(y)[x] *= 1.5F;
    }
  }
  Frame left = frame;
  for (std::size_t c = 0; c < 3; ++c) {
    left.colour[c] = first.colour[c].view();
    left.colour_variance[c] = first.error[c].view();
    left.colour_covariance[c] = {};
  }
  for (Feature& feature : left.features) feature.colour_covariance.clear();
  DenoiseParams params;
  params.filters = {AdaptiveOrderParams{}};
  params.outliers.enabled = false;
  return denoise(left, params).colour;
}

}  // namespace

TEST_CASE("second pass: one more picture, with a weight of its own, the same bits in any order of the work") {
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill(frame);
  DenoiseParams params = cheap();
  const DenoiseResult result = denoise(frame.frame(), params);
  REQUIRE(result.report.filters.size() == 2);
  CHECK(result.report.filters[1].name == "second-pass");
  CHECK(result.report.filters[1].weight > 0.2);
  CHECK(result.report.candidates.back() == "second-pass");
  CHECK(result.report.stages.front().name == "second-pass");
  params.execution.threads = 3;
  params.execution.tile_width = 16;
  params.execution.tile_height = 8;
  const DenoiseResult other = denoise(frame.frame(), params);
  params.second_pass = false;
  const DenoiseResult once = denoise(frame.frame(), params);
  bool same = true;
  bool differs = false;
  for (int y = 0; y < kHeight; ++y) {
    same = same && std::equal(result.colour[1].row(y), result.colour[1].row(y) + kWidth, other.colour[1].row(y));
    same = same && std::equal(result.error[1].row(y), result.error[1].row(y) + kWidth, other.error[1].row(y));
    differs = differs || !std::equal(once.colour[1].row(y), once.colour[1].row(y) + kWidth, other.colour[1].row(y));
  }
  CHECK(same);
  CHECK(differs);
  CHECK(result.report.mean_error == other.report.mean_error);
  CHECK(result.report.mean_relative_error == other.report.mean_relative_error);
}

TEST_CASE("second pass: what is told rises to 1, and ends all parts") {
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill(frame);
  DenoiseParams params = cheap();
  double last = 0;
  int calls = 0;
  params.execution.progress = [&](double done) {
    CHECK(done >= last - 1e-9);
    last = done;
    ++calls;
    return true;
  };
  (void)denoise(frame.frame(), params);
  CHECK(last == Approx(1.0));
  for (const double stop : {0.05, 0.2, 0.35, 0.5, 0.9}) {
    params.execution.progress = [stop](double done) { return done < stop; };
    try {
      (void)denoise(frame.frame(), params);
      FAIL("not cancelled");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::kCancelled);
    }
  }
}

TEST_CASE("second pass: is a part of the best quality, and an option by name") {
  DenoiseParams params;
  CHECK_FALSE(params.second_pass);
  set_option(params, "quality", "best");
  CHECK(params.second_pass);
  set_option(params, "second-pass", 0);
  CHECK_FALSE(params.second_pass);
  set_option(params, "second-pass", 1);
  set_option(params, "quality", "default");
  CHECK_FALSE(params.second_pass);
}

TEST_CASE("second pass: an external denoiser runs on the frame and its perturbed one, and on no pass") {
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill(frame);
  DenoiseParams params = cheap();
  int runs = 0;
  ExternalDenoiser denoiser;
  denoiser.run = [&](const Frame& given) {
    ++runs;
    std::array<Plane, 3> out = Plane::triple(given.width, given.height);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < given.height; ++y) given.colour[c].read_row(y, 0, given.width, out[c].row(y));
    }
    return out;
  };
  params.candidates.push_back({"copy", denoiser});
  const DenoiseResult result = denoise(frame.frame(), params);
  CHECK(runs == 2);
  REQUIRE(result.report.filters.size() == 3);
  CHECK(result.report.filters[1].name == "copy");
  CHECK(result.report.filters[2].name == "second-pass");
}

// By hand, the second pass is another denoiser.
TEST_CASE("second pass: joins as an external denoiser does that runs both passes") {
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill(frame);
  for (int y = 0; y < kHeight; ++y) {  // waves that no feature knows of
    for (int x = 0; x < kWidth; ++x) {
      for (const std::string c : {"R", "G", "B"})
        frame.at(c, x, y) += 1.2F * std::sin(0.2F * static_cast<float>(x)) * std::sin(0.2F * static_cast<float>(y));
    }
  }
  DenoiseParams params;
  params.second_pass = true;
  const DenoiseResult twice = denoise(frame.frame(), params);
  params.second_pass = false;
  params.candidates = {
      {"by hand", ExternalDenoiser{[](const Frame& given) { return second_pass(given, first_pass(given)); }}}};
  const DenoiseResult by_hand = denoise(frame.frame(), params);
  REQUIRE(twice.report.filters.back().weight > 0.05);
  CHECK(twice.report.filters.back().weight == by_hand.report.filters.back().weight);
  CHECK(twice.report.mean_relative_error == by_hand.report.mean_relative_error);
  CHECK(twice.report.mean_error == by_hand.report.mean_error);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(same_bits(twice.colour[c], by_hand.colour[c]));
    CHECK(same_bits(twice.error[c], by_hand.error[c]));
  }
}

TEST_CASE("second pass: its name is not for external candidates") {
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill(frame);
  DenoiseParams params = cheap();
  params.candidates = {
      {"second-pass", ExternalDenoiser{[](const Frame& given) { return Plane::triple(given.width, given.height); }}}};
  try {
    check(params);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::kInvalidArgument);
  }
  params.second_pass = false;
  CHECK_NOTHROW(check(params));
}

TEST_CASE("second pass: strength mixes with the input once") {
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill(frame);
  DenoiseParams params = cheap();
  const DenoiseResult whole = denoise(frame.frame(), params);
  params.strength = 0.25F;
  const DenoiseResult quarter = denoise(frame.frame(), params);
  for (int x = 0; x < kWidth; x += 5) {
    const float expected = 0.25F * whole.colour[0].row(20)[x] + 0.75F * frame.at("R", x, 20);
    CHECK(quarter.colour[0].row(20)[x] == Approx(expected).epsilon(1e-4));
  }
}

}  // namespace stein::test
