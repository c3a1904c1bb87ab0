// SPDX-License-Identifier: Apache-2.0
//
// What external denoisers are handed: the frame's noise, as a step of known size.
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "catch.hpp"
#include "stein/candidate.hpp"
#include "stein/error.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kDraws = 400;

struct Moments {
  double sum = 0;
  double squares = 0;
  [[nodiscard]] double mean() const { return sum / kDraws; }
  [[nodiscard]] double standard_error() const { return std::sqrt((squares / kDraws - mean() * mean()) / kDraws); }
  void add(double value) {
    sum += value;
    squares += value * value;
  }
};

}  // namespace

TEST_CASE("perturbed frame: over many draws the steps have the covariances of colour and features") {
  OwnedFrame owned(3, 2, kUsualFeatures);
  fill_random(owned, 4);
  const Frame& frame = owned.frame();
  constexpr float kStep = 0.5F;
  const auto step = [&](const ConstPlaneView& moved, const ConstPlaneView& old) {
    return (static_cast<double>(moved.at(1, 1)) - old.at(1, 1)) / kStep;
  };
  Moments variance;
  Moments colours;
  Moments feature;
  for (int draw = 0; draw < kDraws; ++draw) {
    const PerturbedFrame moved(frame, {9, draw, kStep});
    const double green = step(moved.frame().colour[1], frame.colour[1]);
    variance.add(green * green);
    colours.add(green * step(moved.frame().colour[2], frame.colour[2]));
    feature.add(green * step(moved.frame().features[1].mean[0], frame.features[1].mean[0]));
  }
  const auto check_mean = [](const Moments& found, double expected) {
    CHECK(std::abs(found.mean() - expected) <= 4.0 * found.standard_error() + 1e-5 * std::abs(expected));
  };
  check_mean(variance, owned.at("variance.G", 1, 1));
  check_mean(colours, owned.at("covariance.G.B", 1, 1));
  check_mean(feature, owned.at("covariance.G.albedo.R", 1, 1));
  CHECK(std::abs(feature.mean()) > 0.0);
}

TEST_CASE("perturbed frame: the same for the same seed and draw, whatever the threads, and another for others") {
  OwnedFrame owned(70, 41, kUsualFeatures);
  fill_random(owned, 6);
  Execution execution;
  execution.threads = 1;
  const PerturbedFrame one(owned.frame(), {5, 2, 0.1F}, execution);
  execution.threads = 3;
  const PerturbedFrame three(owned.frame(), {5, 2, 0.1F}, execution);
  const PerturbedFrame other_draw(owned.frame(), {5, 3, 0.1F});
  const PerturbedFrame other_seed(owned.frame(), {6, 2, 0.1F});
  int different_draw = 0;
  int different_seed = 0;
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 70; ++x) {
      const float value = one.frame().colour[0].at(x, y);
      CHECK(value == three.frame().colour[0].at(x, y));
      CHECK(one.frame().features[0].mean[2].at(x, y) == three.frame().features[0].mean[2].at(x, y));
      different_draw += value != other_draw.frame().colour[0].at(x, y) ? 1 : 0;
      different_seed += value != other_seed.frame().colour[0].at(x, y) ? 1 : 0;
    }
  }
  CHECK(different_draw > 70 * 41 / 4);
  CHECK(different_seed > 70 * 41 / 4);
}

TEST_CASE("perturbed frame: unusable values, features without covariances and all else stay as they are") {
  OwnedFrame owned(12, 8, kUsualFeatures);
  fill_random(owned, 8);
  owned.at("G", 7, 3) = std::numeric_limits<float>::quiet_NaN();
  owned.at("albedo.G", 2, 5) = std::numeric_limits<float>::infinity();
  owned.frame().features[2].colour_covariance.clear();  // depth
  const Frame& frame = owned.frame();
  const PerturbedFrame moved(frame, {1, 0, 1.0F});
  CHECK(std::isnan(moved.frame().colour[1].at(7, 3)));
  CHECK(moved.frame().colour[0].at(7, 3) == frame.colour[0].at(7, 3));
  CHECK(moved.frame().features[1].mean[1].at(2, 5) == frame.features[1].mean[1].at(2, 5));
  CHECK(moved.frame().features[1].mean[0].at(2, 5) == frame.features[1].mean[0].at(2, 5));
  CHECK(moved.frame().features[1].mean[0].at(3, 5) != frame.features[1].mean[0].at(3, 5));
  CHECK(moved.frame().features[2].mean[0].data() == frame.features[2].mean[0].data());
  CHECK(moved.frame().colour_variance[0].data() == frame.colour_variance[0].data());
  CHECK(moved.frame().width == frame.width);
}

TEST_CASE("perturbed frame: steps and draws out of range are refused") {
  const OwnedFrame owned(4, 4, {});
  for (const Perturbation& wrong : {Perturbation{1, -1, 0.1F}, Perturbation{1, 0, 0.0F}, Perturbation{1, 0, 2.0F},
                                    Perturbation{1, 0, std::numeric_limits<float>::quiet_NaN()}}) {
    try {
      const PerturbedFrame moved(owned.frame(), wrong);
      FAIL("not refused");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::kInvalidArgument);
      CHECK(std::string(error.what()).find("of a perturbation") != std::string::npos);
    }
  }
}

}  // namespace stein::test
