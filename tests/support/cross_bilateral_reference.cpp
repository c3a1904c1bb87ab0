// SPDX-License-Identifier: Apache-2.0
#include "support/cross_bilateral_reference.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace stein::test {

bool is_valid(const Frame& frame, int x, int y) {
  float mask = 0;
  colour_validity_row(frame, y, x, 1, &mask);
  return mask != 0;
}

namespace {

/// What a feature is at a pixel: its means, and the per-sample variance, summed over the channels.
struct FeaturePixel {
  std::array<double, 4> mean{};
  double variance = 0;
};

bool is_usable(const Feature& feature, int x, int y) {
  float usable = 0;
  feature_validity_row(feature, y, x, 1, &usable);
  return usable != 0;
}

FeaturePixel own_feature(const Frame& frame, const Feature& feature, int x, int y) {
  FeaturePixel pixel;
  float n = 0;
  sample_count_row(frame, y, x, 1, &n);
  for (std::size_t k = 0; k < feature.mean.size(); ++k) {
    pixel.mean[k] = feature.mean[k].at(x, y);
    if (!feature.variance.empty()) pixel.variance += static_cast<double>(feature.variance[k].at(x, y)) * n;
  }
  return pixel;
}

/// Where it is unusable: by the pixels around, if half of them have it.
std::optional<FeaturePixel> feature_at(const Frame& frame, const Feature& feature, int x, int y) {
  if (is_usable(feature, x, y)) return own_feature(frame, feature, x, y);
  std::vector<FeaturePixel> found;
  int around = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame.height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, frame.width - 1); ++u) {
      if (u == x && v == y) continue;
      ++around;
      if (is_usable(feature, u, v)) found.push_back(own_feature(frame, feature, u, v));
    }
  }
  if (found.empty() || 2 * static_cast<int>(found.size()) < around) return std::nullopt;
  FeaturePixel pixel;
  const auto count = static_cast<double>(found.size());
  for (const FeaturePixel& p : found) {
    for (std::size_t k = 0; k < 4; ++k) pixel.mean[k] += p.mean[k] / count;
  }
  for (const FeaturePixel& p : found) {
    pixel.variance += p.variance / count;
    for (std::size_t k = 0; k < 4; ++k) pixel.variance += std::pow(p.mean[k] - pixel.mean[k], 2) / count;
  }
  return pixel;
}

}  // namespace

double feature_distance(const FeatureGuides& guides, const Source& source, int xi, int yi, int xj, int yj,
                        const Nudge& nudge) {
  double sum = 0;
  const std::vector<Feature>& features = source.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    double sigma = guides.other_feature_sigma;
    for (const FeatureSigma& entry : guides.feature_sigmas)
      sigma = entry.name == features[f].name ? entry.sigma : sigma;
    if (sigma == 0) continue;
    const std::optional<FeaturePixel> i = feature_at(source.frame(), features[f], xi, yi);
    const std::optional<FeaturePixel> j = feature_at(source.frame(), features[f], xj, yj);
    if (!i || !j) continue;
    const double scale = source.feature_scale(f);
    const bool is_nudged =
        !nudge.features.empty() && (xi != xj || yi != yj) && is_usable(features[f], xi, yi);  // its own value counts
    double squared = 0;
    for (std::size_t k = 0; k < features[f].mean.size(); ++k) {
      const double step = is_nudged ? nudge.features[f][k] : 0.0;
      squared += std::pow(scale * (i->mean[k] + step - j->mean[k]), 2);
    }
    const double variance = scale * scale * (i->variance + j->variance) / static_cast<double>(features[f].mean.size());
    sum += squared / std::max<double>(variance, guides.min_feature_variance) / (2.0 * sigma * sigma);
  }
  return sum;
}

