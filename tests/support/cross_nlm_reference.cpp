// SPDX-License-Identifier: Apache-2.0
#include "support/cross_nlm_reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace stein::test {
namespace {

std::size_t index_of(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

}  // namespace

CrossNlmReference::CrossNlmReference(const CrossNlmParams& params, const Source& source)
    : params_(params), source_(source), width_(source.frame().width), height_(source.frame().height) {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      Pixel& pixel = pixels_.emplace_back();
      pixel.is_source = is_valid(source.frame(), x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        float value = 0;
        source.colour_row(c, y, x, 1, &value);
        pixel.colour[c] = value;
      }
    }
  }
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) blur(pixels_, x, y);
  }
}

const CrossNlmReference::Pixel* CrossNlmReference::source_at(const std::vector<Pixel>& pixels, int x, int y) const {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return nullptr;
  const Pixel& pixel = pixels[index_of(x, y, width_)];
  return pixel.is_source ? &pixel : nullptr;
}

void CrossNlmReference::blur(std::vector<Pixel>& pixels, int x, int y) const {
  double weights = 0;
  double noise = 0;
  std::array<double, 3> sum{};
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Pixel* other = source_at(pixels, x + dx, y + dy);
      if (other == nullptr) continue;
      const double weight = std::pow(static_cast<double>(params_.patch_blur), std::abs(dx) + std::abs(dy));
      weights += weight;
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += weight * other->colour[c];
        float variance = 0;
        source_.variance_row(c, y + dy, x + dx, 1, &variance);
        noise += weight * weight * variance;
      }
    }
  }
  Pixel& pixel = pixels[index_of(x, y, width_)];
  for (std::size_t c = 0; c < 3; ++c) pixel.blurred[c] = weights > 0 ? sum[c] / weights : 0.0;
  pixel.noise = weights > 0 ? noise / (weights * weights) : 0.0;
}

// Mean over the pixels that are sources in both patches.
double CrossNlmReference::patch_distance(const std::vector<Pixel>& pixels, int xi, int yi, int xj, int yj) const {
  double sum = 0;
  int count = 0;
  for (int dy = -params_.patch_radius; dy <= params_.patch_radius; ++dy) {
    for (int dx = -params_.patch_radius; dx <= params_.patch_radius; ++dx) {
      const Pixel* a = source_at(pixels, xi + dx, yi + dy);
      const Pixel* b = source_at(pixels, xj + dx, yj + dy);
      if (a == nullptr || b == nullptr) continue;
      double squared = 0;
      for (std::size_t c = 0; c < 3; ++c) squared += (a->blurred[c] - b->blurred[c]) * (a->blurred[c] - b->blurred[c]);
      const double noise = a->noise + b->noise;
      sum += params_.distance == PatchDistance::kAbsolute
                 ? squared / 3.0
                 : (squared - a->noise - std::min(a->noise, b->noise)) / std::max(noise, 1e-24);
      ++count;
    }
  }
  return count > 0 ? std::max(sum / count, 0.0) : 0.0;
}

std::vector<CrossNlmReference::Neighbour> CrossNlmReference::neighbours(double sigma_r, int x, int y,
                                                                        const Nudge& nudge) const {
  std::vector<Pixel> pixels = pixels_;
  for (std::size_t c = 0; c < 3; ++c) pixels[index_of(x, y, width_)].colour[c] += nudge.colour[c];
  for (int py = std::max(y - 1, 0); py <= std::min(y + 1, height_ - 1); ++py) {
    for (int px = std::max(x - 1, 0); px <= std::min(x + 1, width_ - 1); ++px) blur(pixels, px, py);
  }
  std::vector<Neighbour> found;
  for (int py = y - params_.window_radius; py <= y + params_.window_radius; ++py) {
    for (int px = x - params_.window_radius; px <= x + params_.window_radius; ++px) {
      const Pixel* other = source_at(pixels, px, py);
      if (other == nullptr) continue;
      const double patches = std::isinf(sigma_r) ? 0.0 : patch_distance(pixels, x, y, px, py);
      const double weight = std::exp(-patches / (2.0 * sigma_r * sigma_r) -
                                     feature_distance(params_.guides, source_, x, y, px, py, nudge));
      found.push_back({px, py, weight, other->colour});
    }
  }
  return found;
}

std::array<double, 3> CrossNlmReference::result(double sigma_r, int x, int y, const Nudge& nudge) const {
  double weight_sum = 0;
  std::array<double, 3> sum{};
  for (const Neighbour& other : neighbours(sigma_r, x, y, nudge)) {
    weight_sum += other.weight;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += other.weight * other.colour[c];
  }
  const Pixel& own = pixels_[index_of(x, y, width_)];
  std::array<double, 3> result{};
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = weight_sum > 0 ? sum[c] / weight_sum : own.colour[c] + nudge.colour[c];
  }
  return result;
}

std::array<double, 3> CrossNlmReference::divergence(double sigma_r, int x, int y, Divergence divergence) const {
  return divergence_reference(source_, x, y, divergence,
                              [&](const Nudge& nudge) { return result(sigma_r, x, y, nudge); });
}

}  // namespace stein::test
