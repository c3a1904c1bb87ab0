// SPDX-License-Identifier: Apache-2.0
#include "support/cross_nlm_reference.hpp"

#include <algorithm>
#include <cmath>

namespace stein::test {
namespace {

struct Pixel {
  int x = 0;
  int y = 0;
};

// The image with one pixel moved.
class NudgedImage {
 public:
  NudgedImage(const Source& source, Pixel own, const Nudge& nudge) : source_(source), own_(own), nudge_(nudge) {}
  [[nodiscard]] double colour(Pixel p, std::size_t c) const {
    float value = 0;
    source_.colour_row(c, p.y, p.x, 1, &value);
    return value + (p.x == own_.x && p.y == own_.y ? nudge_.colour[c] : 0.0);
  }
  [[nodiscard]] double noise(Pixel p) const {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      float value = 0;
      source_.variance_row(c, p.y, p.x, 1, &value);
      sum += value;
    }
    return sum;
  }
  [[nodiscard]] bool is_source(Pixel p) const {
    const Frame& frame = source_.frame();
    return p.x >= 0 && p.y >= 0 && p.x < frame.width && p.y < frame.height && is_valid(frame, p.x, p.y);
  }

 private:
  const Source& source_;
  Pixel own_;
  const Nudge& nudge_;
};

double pixel_distance(const NudgedImage& image, Pixel a, Pixel b, PatchDistance kind) {
  double squared = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double difference = image.colour(a, c) - image.colour(b, c);
    squared += difference * difference;
  }
  if (kind == PatchDistance::kAbsolute) return squared;
  const double va = image.noise(a);
  const double vb = image.noise(b);
  return (squared - (va + std::min(va, vb))) / std::max(va + vb, 1e-24);
}

// Mean over the pixels that are sources in both patches.
double patch_distance(const NudgedImage& image, Pixel i, Pixel j, const CrossNlmParams& params) {
  double sum = 0;
  int count = 0;
  for (int dy = -params.patch_radius; dy <= params.patch_radius; ++dy) {
    for (int dx = -params.patch_radius; dx <= params.patch_radius; ++dx) {
      const Pixel a{i.x + dx, i.y + dy};
      const Pixel b{j.x + dx, j.y + dy};
      if (!image.is_source(a) || !image.is_source(b)) continue;
      sum += pixel_distance(image, a, b, params.distance);
      ++count;
    }
  }
  return count > 0 ? std::max(sum / count, 0.0) : 0.0;
}

}  // namespace

std::array<double, 3> cross_nlm_reference(const CrossNlmParams& params, const Source& source, double sigma_r, int x,
                                          int y, const Nudge& nudge) {
  const NudgedImage image(source, {x, y}, nudge);
  double weight_sum = 0;
  std::array<double, 3> sum{};
  for (int dy = -params.window_radius; dy <= params.window_radius; ++dy) {
    for (int dx = -params.window_radius; dx <= params.window_radius; ++dx) {
      const Pixel j{x + dx, y + dy};
      if (!image.is_source(j)) continue;
      const double weight = std::exp(-patch_distance(image, {x, y}, j, params) / (2.0 * sigma_r * sigma_r) -
                                     feature_distance(params.guides, source, x, y, j.x, j.y, nudge));
      weight_sum += weight;
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * image.colour(j, c);
    }
  }
  std::array<double, 3> result{};
  for (std::size_t c = 0; c < 3; ++c) result[c] = weight_sum > 0 ? sum[c] / weight_sum : image.colour({x, y}, c);
  return result;
}

std::array<double, 3> divergence_reference(const CrossNlmParams& params, const Source& source, double sigma_r, int x,
                                           int y, Divergence divergence) {
  return divergence_reference(source, x, y, divergence, [&](const Nudge& nudge) {
    return cross_nlm_reference(params, source, sigma_r, x, y, nudge);
  });
}

}  // namespace stein::test
