// SPDX-License-Identifier: Apache-2.0
#include "support/noisy_scene.hpp"

#include <algorithm>
#include <cmath>

namespace stein::test {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 16;
constexpr double kSamples = 8.0;
constexpr std::size_t kChannels = 10;  // R G B, normal, albedo, depth

using Surface = std::array<double, kChannels>;
constexpr Surface kLamp = {6.0, 5.0, 3.5, 0.0, 0.0, 1.0, 0.9, 0.9, 0.8, 0.35};
constexpr Surface kWall = {0.7, 0.5, 0.4, 0.0, 1.0, 0.0, 0.5, 0.4, 0.3, 0.60};
constexpr Surface kDark = {0.2, 0.2, 0.3, 0.6, 0.8, 0.0, 0.1, 0.1, 0.2, 0.60};
constexpr Surface kBright = {0.9, 1.1, 0.8, 0.6, 0.7, 0.1, 0.8, 0.9, 0.7, 0.62};

// Standard deviations of the light noise: one part of all channels alike, and one of each.
constexpr double kShared = 0.12;
constexpr double kOwn = 0.08;

struct Mixture {
  const Surface& a;
  const Surface& b;
  double p;
};

Mixture mixture_at(int x, int y) {
  if (x < kWidth / 2) {
    const double t = (x + 0.3 * y - 2.0) / 10.0;
    return {kLamp, kWall, std::clamp(t, 0.0, 1.0)};
  }
  const int phase = (2 * x + y) % 6;
  return {kBright, kDark, phase < 2 ? 0.0 : phase == 2 || phase == 5 ? 0.5 : 1.0};
}

}  // namespace

NoisyScene::NoisyScene(const NoisySceneParams& params)
    : params_(params), owned_(kWidth, kHeight, kUsualFeatures), random_(params.seed), mixing_(kWidth, kHeight) {
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  std::vector<std::string> names(kRgb.begin(), kRgb.end());
  for (const Feature& feature : owned_.frame().features) {
    for (std::size_t k = 0; k < feature.mean.size(); ++k) names.push_back(plane_name(feature, k, false));
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    Channel channel;
    channel.mean = &owned_.plane(names[i]);
    std::string variance = names[i];
    variance.insert(i < 3 ? 0 : variance.find('.') + 1, "variance.");
    channel.variance = &owned_.plane(variance);
    for (std::size_t c = 0; c < std::min<std::size_t>(i, 3); ++c) {
      channel.covariance[c] = &owned_.plane(std::string("covariance.") + kRgb[c] + "." + names[i]);
    }
    channels_.push_back(channel);
    mean_.emplace_back(kWidth, kHeight);
  }
  for (Plane& plane : truth_) plane = Plane(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) describe(x, y);
  }
}

// Means, variances and covariances of one pixel.
void NoisyScene::describe(int x, int y) {
  const Mixture mixture = mixture_at(x, y);
  const double mixing = std::sqrt(mixture.p * (1.0 - mixture.p) / kSamples);
  mixing_.row(y)[x] = static_cast<float>(mixing);
  const auto slope = [&](std::size_t i) {
    return i < 3 || params_.feature_noise ? mixing * (mixture.a[i] - mixture.b[i]) : 0.0;
  };
  for (std::size_t i = 0; i < kChannels; ++i) {
    mean_[i].row(y)[x] = static_cast<float>(mixture.p * mixture.a[i] + (1.0 - mixture.p) * mixture.b[i]);
    if (i < 3) truth_[i].row(y)[x] = mean_[i].row(y)[x];
    const double light = i < 3 ? kShared * kShared + kOwn * kOwn : 0.0;
    channels_[i].variance->row(y)[x] = static_cast<float>(slope(i) * slope(i) + light);
    for (std::size_t c = 0; c < std::min<std::size_t>(i, 3); ++c) {
      const double shared = i < 3 ? kShared * kShared : 0.0;
      channels_[i].covariance[c]->row(y)[x] = static_cast<float>(slope(c) * slope(i) + shared);
    }
  }
}

void NoisyScene::draw() {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Mixture mixture = mixture_at(x, y);
      const double seen = mixing_.row(y)[x] * random_.normal();
      const double light = kShared * random_.normal();
      for (std::size_t i = 0; i < kChannels; ++i) {
        const bool moves = i < 3 || params_.feature_noise;
        double value = mean_[i].row(y)[x] + (moves ? seen * (mixture.a[i] - mixture.b[i]) : 0.0);
        if (i < 3) value += light + kOwn * random_.normal();
        channels_[i].mean->row(y)[x] = static_cast<float>(value);
      }
    }
  }
}

}  // namespace stein::test
