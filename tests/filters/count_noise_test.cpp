// SPDX-License-Identifier: Apache-2.0
//
// Noise of pixels of which a few samples see a lamp: by an independent look at what one sample less would give, and
// over many realisations against the true error.
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <array>
#include <cmath>

#include "catch.hpp"
#include "support/cross_bilateral_reference.hpp"
#include "support/cross_nlm_reference.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kSamples = 8;
constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
constexpr std::array<double, 3> kLamp = {20.0, 14.0, 6.0};  // what the lamp adds to the wall
constexpr double kWall = 0.1;
const std::vector<FeatureShape> kAlbedo = {{"albedo", 3}};

// What a channel of a feature is on the wall, and how much more on the lamp.
double on_wall(const std::string& feature, std::size_t channel) {
  return feature == "depth" ? 3.0 : feature == "albedo" ? 0.7 : 0.1 + 0.4 * static_cast<double>(channel);
}
double lamp_less_wall(const std::string& feature, std::size_t channel) {
  return feature == "albedo" ? -0.7 : 0.2 - 0.3 * static_cast<double>(channel);
}

// Calls visit(feature's name, channel, names of the planes of its mean and its variance).
template <class Visit>
void for_each_channel(const Frame& frame, Visit visit) {
  for (const Feature& feature : frame.features) {
    for (std::size_t k = 0; k < feature.mean.size(); ++k)
      visit(feature.name, k, plane_name(feature, k, false), plane_name(feature, k, true));
  }
}

// A pixel that has seen the lamp k times: means, their variances and covariances as a renderer measures them.
void see(OwnedFrame& frame, int x, int y, int k) {
  const double share = static_cast<double>(k) / kSamples;
  const double variance = share * (1.0 - share) / (kSamples - 1);
  const auto set = [&](const std::string& plane, double value) { frame.at(plane, x, y) = static_cast<float>(value); };
  for (std::size_t c = 0; c < 3; ++c) {
    set(kRgb[c], kWall + share * kLamp[c]);
    set(std::string("variance.") + kRgb[c], variance * kLamp[c] * kLamp[c]);
    for (std::size_t o = c + 1; o < 3; ++o)
      set(std::string("covariance.") + kRgb[c] + "." + kRgb[o], variance * kLamp[c] * kLamp[o]);
  }
  for_each_channel(frame.frame(), [&](const std::string& feature, std::size_t channel, const std::string& mean,
                                      const std::string& variance_plane) {
    const double more = lamp_less_wall(feature, channel);
    set(mean, on_wall(feature, channel) + share * more);
    set(variance_plane, variance * more * more);
    for (std::size_t c = 0; c < 3; ++c)
      set(std::string("covariance.") + kRgb[c] + "." + mean, variance * kLamp[c] * more);
  });
  frame.at("sampleCount", x, y) = kSamples;
}

CrossBilateralParams bilateral() {
  CrossBilateralParams params;
  params.spatial_sigmas = {1.0F, 2.0F, 4.0F};
  return params;
}

CrossNlmParams nlm(PatchDistance distance, int window_radius) {
  CrossNlmParams params;
  params.distance = distance;
  params.range_sigmas = distance == PatchDistance::kAbsolute ? std::vector<float>{0.3F, 1.0F, 3.0F}
                                                             : std::vector<float>{0.7F, 1.4F, 2.8F};
  params.window_radius = window_radius;
  params.patch_blur = 0.5F;
  return params;
}

BankResult run(const FilterSpec& spec, const Frame& frame, bool counts) {
  return run_filter(spec, frame, {64, 32, Divergence::kJoint, std::nullopt, counts});
}

// How much of the lamp a pixel sees in truth: its rim is some pixels wide.
double coverage(int x) { return 1.0 / (1.0 + std::exp(0.9 * (x - 6))); }

constexpr int kX = 11;
constexpr int kY = 10;

// A wall of which some pixels, (kX, kY) among them, have seen a lamp; with what noise says of one event at (kX, kY).
struct Rim {
  OwnedFrame frame;
  OwnedFrame less;                 // with an event less there
  std::array<double, 3> factor{};  // to the difference of the two results

