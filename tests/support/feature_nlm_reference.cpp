// SPDX-License-Identifier: Apache-2.0
#include "support/feature_nlm_reference.hpp"

#include <algorithm>
#include <cmath>

namespace stein::test {

FeatureNlmReference::FeatureNlmReference(const Source& source, std::size_t feature, const NlmWindow& window)
    : window_(window),
      width_(source.frame().width),
      height_(source.frame().height),
      means_(source.frame().features[feature].mean.size()),
      noise_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      is_usable_(noise_.size()) {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) read(source, feature, x, y);
  }
}

std::vector<double> FeatureNlmReference::means(int x, int y) const {
  std::vector<double> sums(means_.size());
  double weights = 0;
  for (int v = y - window_.radius; v <= y + window_.radius; ++v) {
    for (int u = x - window_.radius; u <= x + window_.radius; ++u) {
      if (!is_usable(u, v)) continue;
      const double weight = std::exp(-patch_distance(x, y, u, v));
      weights += weight;
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += weight * means_[k][index(u, v)];
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = weights > 0 ? sums[k] / weights : means_[k][index(x, y)];
  return sums;
}

double FeatureNlmReference::kept(int x, int y, std::size_t channel) {
  if (!is_usable(x, y)) return 0;
  constexpr double kStep = 1e-5;
  double& own = means_[channel][index(x, y)];
  const double value = own;
  own = value + kStep;
  const double above = means(x, y)[channel];
  own = value - kStep;
  const double below = means(x, y)[channel];
  own = value;
  return std::clamp((above - below) / (2 * kStep), 0.0, 1.0);
}

std::size_t FeatureNlmReference::index(int x, int y) const {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
}

bool FeatureNlmReference::is_usable(int x, int y) const {
  return x >= 0 && y >= 0 && x < width_ && y < height_ && is_usable_[index(x, y)];
}

void FeatureNlmReference::read(const Source& source, std::size_t feature, int x, int y) {
  float values[4] = {};
  float* rows[4] = {values, values + 1, values + 2, values + 3};
  float mask = 0;
  source.feature_mean_rows(feature, 1.0F, y, x, 1, rows);
  source.mask_row(y, x, 1, &mask);
  for (std::size_t k = 0; k < means_.size(); ++k) {
    float variance = 0;
    source.feature_variance_row(feature, k, y, x, 1, &variance);
    if (variance >= Source::kNoInformation) mask = 0;
    noise_[index(x, y)] += variance;
    means_[k].push_back(values[k]);
  }
  is_usable_[index(x, y)] = mask != 0;
}

double FeatureNlmReference::pair_distance(std::size_t a, std::size_t b) const {
  double squares = 0;
  for (const std::vector<double>& mean : means_) squares += std::pow(mean[a] - mean[b], 2);
  return (squares - (noise_[a] + std::min(noise_[a], noise_[b]))) / std::max(noise_[a] + noise_[b], 1e-24);
}

// Over the pairs of pixels of the two patches that are both usable.
double FeatureNlmReference::patch_distance(int ax, int ay, int bx, int by) const {
  double sum = 0;
  int count = 0;
  for (int v = -window_.patch_radius; v <= window_.patch_radius; ++v) {
    for (int u = -window_.patch_radius; u <= window_.patch_radius; ++u) {
      if (!is_usable(ax + u, ay + v) || !is_usable(bx + u, by + v)) continue;
      sum += pair_distance(index(ax + u, ay + v), index(bx + u, by + v));
      ++count;
    }
  }
  return std::max(sum / std::max(count, 1), 0.0);
}

}  // namespace stein::test
