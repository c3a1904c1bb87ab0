// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "catch.hpp"
#include "stein/error.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// Smooth truth with an edge that the features show; Gaussian noise of a known variance in the colour.
struct Scene {
  static constexpr int kWidth = 120;
  static constexpr int kHeight = 90;
  OwnedFrame frame{kWidth, kHeight, kUsualFeatures};

  static double truth(int x, int y) {
    return 0.5 + 0.3 * std::sin(0.03 * x) + 0.1 * std::cos(0.05 * y) + (x > 70 ? 1.0 : 0.0);
  }

  explicit Scene(double deviation, std::uint64_t seed = 99) {
    Random random(seed);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (const char* c : {"R", "G", "B"}) {
          frame.at(c, x, y) = static_cast<float>(truth(x, y) + deviation * random.normal());
          frame.at(std::string("variance.") + c, x, y) = static_cast<float>(deviation * deviation);
        }
        frame.at("albedo.R", x, y) = x > 70 ? 0.9F : 0.1F;
        for (const std::string& name : frame.names()) {
          if (name.find(".variance.") != std::string::npos) frame.at(name, x, y) = 0.0F;
        }
      }
    }
  }

  [[nodiscard]] double mse(const DenoiseResult& result) const {
    double sum = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) sum += std::pow(result.colour[1].row(y)[x] - truth(x, y), 2);
    }
    return sum / (kWidth * kHeight);
  }
};

// A single filter, whose result is that of its candidates.
DenoiseParams bank() {
  DenoiseParams params;
  params.filters = {CrossBilateralParams{}};
  return params;
}

std::string message_of(const Frame& frame, const DenoiseParams& params, ErrorCode code) {
  try {
    (void)denoise(frame, params);
  } catch (const Error& error) {
    CHECK(error.code() == code);
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("denoise: removes most of the noise, keeps the edge, and knows the error that is left") {
  const Scene scene(0.2);
  const DenoiseResult result = denoise(scene.frame.frame(), bank());
  const double left = scene.mse(result);
  CHECK(left < 0.04 / 15);
  CHECK(result.report.mean_error[1] == Approx(left).margin(0.0012));
  for (int y = 5; y < Scene::kHeight; y += 10) {
    CHECK(result.colour[0].row(y)[70] == Approx(Scene::truth(70, y)).margin(0.25));
    CHECK(result.colour[0].row(y)[71] == Approx(Scene::truth(71, y)).margin(0.25));
  }
}

TEST_CASE("denoise: converges to the input as the variance vanishes") {
  double last = 1;
  for (const double deviation : {0.1, 0.01, 0.001, 0.0001}) {
    const Scene scene(deviation);
    const double left = scene.mse(denoise(scene.frame.frame(), bank()));
    CHECK(left < 1.05 * deviation * deviation);
    CHECK(left < last);
    last = left;
  }
}

TEST_CASE("denoise: strength 0 is the input to the bit, and the error that of the mix") {
  const Scene scene(0.2);
  DenoiseParams params = bank();
  params.strength = 0.0F;
  const DenoiseResult result = denoise(scene.frame.frame(), params);
  for (int y = 0; y < Scene::kHeight; ++y) {
    for (int x = 0; x < Scene::kWidth; ++x) CHECK(result.colour[2].row(y)[x] == scene.frame.frame().colour[2].at(x, y));
  }
  CHECK(result.report.mean_error[0] == Approx(0.04).epsilon(1e-4));
  params.strength = 0.5F;
  const DenoiseResult half = denoise(scene.frame.frame(), params);
  CHECK(half.report.mean_error[1] == Approx(scene.mse(half)).epsilon(0.12));
}

// Up to 32 pixels wide and high, no risk is evidence enough: what is reported lies within a tenth of what is likely.
TEST_CASE("denoise: with a strength, the divergences of filter and input both count to the error that is likely") {
  constexpr int kSize = 32;
  constexpr double kVariance = 0.04;
  OwnedFrame frame(kSize, kSize, {});
  Random random(8);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      for (const char* c : {"R", "G", "B"}) {
        // As much signal as noise from pixel to pixel: a good filter keeps some of both.
        frame.at(c, x, y) = static_cast<float>(1.0 + 0.2 * random.normal() + std::sqrt(kVariance) * random.normal());
        frame.at(std::string("variance.") + c, x, y) = static_cast<float>(kVariance);
      }
    }
  }
  DenoiseParams params;
  params.filters = {GaussianParams{}};
  const auto reported = [&](float strength) {
    params.strength = strength;
    return denoise(frame.frame(), params).report.mean_error[1];
  };
  const double d = reported(1.0F) / kVariance;  // the share of the input's divergence that is left
  REQUIRE(d > 0.15);
  REQUIRE(d < 0.85);
  for (const double t : {0.25, 0.5, 0.75}) {
    CHECK(reported(static_cast<float>(t)) / kVariance ==
          Approx(t * t * d + 2.0 * t * (1.0 - t) * d + (1.0 - t) * (1.0 - t)).epsilon(0.05));
  }
}

