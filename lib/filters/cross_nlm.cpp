// SPDX-License-Identifier: Apache-2.0
//
// Cross non-local means bank. SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction",
// 2012.
//
// Where this differs from the paper: docs/filters/cross_nlm.md.
//
// symbol            | here                                           | Eq.
// |c_i+n - c_j+n|^2 | kernels/patch_distance-inl.hpp, of BlurredRows | 10
// D(f_i, f_j)       | kernels/weights-inl.hpp, guides from GuideRows | 6
// w_ij, F, D        | kernels/cross_nlm.cpp                          | 10, 5, 14; Joint SURE Eq. 2
#include "kernels/cross_nlm.hpp"

#include <algorithm>

#include "filters/blurred_rows.hpp"
#include "filters/filter.hpp"
#include "filters/nlm_block.hpp"
#include "filters/nlm_taps.hpp"

namespace stein {
namespace {

int tile_halo(const CrossNlmParams& params) { return params.window_radius + std::max(params.patch_radius, 1); }

class CrossNlm final : public PreparedFilter {
 public:
  CrossNlm(const CrossNlmParams& params, const FilterContext& context)
      : source_(context.source),
        guides_(context.guides),
        layers_(context.layers),
        divergence_(context.divergence),
        layout_(context.tile_width, context.tile_height, tile_halo(params)),
        taps_(nlm_taps({params.window_radius, params.patch_radius}, layout_)) {
    set_window({params.window_radius, params.patch_radius}, taps_, layout_, rows_);
    rows_.blur = params.patch_blur;
    rows_.is_normalised = params.distance == PatchDistance::kVarianceNormalised;
    rows_.has_guide_covariance = divergence_ == Divergence::kJoint && guides_.has_covariance(divergence_);
    // Noise and distance are sums over the channels alike.
    set_range_sigmas(params.range_sigmas, rows_.is_normalised ? 1.0 : 3.0, rows_);
  }

  [[nodiscard]] int candidates() const noexcept override { return rows_.candidates; }

  void run(int /*pass*/, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    exec::TilePlanes& planes = scratch.tile;
    const int colour = guides_.planes();
    const int layer = colour + 3 + kBlurredPlanes;
    planes.reserve(layout_, layer + out.layers());
    guides_.load(tile, planes);
    load_colour(tile, planes, colour);
    if (out.layers() > 0) load_layers(*layers_, tile, source_.frame(), planes, layer);

    kernels::CrossNlmRows rows = rows_;
    rows.layers = scratch.layers.reserve(out.layers(), 1, kernels::kNlmBlockRows * rows.candidates,
                                         kernels::nlm_layer_scratch(rows.candidates, out.layers()));
    rows.count = tile.width();
    const OwnCovariances own(source_, divergence_, layout_, rows.has_guide_covariance ? guides_.channels() : 0);
    float* own_memory = scratch.lines.reserve(own.floats() + kernels::cross_nlm_scratch(rows.candidates));
    rows.scratch = own_memory + own.floats();
    for (int y = 0; y < tile.height(); y += kernels::kNlmBlockRows) {
      rows.rows = std::min(kernels::kNlmBlockRows, tile.height() - y);
      rows.guides = guides_.tile_row(planes, y);
      for (int c = 0; c < 3; ++c) {
        rows.colour[c] = planes.row(colour + c, y);
        rows.blurred[c] = planes.row(colour + 3 + c, y);
      }
      rows.gain = planes.row(colour + 6, y);
      rows.noise = planes.row(colour + 7, y);
      const Rect target{tile.x0, tile.y0 + y, tile.x1, tile.y0 + y + rows.rows};
      own.load(target, own_memory, rows.colour_covariance, rows.guide_covariance, [&](int image_y, float* const* to) {
        guides_.covariance_rows(divergence_, kGuideSlope, image_y, target.x0, target.width(), to);
      });
      set_outputs(target, out, rows.candidates, rows);
      set_layers(target, out, rows.candidates, planes, layer, y, scratch.layers);
      kernels::cross_nlm_rows(rows);
    }
  }

 private:
  void load_colour(const Rect& tile, exec::TilePlanes& planes, int first_plane) const {
    const Frame& frame = source_.frame();
    load_tile(tile, frame.width, frame.height, planes, first_plane, 3 + kBlurredPlanes,
              [&](int y, int x, int n, float* const* rows) {
                for (std::size_t c = 0; c < 3; ++c) source_.colour_row(c, y, x, n, rows[c]);
                blurred_row(source_, rows_.blur, y, x, n, rows + 3);
              });
  }

  const Source& source_;
  const GuideRows& guides_;
  const LayerSource* layers_;
  Divergence divergence_;
  exec::TileLayout layout_;
  std::vector<std::ptrdiff_t> taps_;
  kernels::CrossNlmRows rows_;  // what all tiles share
};

}  // namespace

std::vector<int> halos(const CrossNlmParams& params) { return {tile_halo(params) + kBlurRadius}; }

GuideRows make_guides(const CrossNlmParams& params, const Source& source, int rows) {
  return {source, params.guides, 0.0F, rows};
}

std::unique_ptr<PreparedFilter> prepare(const CrossNlmParams& params, const FilterContext& context) {
  return std::make_unique<CrossNlm>(params, context);
}

}  // namespace stein
