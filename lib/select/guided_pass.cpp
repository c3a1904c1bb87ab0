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
  for (std::size_t t = 0; t < weights.size(); ++t) {
    row.spatial[r][t] = weights[t] * weights.at(static_cast<std::size_t>(dy + GuidedPass::kRadius));
  }
  ++row.rows;
}

}  // namespace

void run_guided_pass(const GuidedPass& pass, const GuideRows& guides, int image_height, const Rect& tile,
                     const MapRows& in, const MapRows& out) {
  kernels::GuidedSmoothRow row;
  row.maps = in.count;
  row.step = pass.step;
  row.count = tile.width();
  for (int y = tile.y0; y < tile.y1; ++y) {
    row.centre = guides.feature_row(tile.x0, y);
    row.centre.distance_scale = 1.0F / (pass.sigma_scale * pass.sigma_scale);
    for (int m = 0; m < in.count; ++m) {
      row.centre_map[m] = in.row(m, y) + tile.x0;
      row.result[m] = out.row(m, y) + tile.x0;
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