std::array<double, 3> cross_bilateral_reference(const CrossBilateralParams& params, const Source& source,
                                                double sigma_s, int x, int y, const Nudge& nudge) {
  const Frame& frame = source.frame();
  const auto colour = [&](int px, int py, std::size_t c) {
    float value = 0;
    source.colour_row(c, py, px, 1, &value);
    return value + (px == x && py == y ? nudge.colour[c] : 0.0);
  };
  double weight_sum = 0;
  std::array<double, 3> sum{};
  const double radius = 2.0 * sigma_s;
  const auto r = static_cast<int>(radius);
  for (int py = std::max(y - r, 0); py <= std::min(y + r, frame.height - 1); ++py) {
    for (int px = std::max(x - r, 0); px <= std::min(x + r, frame.width - 1); ++px) {
      const auto distance2 = static_cast<double>((px - x) * (px - x) + (py - y) * (py - y));
      if (distance2 > radius * radius || !is_valid(frame, px, py)) continue;
      double exponent =
          distance2 / (2.0 * sigma_s * sigma_s) + feature_distance(params.guides, source, x, y, px, py, nudge);
      for (std::size_t c = 0; c < 3 && params.range_sigma > 0; ++c) {
        const double difference = colour(x, y, c) - colour(px, py, c);
        exponent += difference * difference / (2.0 * params.range_sigma * params.range_sigma);
      }
      const double weight = std::exp(-exponent);
      weight_sum += weight;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * colour(px, py, c);
    }
  }
  std::array<double, 3> result{};
  for (std::size_t c = 0; c < 3; ++c) result[c] = weight_sum > 0 ? sum[c] / weight_sum : colour(x, y, c);
  return result;
}

namespace {

// Covariance of colour channel c with every input of the pixel itself: colours first, then all feature channels.
struct OwnInputs {
  std::vector<double> covariance;
  std::vector<std::pair<std::size_t, std::size_t>> feature;  // [i - 3]: feature and channel
};

OwnInputs own_inputs(const Source& source, std::size_t c, int x, int y, Divergence divergence) {
  const bool is_joint = divergence == Divergence::kJoint;
  const Frame& frame = source.frame();
  OwnInputs inputs;
  float own = 0;
  source.variance_row(c, y, x, 1, &own);  // 0 at filled pixels; outliers there are none
  for (std::size_t other = 0; other < 3; ++other) {
    const ConstPlaneView& plane = frame.colour_covariance[other == c ? 0 : c + other - 1];
    const bool is_known = is_joint && plane && own > 0;
    inputs.covariance.push_back(other == c ? static_cast<double>(own) : is_known ? plane.at(x, y) : 0.0);
  }
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    const Feature& feature = frame.features[f];
    float valid = 0;
    feature_validity_row(feature, y, x, 1, &valid);
    for (std::size_t k = 0; k < feature.mean.size(); ++k) {
      const bool is_known = is_joint && !feature.colour_covariance.empty() && own > 0 && valid != 0;
      inputs.covariance.push_back(is_known ? feature.colour_covariance[c * feature.mean.size() + k].at(x, y) : 0.0);
      inputs.feature.emplace_back(f, k);
    }
  }
  return inputs;
}

Nudge nudge_of(const Frame& frame, const OwnInputs& inputs, std::size_t input, double step) {
  Nudge nudge;
  for (const Feature& feature : frame.features) nudge.features.emplace_back(feature.mean.size(), 0.0);
  if (input < 3) {
    nudge.colour[input] = step;
  } else {
    const auto [f, k] = inputs.feature[input - 3];
    nudge.features[f][k] = step;
  }
  return nudge;
}

}  // namespace

std::array<double, 3> divergence_reference(const Source& source, int x, int y, Divergence divergence,
                                           const NudgedFilter& filter) {
  constexpr double kStep = 1e-5;
  std::array<double, 3> sum{};
  for (std::size_t c = 0; c < 3; ++c) {
    const OwnInputs inputs = own_inputs(source, c, x, y, divergence);
    for (std::size_t i = 0; i < inputs.covariance.size(); ++i) {
      if (inputs.covariance[i] == 0.0) continue;
      const auto at = [&](double step) { return filter(nudge_of(source.frame(), inputs, i, step))[c]; };
      sum[c] += (at(kStep) - at(-kStep)) / (2.0 * kStep) * inputs.covariance[i];
    }
  }
  return sum;
}

std::array<double, 3> divergence_reference(const CrossBilateralParams& params, const Source& source, double sigma_s,
                                           int x, int y, Divergence divergence) {
  return divergence_reference(source, x, y, divergence, [&](const Nudge& nudge) {
    return cross_bilateral_reference(params, source, sigma_s, x, y, nudge);
  });
}

}  // namespace stein::test