TEST_CASE("denoise: argmin picks one entry a pixel and evidence is at least as good here") {
  const Scene scene(0.2);
  DenoiseParams params = bank();
  params.selection = Selection::kArgmin;
  const DenoiseResult hard = denoise(scene.frame.frame(), params);
  params.selection = Selection::kEvidence;
  const DenoiseResult evidence = denoise(scene.frame.frame(), params);
  CHECK(scene.mse(evidence) < scene.mse(hard));
  double shares = 0;
  for (const double share : evidence.report.choice_share) shares += share;
  CHECK(shares == Approx(1.0));
  CHECK(evidence.report.candidates.size() == 8);
}

// All candidates of a bank without guides smear the lamp, the wide ones by orders of magnitude over what is there. The
// pixels themselves say that they are dark.
TEST_CASE("denoise: without guides a lamp does not spill over the dark beside it") {
  constexpr int kWidth = 96;
  constexpr int kHeight = 72;
  constexpr int kLamp = 40;  // its corner
  OwnedFrame frame(kWidth, kHeight, {});
  Random random(5);
  const auto is_lamp = [](int x, int y) { return x >= kLamp && x < kLamp + 3 && y >= kLamp && y < kLamp + 3; };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double truth = is_lamp(x, y) ? 1000.0 : 0.15;
      const double deviation = is_lamp(x, y) ? 300.0 : 0.06;
      for (const char* c : {"R", "G", "B"}) {
        frame.at(c, x, y) = static_cast<float>(truth + deviation * random.normal());
        frame.at(std::string("variance.") + c, x, y) = static_cast<float>(deviation * deviation);
      }
    }
  }
  DenoiseParams params;
  params.filters = {GaussianParams{}};
  params.outliers.enabled = false;
  const DenoiseResult result = denoise(frame.frame(), params);
  double largest = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (is_lamp(x, y)) continue;
      largest = std::max(largest, std::abs(result.colour[1].row(y)[x] - 0.15));
      if (std::hypot(x - kLamp - 1, y - kLamp - 1) < 4) CHECK(result.choice.row(y)[x] == 0.0F);
    }
  }
  CHECK(largest < 30);  // smoothed weights leak a per cent of the lamp; the narrowest candidate a quarter
}

TEST_CASE("denoise: an invalid pixel leaves no halo and is counted") {
  const Scene clean(0.1);
  Scene broken(0.1);
  broken.frame.at("R", 30, 40) = std::numeric_limits<float>::infinity();
  broken.frame.at("variance.G", 31, 40) = -1.0F;
  broken.frame.at("sampleCount", 90, 10) = 0.0F;
  const DenoiseResult expected = denoise(clean.frame.frame(), bank());
  const DenoiseResult result = denoise(broken.frame.frame(), bank());
  CHECK(result.report.frame.invalid_pixels == 3);
  CHECK(result.report.warnings.size() >= 1);
  for (int y = 0; y < Scene::kHeight; ++y) {
    for (int x = 0; x < Scene::kWidth; ++x)
      CHECK(result.colour[0].row(y)[x] == Approx(expected.colour[0].row(y)[x]).margin(0.1));
  }
  DenoiseParams strict = bank();
  strict.strict = true;
  const std::string message = message_of(broken.frame.frame(), strict, ErrorCode::kInvalidFrame);
  CHECK(message.find("sampleCount") != std::string::npos);  // the first in row order
  CHECK(message.find("(90, 10)") != std::string::npos);
}

// Filled with the mean of its neighbours, it looks as if the filter had taken most of that away. So narrow a filter has
// less of an error than its divergence says, which the risk shows, if no pixel drowns it.
TEST_CASE("denoise: a filled pixel beside a lamp does not count in the mean error") {
  constexpr int kWidth = 256;
  constexpr int kHeight = 160;
  OwnedFrame frame(kWidth, kHeight, {{"albedo", 1}}, false);
  Random random(7);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool is_lamp = x == 100 && y > 60 && y < 100;
      for (const char* c : {"R", "G", "B"}) {
        frame.at(c, x, y) = static_cast<float>((is_lamp ? 300.0 : 0.5) + 0.1 * random.normal());
        frame.at(std::string("variance.") + c, x, y) = 0.01F;
      }
      for (const std::string& name : frame.names()) {
        if (name.starts_with("albedo")) frame.at(name, x, y) = is_lamp && name.find("variance") == std::string::npos;
      }
    }
  }
  DenoiseParams params;
  CrossBilateralParams narrow;
  narrow.spatial_sigmas = {1.0F};
  params.filters = {narrow};
  const DenoiseReport sound = denoise(frame.frame(), params).report;
  frame.at("G", 101, 80) = std::numeric_limits<float>::quiet_NaN();
  const DenoiseReport filled = denoise(frame.frame(), params).report;
  REQUIRE(filled.frame.invalid_pixels == 1);
  CHECK(filled.mean_relative_error == Approx(sound.mean_relative_error).epsilon(0.02));
  CHECK(filled.mean_error[1] == Approx(sound.mean_error[1]).epsilon(0.02));
}

