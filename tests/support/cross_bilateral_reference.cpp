// SPDX-License-Identifier: Apache-2.0
#include "support/cross_bilateral_reference.hpp"

#include <algorithm>
#include <cmath>

namespace stein::test {
namespace {

bool is_valid(const Frame& frame, int x, int y) {
  float mask = 0;
  colour_validity_row(frame, y, x, 1, &mask);
  return mask != 0;
}

// D^2 of SBF Eq. 6 over 2 sigma_f^2, summed over the features.
double feature_distance(const CrossBilateralParams& params, const Source& source, int xi, int yi, int xj, int yj) {
  double sum = 0;
  const std::vector<Feature>& features = source.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    double sigma = params.guides.other_feature_sigma;
    for (const FeatureSigma& entry : params.guides.feature_sigmas)
      sigma = entry.name == features[f].name ? entry.sigma : sigma;
    float valid_i = 0;
    float valid_j = 0;
    feature_validity_row(features[f], yi, xi, 1, &valid_i);
    feature_validity_row(features[f], yj, xj, 1, &valid_j);
    if (sigma == 0 || valid_i == 0 || valid_j == 0) continue;
    const double scale = source.feature_scale(f);
    double squared = 0;
    double variance = 0;
    for (std::size_t k = 0; k < features[f].mean.size(); ++k) {
      const double difference =
          scale * (static_cast<double>(features[f].mean[k].at(xi, yi)) - features[f].mean[k].at(xj, yj));
      squared += difference * difference;
      if (features[f].variance.empty()) continue;
      float ni = 0;
      float nj = 0;
      sample_count_row(source.frame(), yi, xi, 1, &ni);
      sample_count_row(source.frame(), yj, xj, 1, &nj);
      variance += scale * scale *
                  (static_cast<double>(features[f].variance[k].at(xi, yi)) * ni +
                   static_cast<double>(features[f].variance[k].at(xj, yj)) * nj);
    }
    variance /= static_cast<double>(features[f].mean.size());
    sum += squared / std::max<double>(variance, params.guides.min_feature_variance) / (2.0 * sigma * sigma);
  }
  return sum;
}

}  // namespace

PixelResult cross_bilateral_reference(const CrossBilateralParams& params, const Source& source, double sigma_s, int x,
                                      int y, const std::array<double, 3>& nudge) {
  const Frame& frame = source.frame();
  const auto colour = [&](int px, int py, std::size_t c) {
    float value = 0;
    source.colour_row(c, py, px, 1, &value);
    return value + (px == x && py == y ? nudge[c] : 0.0);
  };
  double weight_sum = 0;
  std::array<double, 3> sum{};
  std::array<double, 3> sum_of_squares{};
  const double radius = 2.0 * sigma_s;
  const int r = static_cast<int>(radius);
  for (int py = std::max(y - r, 0); py <= std::min(y + r, frame.height - 1); ++py) {
    for (int px = std::max(x - r, 0); px <= std::min(x + r, frame.width - 1); ++px) {
      const double distance2 = static_cast<double>((px - x) * (px - x) + (py - y) * (py - y));
      if (distance2 > radius * radius || !is_valid(frame, px, py)) continue;
      double exponent = distance2 / (2.0 * sigma_s * sigma_s) + feature_distance(params, source, x, y, px, py);
      for (std::size_t c = 0; c < 3 && params.range_sigma > 0; ++c) {
        const double difference = colour(x, y, c) - colour(px, py, c);
        exponent += difference * difference / (2.0 * params.range_sigma * params.range_sigma);
      }
      const double weight = std::exp(-exponent);
      weight_sum += weight;
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += weight * colour(px, py, c);
        sum_of_squares[c] += weight * colour(px, py, c) * colour(px, py, c);
      }
    }
  }
  PixelResult pixel;
  for (std::size_t c = 0; c < 3; ++c) {
    pixel.result[c] = weight_sum > 0 ? sum[c] / weight_sum : colour(x, y, c);
    pixel.derivative[c] = weight_sum > 0 ? 1.0 / weight_sum : 0.0;
    if (params.range_sigma > 0 && weight_sum > 0) {
      const double spread = sum_of_squares[c] / weight_sum - pixel.result[c] * pixel.result[c];
      pixel.derivative[c] += spread / (static_cast<double>(params.range_sigma) * params.range_sigma);
    }
  }
  return pixel;
}

}  // namespace stein::test
