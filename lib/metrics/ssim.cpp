// SPDX-License-Identifier: Apache-2.0
#include "metrics/ssim.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace stein::metrics {
namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;  // (K1 * data range)^2
constexpr double kC2 = 0.03 * 0.03;  // (K2 * data range)^2

std::array<double, kRadius + 1> gaussian_taps() {
  std::array<double, kRadius + 1> taps{};
  for (int i = 0; i <= kRadius; ++i) {
    taps[static_cast<std::size_t>(i)] = std::exp(-i * i / (2 * kSigma * kSigma));
  }
  return taps;
}

// The Gaussian mean along one line of `count` values that lie `step` apart, clipped to the line.
void blur_line(const double* in, double* out, int count, std::ptrdiff_t step) {
  static const std::array<double, kRadius + 1> taps = gaussian_taps();
  for (int i = 0; i < count; ++i) {
    double sum = 0;
    double weight_sum = 0;
    for (int j = std::max(0, i - kRadius); j <= std::min(count - 1, i + kRadius); ++j) {
      const double weight = taps[static_cast<std::size_t>(std::abs(i - j))];
      sum += weight * in[j * step];
      weight_sum += weight;
    }
    out[i * step] = sum / weight_sum;
  }
}

GreyImage blur(const GreyImage& image) {
  const std::ptrdiff_t width = image.width;
  GreyImage rows = image;
  for (int y = 0; y < image.height; ++y) {
    blur_line(image.values.data() + y * width, rows.values.data() + y * width, image.width, 1);
  }
  GreyImage result = rows;
  for (int x = 0; x < image.width; ++x) {
    blur_line(rows.values.data() + x, result.values.data() + x, image.height, width);
  }
  return result;
}

GreyImage product(const GreyImage& a, const GreyImage& b) {
  GreyImage result = a;
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    result.values[i] *= b.values[i];
  }
  return result;
}

}  // namespace

double ssim(const GreyImage& a, const GreyImage& b) {
  const GreyImage mean_a = blur(a);
  const GreyImage mean_b = blur(b);
  const GreyImage mean_aa = blur(product(a, a));
  const GreyImage mean_bb = blur(product(b, b));
  const GreyImage mean_ab = blur(product(a, b));

  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double ma = mean_a.values[i];
    const double mb = mean_b.values[i];
    const double variance_a = mean_aa.values[i] - ma * ma;
    const double variance_b = mean_bb.values[i] - mb * mb;
    const double covariance = mean_ab.values[i] - ma * mb;
    sum += (2 * ma * mb + kC1) * (2 * covariance + kC2) / ((ma * ma + mb * mb + kC1) * (variance_a + variance_b + kC2));
  }
  return sum / static_cast<double>(a.values.size());
}

}  // namespace stein::metrics