TEST_CASE("denoise: a firefly is scaled down, a bright pixel that its samples support is not") {
  Scene scene(0.05);
  for (const char* c : {"R", "G", "B"}) {
    scene.frame.at(c, 30, 30) = 100.0F;  // one sample of 800, the others without: standard error equals the mean
    scene.frame.at(std::string("variance.") + c, 30, 30) = 10000.0F;
    scene.frame.at(c, 50, 60) = 100.0F;  // all samples agree
    scene.frame.at(std::string("variance.") + c, 50, 60) = 0.0025F;
  }
  const DenoiseResult result = denoise(scene.frame.frame(), bank());
  CHECK(result.report.outlier_pixels >= 1);
  CHECK(result.report.outlier_energy > 0);
  CHECK(result.colour[0].row(30)[30] < 1.0F);
  CHECK(result.colour[0].row(60)[50] > 50.0F);
  DenoiseParams off = bank();
  off.outliers.enabled = false;
  const DenoiseResult kept = denoise(scene.frame.frame(), off);
  CHECK(kept.report.outlier_pixels == 0);
  CHECK(kept.colour[0].row(30)[30] > 10.0F);
}

TEST_CASE("denoise: what a firefly lost is given back around it, all of it, and nowhere else") {
  Scene scene(0.05);
  constexpr float kFirefly = 100.0F;
  for (const char* c : {"R", "G", "B"}) {
    scene.frame.at(c, 2, 30) = kFirefly;  // near the border: the Gaussian is cut there
    scene.frame.at(std::string("variance.") + c, 2, 30) = kFirefly * kFirefly;
  }
  DenoiseParams params = bank();
  params.outliers.spread = 0.0F;
  const DenoiseResult lost = denoise(scene.frame.frame(), params);
  params.outliers.spread = 3.0F;
  const DenoiseResult kept = denoise(scene.frame.frame(), params);
  params.strength = 0.5F;
  const DenoiseResult half = denoise(scene.frame.frame(), params);
  double sum = 0;
  double half_sum = 0;
  for (int y = 0; y < Scene::kHeight; ++y) {
    for (int x = 0; x < Scene::kWidth; ++x) {
      const float more = kept.colour[0].row(y)[x] - lost.colour[0].row(y)[x];
      sum += more;
      half_sum += half.colour[0].row(y)[x] - 0.5 * (static_cast<double>(lost.colour[0].row(y)[x]) +
                                                    static_cast<double>(scene.frame.at("R", x, y)));
      if (std::abs(x - 2) > 8 || std::abs(y - 30) > 8) CHECK(more == 0.0F);
    }
  }
  double total = 0;
  for (const DenoiseResult* result : {&lost, &kept}) {
    double all = 0;
    for (const Plane& plane : result->colour) {
      for (int y = 0; y < Scene::kHeight; ++y) all += std::accumulate(plane.row(y), plane.row(y) + Scene::kWidth, 0.0);
    }
    total = all;
    if (result == &lost) CHECK(3.0 * sum == Approx(result->report.outlier_energy * (all + 3.0 * sum)).epsilon(1e-4));
  }
  CHECK(3.0 * sum == Approx(kept.report.outlier_energy * total).epsilon(1e-4));
  CHECK(sum > 0.9 * static_cast<double>(kFirefly));
  CHECK(half_sum == Approx(0.5 * sum).epsilon(1e-3));
  CHECK(kept.colour[0].row(30)[2] < 5.0F);
}

TEST_CASE("denoise: all pixels invalid is an error that says so") {
  OwnedFrame frame(20, 20, {});
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) frame.at("sampleCount", x, y) = 0.0F;
  }
  CHECK(message_of(frame.frame(), {}, ErrorCode::kInvalidFrame).find("no pixel") != std::string::npos);
}