  explicit Rim(int k, const std::vector<FeatureShape>& features = kAlbedo)
      : frame(23, 21, features), less(23, 21, features) {
    for (OwnedFrame* each : {&frame, &less}) {
      for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 23; ++x) see(*each, x, y, (x * 5 + y * 3) % 7 == 0 ? 1 : 0);
      }
      see(*each, kX, kY, k);
    }
    double brightness = 0;
    double lamp = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      brightness += frame.at(kRgb[c], kX, kY) / 3.0;
      lamp += kLamp[c] / 3.0;
    }
    const double share = static_cast<double>(k) / kSamples;
    const double unit = share * (1.0 - share) / (kSamples - 1);
    const double variance = unit * lamp * lamp;
    const double events = std::max(1.0, brightness * brightness / variance);
    const double event = brightness / events;  // what one adds to the brightness
    for (std::size_t c = 0; c < 3; ++c) {
      const double with_brightness = unit * lamp * kLamp[c];
      factor[c] = with_brightness / event;
      less.at(kRgb[c], kX, kY) -= static_cast<float>(event * with_brightness / variance);
    }
    for_each_channel(frame.frame(), [&](const std::string& feature, std::size_t channel, const std::string& mean,
                                        const std::string& variance_plane) {
      less.at(mean, kX, kY) -= static_cast<float>(event * lamp_less_wall(feature, channel) / lamp);
      less.at(variance_plane, kX, kY) *= static_cast<float>(1.0 - 1.0 / events);
    });
  }
};

}  // namespace

TEST_CASE("count noise: the divergence is what one event less makes of the result") {
  for (const int k : {1, 2, 3}) {
    const Rim rim(k);
    const BankResult bank = run(bilateral(), rim.frame.frame(), true);
    const Source now(rim.frame.frame(), inspect(rim.frame.frame()));
    const Source then(rim.less.frame(), inspect(rim.less.frame()));
    for (std::size_t s = 0; s < 3; ++s) {
      const float sigma = bilateral().spatial_sigmas[s];
      const auto F = cross_bilateral_reference(bilateral(), now, sigma, kX, kY);
      const auto F_less = cross_bilateral_reference(bilateral(), then, sigma, kX, kY);
      for (std::size_t c = 0; c < 3; ++c) {
        INFO(k << " of " << kSamples << ", scale " << s << ", channel " << c);
        const double expected = rim.factor[c] * (F[c] - F_less[c]);
        CHECK(bank.divergence[s][c].row(kY)[kX] == Approx(expected).epsilon(2e-4).margin(1e-5));
      }
    }
  }
}

void check_nlm(const CrossNlmParams& params, int k, const std::vector<FeatureShape>& features = kAlbedo,
               bool has_hole = false) {
  Rim rim(k, features);
  if (has_hole) {
    for (OwnedFrame* frame : {&rim.frame, &rim.less}) frame->at("G", kX + 1, kY - 1) = std::nanf("");
  }
  const BankResult bank = run(params, rim.frame.frame(), true);
  const Source now(rim.frame.frame(), inspect(rim.frame.frame()));
  const Source then(rim.less.frame(), inspect(rim.less.frame()));
  for (std::size_t s = 0; s < 3; ++s) {
    const float sigma = params.range_sigmas[s];
    const auto F = CrossNlmReference(params, now).result(sigma, kX, kY);
    const auto F_less = CrossNlmReference(params, then).result(sigma, kX, kY);
    for (std::size_t c = 0; c < 3; ++c) {
      INFO(k << " of " << kSamples << ", entry " << s << ", channel " << c << ", window " << params.window_radius);
      const double expected = rim.factor[c] * (F[c] - F_less[c]);
      CHECK(bank.divergence[s][c].row(kY)[kX] == Approx(expected).epsilon(2e-4).margin(1e-5));
    }
  }
}

TEST_CASE("count noise: cross-nlm's too, which sees the pixel's colour in the patches around it") {
  for (const PatchDistance distance : {PatchDistance::kAbsolute, PatchDistance::kVarianceNormalised}) {
    for (const int window_radius : {3, 10, 20}) {
      for (const int k : {1, 2, 3}) check_nlm(nlm(distance, window_radius), k);
    }
  }
}

