// SPDX-License-Identifier: Apache-2.0
#include "select/guided_pass.hpp"

#include <array>

#include "kernels/guided_smooth.hpp"

namespace stein {
namespace {

CrossBilateralParams scaled_guides(const CrossBilateralParams& params, float sigma_scale) {
  CrossBilateralParams scaled = params;
  for (FeatureSigma& feature : scaled.feature_sigmas) feature.sigma *= sigma_scale;
  scaled.other_feature_sigma *= sigma_scale;
  return scaled;
}

}  // namespace

GuidedPass::GuidedPass(const Source& source, const CrossBilateralParams& params, float sigma_scale, PassKernel kernel,
                       int step, int tile_width, int tile_height)
    : source_(source),
      guides_(source, scaled_guides(params, sigma_scale), false),
      layout_(tile_width, tile_height, kRadius * step) {
  constexpr std::array<float, 5> kSpline = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};
  const auto weight = [&](int i) {
    return kernel == PassKernel::kBox ? 1.0F : kSpline.at(static_cast<std::size_t>(i + kRadius));
  };
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      taps_.push_back(layout_.offset(dx * step, dy * step));
      spatial_.push_back(weight(dx) * weight(dy));
    }
  }
  while (taps_.size() % kernels::kTapBatch != 0) {  // padding: the pixel itself with factor 0
    taps_.push_back(0);
    spatial_.push_back(0.0F);
  }
}

void GuidedPass::run(const Rect& tile, FilterScratch& scratch, const MapRows& in, const MapRows& out) const {
  const Frame& frame = source_.frame();
  exec::TilePlanes& planes = scratch.tile;
  const int first_map = guides_.planes();
  planes.reserve(layout_, first_map + in.count);
  guides_.load(tile, planes);
  load_tile(tile, frame.width, frame.height, planes, first_map, in.count, [&](int y, int x, int n, float* const* rows) {
    for (int m = 0; m < in.count; ++m) std::copy_n(in.row(m, y) + x, n, rows[m]);
  });

  kernels::GuidedSmoothRow row;
  row.maps = in.count;
  row.count = tile.width();
  row.taps = taps_.data();
  row.spatial = spatial_.data();
  row.tap_count = static_cast<int>(taps_.size());
  for (int y = 0; y < tile.height(); ++y) {
    row.guides = guides_.row(planes, y);
    for (int m = 0; m < in.count; ++m) {
      row.map[m] = planes.row(first_map + m, y);
      row.result[m] = out.row(m, tile.y0 + y) + tile.x0;
    }
    kernels::guided_smooth_row(row);
  }
}

}  // namespace stein