TEST_CASE("denoise: parameters out of range are named") {
  const Scene scene(0.1);
  DenoiseParams params = bank();
  params.strength = 1.5F;
  CHECK(message_of(scene.frame.frame(), params, ErrorCode::kInvalidArgument).find("strength") != std::string::npos);
  params = {};
  params.execution.tile_width = 3;
  CHECK(message_of(scene.frame.frame(), params, ErrorCode::kInvalidArgument).find("tile_width") != std::string::npos);
  params = {};
  params.execution.threads = -2;
  CHECK(message_of(scene.frame.frame(), params, ErrorCode::kInvalidArgument).find("threads") != std::string::npos);
  params = {};
  params.outliers.support = 0.0F;
  CHECK(message_of(scene.frame.frame(), params, ErrorCode::kInvalidArgument).find("outliers.support") !=
        std::string::npos);
  params = {};
  params.density.epsilon = 0.0F;
  CHECK(message_of(scene.frame.frame(), params, ErrorCode::kInvalidArgument).find("density.epsilon") !=
        std::string::npos);
}

TEST_CASE("denoise: progress rises to 1 and cancelling stops at once") {
  const Scene scene(0.1);
  double last = 0;
  DenoiseParams params = bank();
  params.execution.progress = [&](double fraction) {
    CHECK(fraction >= last);
    CHECK(fraction <= 1.0);
    last = fraction;
    return true;
  };
  (void)denoise(scene.frame.frame(), params);
  CHECK(last == Approx(1.0).epsilon(0.01));

  int calls = 0;
  params.execution.progress = [&](double) { return ++calls < 5; };
  CHECK(message_of(scene.frame.frame(), params, ErrorCode::kCancelled).find("cancelled") != std::string::npos);
  CHECK(calls == 5);  // none after the one that cancelled
}

TEST_CASE("denoise: the density is finite, has mean 1, and follows the noise") {
  Scene scene(0.05);
  Random random(5);
  for (int y = 30; y < 60; ++y) {
    for (int x = 10; x < 50; ++x) {
      for (const char* c : {"R", "G", "B"}) {
        scene.frame.at(c, x, y) += static_cast<float>(0.4 * random.normal());
        scene.frame.at(std::string("variance.") + c, x, y) = 0.1625F;
      }
    }
  }
  const DenoiseResult result = denoise(scene.frame.frame(), bank());
  double sum = 0;
  double noisy = 0;
  double quiet = 0;
  for (int y = 0; y < Scene::kHeight; ++y) {
    for (int x = 0; x < Scene::kWidth; ++x) {
      const float density = result.density.row(y)[x];
      REQUIRE(std::isfinite(density));
      REQUIRE(density >= 0.0F);
      sum += density;
      if (x >= 15 && x < 45 && y >= 35 && y < 55) noisy += density / 600.0;
      if (x >= 60 && x < 70) quiet += density / 900.0;
    }
  }
  CHECK(sum / (Scene::kWidth * Scene::kHeight) == Approx(1.0).epsilon(1e-5));
  CHECK(noisy > 20 * quiet);
}

TEST_CASE("denoise: the density of error reduction is the relative error less, the more samples there are") {
  Scene scene(0.05);
  for (int y = 0; y < Scene::kHeight; ++y) {
    for (int x = 0; x < Scene::kWidth; ++x) scene.frame.at("sampleCount", x, y) = x < 32 ? 4.0F : 64.0F;
  }
  DenoiseParams params = bank();
  params.density.rule = DensityRule::kErrorReduction;
  params.density.dimensions = 4.0F;
  const DenoiseResult result = denoise(scene.frame.frame(), params);
  double scale = 0;  // densities have mean 1
  for (int y = 0; y < Scene::kHeight; ++y) {
    for (int x = 0; x < Scene::kWidth; ++x) {
      double error = 0;
      double luminance = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        error += result.error[c].row(y)[x] / 3.0;
        luminance += static_cast<double>(params.luminance_weights[c]) * result.colour[c].row(y)[x];
      }
      const double n = x < 32 ? 4.0 : 64.0;
      const double expected = std::max(error, 0.0) * std::pow(n, -0.5) / (luminance * luminance + 0.001);
      if (expected < 1e-6) continue;
      if (scale == 0) scale = result.density.row(y)[x] / expected;
      CHECK(result.density.row(y)[x] == Approx(scale * expected).epsilon(1e-3));
    }
  }
  REQUIRE(scale > 0);
}

TEST_CASE("denoise: works in the caller's arena while other work waits there") {
  const Scene scene(0.1);
  DenoiseParams params = bank();
  params.execution.threads = 0;
  const DenoiseResult a = denoise(scene.frame.frame(), params);
  params.execution.threads = 3;
  const DenoiseResult b = denoise(scene.frame.frame(), params);
  CHECK(a.colour[0].row(20)[20] == b.colour[0].row(20)[20]);
}

}  // namespace stein::test