TEST_CASE("count noise: cross-nlm's with the usual features, next to an invalid pixel, for patches of any size") {
  for (const int patch_radius : {0, 1, 2, 4}) {
    for (const float blur : {0.0F, 1.0F}) {
      CrossNlmParams params = nlm(PatchDistance::kVarianceNormalised, 5);
      params.patch_radius = patch_radius;
      params.patch_blur = blur;
      check_nlm(params, 2, kUsualFeatures);
      check_nlm(params, 2, kUsualFeatures, true);
      check_nlm(params, 1, {{"normal", 3}, {"albedo", 3}}, true);
    }
  }
}

TEST_CASE("count noise: all instruction sets of this machine agree") {
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    check_nlm(nlm(PatchDistance::kVarianceNormalised, 6), 2);
    check_nlm(nlm(PatchDistance::kVarianceNormalised, 6), 2, kUsualFeatures);
    hwy::SetSupportedTargetsForTest(0);
  }
}

// Sums over realisations of a lamp's rim, of each entry: relative risk by the slope, by the count, and true error.
struct RimRisks {
  std::array<Statistics, 3> by_slope;
  std::array<Statistics, 3> by_count;
  std::array<Statistics, 3> truth;

  RimRisks(const FilterSpec& spec, int realisations) {
    constexpr int kWidth = 16;
    constexpr int kHeight = 16;
    OwnedFrame frame(kWidth, kHeight, kAlbedo);
    Random random(7);
    for (int i = 0; i < realisations; ++i) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          int k = 0;
          for (int sample = 0; sample < kSamples; ++sample) k += random.uniform() < coverage(x) ? 1 : 0;
          see(frame, x, y, k);
        }
      }
      add(frame.frame(), run(spec, frame.frame(), false), run(spec, frame.frame(), true));
    }
  }

 private:
  void add(const Frame& frame, const BankResult& slope, const BankResult& count) {
    for (std::size_t s = 0; s < 3; ++s) {
      std::array<double, 3> sum{};
      for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
          const double right = kWall + coverage(x) * kLamp[0];
          const double weight = 1.0 / (right * right + 0.01);
          const double F = slope.result[s][0].row(y)[x];
          const double away = F - frame.colour[0].at(x, y);
          const double base = away * away - frame.colour_variance[0].at(x, y);
          sum[0] += weight * (base + 2.0 * slope.divergence[s][0].row(y)[x]);
          sum[1] += weight * (base + 2.0 * count.divergence[s][0].row(y)[x]);
          sum[2] += weight * (F - right) * (F - right);
        }
      }
      by_slope[s].add(sum[0]);
      by_count[s].add(sum[1]);
      truth[s].add(sum[2]);
    }
  }
};

// A binomial count is taken for a Poisson one, which leaves a tenth.
void check_rim(const FilterSpec& spec, int realisations, double least_excess_of_slope) {
  const RimRisks risks(spec, realisations);
  for (std::size_t s = 0; s < 3; ++s) {
    const double error = risks.truth[s].mean();
    const Statistics& by_slope = risks.by_slope[s];
    const Statistics& by_count = risks.by_count[s];
    INFO("entry " << s << ": true " << error << ", by the slope " << by_slope.mean() << " +- "
                  << by_slope.standard_error() << ", by the count " << by_count.mean() << " +- "
                  << by_count.standard_error());
    CHECK(std::abs(by_count.mean() - error) < 0.12 * error + 4.0 * by_count.standard_error());
    CHECK(by_slope.mean() > least_excess_of_slope * error);
  }
}

TEST_CASE("count noise: the mean risk at a lamp's rim is the mean error, where the derivative's is too high") {
  check_rim(bilateral(), 600, 2.0);
}

TEST_CASE("count noise: so is cross-nlm's") { check_rim(nlm(PatchDistance::kVarianceNormalised, 6), 300, 1.5); }

}  // namespace stein::test
