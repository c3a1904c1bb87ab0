// SPDX-License-Identifier: Apache-2.0
#include "select/guided_pass.hpp"

#include <array>

namespace stein {
namespace {

constexpr std::array<float, kernels::kWindow> kBoxWeights = {1, 1, 1, 1, 1};
constexpr std::array<float, kernels::kWindow> kSplineWeights = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};

// Appends the window's row dy steps from y; the pixels are those from x on.
void add_window_row(const GuidedPass& pass, const GuideRows& guides, const MapRows& in, int x, int y, int dy,
                    kernels::GuidedSmoothRow& row) {
  const auto& weights = pass.kernel == PassKernel::kBox ? kBoxWeights : kSplineWeights;
  const int source_y = y + dy * pass.step;
  const auto r = static_cast<std::size_t>(row.rows);
  row.around[r] = guides.feature_row(x, source_y);
  for (int m = 0; m < in.count; ++m) row.map[r][m] = in.row(m, source_y) + x;
  if (in.inverse_count >= 0) row.inverse_count[r] = in.row(in.inverse_count, source_y) + x;
  for (std::size_t t = 0; t < weights.size(); ++t) {
    row.spatial[r][t] = weights[t] * weights.at(static_cast<std::size_t>(dy + GuidedPass::kRadius));
  }
  ++row.rows;
}

// Sum of squares of the weights of a chain of passes along an axis.
double sum_of_squares(const std::vector<double>& kernel) {
  double sum = 0;
  for (const double w : kernel) sum += w * w;
  return sum;
}

// The chain's weights along an axis after one more pass.
std::vector<double> convolved(const std::vector<double>& chain, const std::array<float, kernels::kWindow>& weights,
                              int step) {
  const auto s = static_cast<std::size_t>(step);
  std::vector<double> out(chain.size() + (weights.size() - 1) * s, 0.0);
  double total = 0;
  for (const float w : weights) total += w;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    for (std::size_t t = 0; t < weights.size(); ++t) out[i + t * s] += chain[i] * weights[t] / total;
  }
  return out;
}

}  // namespace

std::vector<float> overlap_factors(PassKernel kernel, const std::vector<int>& steps) {
  const auto& weights = kernel == PassKernel::kBox ? kBoxWeights : kSplineWeights;
  const double independent = sum_of_squares(convolved({1.0}, weights, 1));
  std::vector<float> factors;
  std::vector<double> chain = {1.0};
  for (const int step : steps) {
    const double before = sum_of_squares(chain);
    chain = convolved(chain, weights, step);
    const double along_axis = sum_of_squares(chain) / (before * independent);
    factors.push_back(static_cast<float>(along_axis * along_axis));
  }
  return factors;
}

void run_guided_pass(const GuidedPass& pass, const GuideRows& guides, int image_height, const Rect& tile,
                     const MapRows& in, const MapRows& out) {
  kernels::GuidedSmoothRow row;
  row.maps = in.count;
  row.step = pass.step;
  row.count = tile.width();
  row.overlap = pass.overlap;
  const bool has_count = in.inverse_count >= 0 && out.inverse_count >= 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    row.centre = guides.feature_row(tile.x0, y);
    row.centre.distance_scale = 1.0F / (pass.sigma_scale * pass.sigma_scale);
    for (int m = 0; m < in.count; ++m) {
      row.centre_map[m] = in.row(m, y) + tile.x0;
      row.result[m] = out.row(m, y) + tile.x0;
    }
    if (has_count) {
      row.centre_inverse_count = in.row(in.inverse_count, y) + tile.x0;
      row.inverse_count_result = out.row(out.inverse_count, y) + tile.x0;
    }
    row.rows = 0;
    for (int dy = -GuidedPass::kRadius; dy <= GuidedPass::kRadius; ++dy) {
      const int source_y = y + dy * pass.step;
      if (source_y >= 0 && source_y < image_height) add_window_row(pass, guides, in, tile.x0, y, dy, row);
    }
    kernels::guided_smooth_row(row);
  }
}

}  // namespace stein
