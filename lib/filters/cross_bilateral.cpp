// SPDX-License-Identifier: Apache-2.0
//
// Cross-bilateral bank. SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
//
// Where this differs from the paper: docs/filters/cross_bilateral.md.
//
// symbol        | here                                             | Eq.
// w_ij          | kernels/weights-inl.hpp times ScaleTaps::spatial  | 4
// D(f_i, f_j)   | kernels/weights-inl.hpp, guides from GuideRows    | 6
// F, dF/dc      | kernels/cross_bilateral.cpp                       | 5, 7 (= 13)
#include "kernels/cross_bilateral.hpp"

#include "filters/filter.hpp"
#include "filters/taps.hpp"

namespace stein {
namespace {

class CrossBilateral final : public PreparedFilter {
 public:
  CrossBilateral(const CrossBilateralParams& params, const FilterContext& context)
      : source_(context.source),
        guides_(context.guides),
        layout_(context.tile_width, context.tile_height, stein::halo(params)),
        taps_(params.spatial_sigmas, layout_),
        scales_(static_cast<int>(params.spatial_sigmas.size())),
        inverse_range_variance_(params.range_sigma > 0 ? 1.0F / (params.range_sigma * params.range_sigma) : 0.0F) {}

  [[nodiscard]] int candidates() const noexcept override { return scales_; }

  void run(const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    exec::TilePlanes& planes = scratch.tile;
    const int colour = guides_.planes();
    const int variance = colour + 3;
    planes.reserve(layout_, variance + 3);
    guides_.load(tile, planes);
    load_colour(tile, planes, colour);

    kernels::CrossBilateralRow row;
    row.count = tile.width();
    row.taps = taps_.offsets.data();
    row.tap_count = static_cast<int>(taps_.offsets.size());
    row.first_scale = taps_.first_scale.data();
    row.spatial = taps_.spatial.data();
    row.scales = scales_;
    row.inverse_range_variance = inverse_range_variance_;
    for (int y = 0; y < tile.height(); ++y) {
      row.guides = guides_.tile_row(planes, y);
      for (int c = 0; c < 3; ++c) {
        row.colour[c] = planes.row(colour + c, y);
        row.variance[c] = planes.row(variance + c, y);
        for (int s = 0; s < scales_; ++s) {
          row.result[s][c] = out.result(s, c, tile.y0 + y) + tile.x0;
          row.divergence[s][c] = out.divergence(s, c, tile.y0 + y) + tile.x0;
        }
      }
      kernels::cross_bilateral_row(row);
    }
  }

 private:
  void load_colour(const Rect& tile, exec::TilePlanes& planes, int first_plane) const {
    const Frame& frame = source_.frame();
    load_tile(tile, frame.width, frame.height, planes, first_plane, 3, [&](int y, int x, int n, float* const* rows) {
      for (std::size_t c = 0; c < 3; ++c) source_.colour_row(c, y, x, n, rows[c]);
    });
    for (int y = 0; y < tile.height(); ++y) {
      for (std::size_t c = 0; c < 3; ++c) {
        source_.variance_row(c, tile.y0 + y, tile.x0, tile.width(),
                             planes.row(first_plane + 3 + static_cast<int>(c), y));
      }
    }
  }

  const Source& source_;
  const GuideRows& guides_;
  exec::TileLayout layout_;
  ScaleTaps taps_;
  int scales_;
  float inverse_range_variance_;
};

}  // namespace

int halo(const CrossBilateralParams& params) { return radius_of(params.spatial_sigmas); }

GuideRows make_guides(const CrossBilateralParams& params, const Source& source, int rows) {
  return {source, params.guides, params.range_sigma, rows};
}

std::unique_ptr<PreparedFilter> prepare(const CrossBilateralParams& params, const FilterContext& context) {
  return std::make_unique<CrossBilateral>(params, context);
}

}  // namespace stein
