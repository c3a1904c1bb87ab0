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
#include <utility>

#include "filters/blurred_rows.hpp"
#include "filters/count_noise.hpp"
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
        taps_(nlm_taps({params.window_radius, params.patch_radius}, layout_)),
        counts_(source_, guides_, layout_.max_width) {
    set_window({params.window_radius, params.patch_radius}, taps_, layout_, rows_);
    rows_.blur = params.patch_blur;
    rows_.is_normalised = params.distance == PatchDistance::kVarianceNormalised;
    rows_.has_guide_covariance = divergence_ == Divergence::kJoint && guides_.has_covariance(divergence_);
    has_counts_ = context.counts && rows_.has_guide_covariance;
    // Noise and distance are sums over the channels alike.
    set_range_sigmas(params.range_sigmas, rows_.is_normalised ? 1.0 : 3.0, rows_);
  }

  [[nodiscard]] int candidates() const noexcept override { return rows_.candidates; }

  // Pixels with much noise are like no other, and keep it with most candidates: their votes are large, and for the few
  // that differ.
  [[nodiscard]] float risk_limit() const noexcept override { return 0.3F; }

  void run(int /*pass*/, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    exec::TilePlanes& planes = scratch.tile;
    const int colour = colour_plane();
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
    const std::size_t count_floats = has_counts_ ? kernels::kNlmBlockRows * counts_.floats() : 0;
    float* own_memory =
        scratch.lines.reserve(own.floats() + count_floats + kernels::cross_nlm_scratch(rows.candidates));
    float* const counts = own_memory + own.floats();
    rows.scratch = counts + count_floats;
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
      const unsigned counted = has_counts_ ? split_counts(target, own, own_memory, rows, counts) : 0;
      kernels::cross_nlm_rows(rows);
      for (int row = 0; counted >> row != 0; ++row) {
        if ((counted >> row & 1U) != 0) add_counts(rows, row, counts, planes, y + row);
      }
    }
  }

 private:
  void load_colour(const Rect& tile, exec::TilePlanes& planes, int first_plane) const {
    const Frame& frame = source_.frame();
    load_tile(tile, frame.width, frame.height, planes, first_plane, 3 + kBlurredPlanes,
              [&](int y, int x, int n, float* const* rows) {
                source_.colour_rows(y, x, n, rows);
                blurred_row(source_, rows_.blur, y, x, n, rows + 3);
              });
  }

  [[nodiscard]] int colour_plane() const noexcept { return guides_.planes(); }

  // Bit y tells whether row y of the block has pixels whose noise is a count's.
  unsigned split_counts(const Rect& target, const OwnCovariances& own, float* own_memory,
                        const kernels::CrossNlmRows& rows, float* counts) const {
    unsigned counted = 0;
    for (int y = 0; y < rows.rows; ++y) {
      float* covariances[OwnCovariances::kColour + 3 * kernels::kMaxGuideChannels];
      own.set_rows(own_memory, y, covariances);
      kernels::Guides guides = rows.guides;
      for (int k = 0; k < guides_.channels(); ++k) guides.channel[k] += y * rows.pitch;
      for (int g = 0; g < guides_.groups(); ++g) guides.variance[g] += y * rows.pitch;
      const float* colour[3];
      for (int c = 0; c < 3; ++c) colour[c] = rows.colour[c] + y * rows.pitch;
      const CountNoise::Pixels pixels{
          guides, colour, covariances + OwnCovariances::kColour, covariances, target.x0, target.y0 + y, rows.count};
      if (counts_.split(pixels, counts + static_cast<std::size_t>(y) * counts_.floats())) counted |= 1U << y;
    }
    return counted;
  }

  // Adds the counts' part to the divergences of a row whose pixels were split, and filtered.
  void add_counts(const kernels::CrossNlmRows& rows, int row, float* counts, const exec::TilePlanes& planes,
                  int tile_y) const {
    const CountNoise::Less less = counts_.less(counts + static_cast<std::size_t>(row) * counts_.floats());
    for (int x = 0; x < rows.count; ++x) {
      if (!less.has_count(x)) continue;
      float F[kernels::kMaxRangeSigmas][3];
      {
        TileEdit edit;
        put_less(less, x, tile_y, planes, edit);
        kernels::cross_nlm_pixel(rows, x + row * rows.pitch, F);
      }
      for (int s = 0; s < rows.candidates; ++s) {
        for (int c = 0; c < 3; ++c)
          rows.divergence[row][s][c][x] += less.factor[c][x] * (rows.result[row][s][c][x] - F[s][c]);
      }
    }
  }

  // Values of a tile that are others for a while.
  class TileEdit {
   public:
    TileEdit() = default;
    TileEdit(const TileEdit&) = delete;
    TileEdit& operator=(const TileEdit&) = delete;
    ~TileEdit() {
      for (int i = 0; i < count_; ++i) *where_[i] = was_[i];
    }
    void set(float* where, float value) {
      where_[count_] = where;
      was_[count_++] = std::exchange(*where, value);
    }

   private:
    static constexpr int kMost = kernels::kMaxGuideChannels + kernels::kMaxGuideGroups + 3 + 27;
    float* where_[kMost];
    float was_[kMost];
    int count_ = 0;
  };

  // Guides and colour of a pixel with an event less, and the blurred colours that it is part of. The noise of those
  // stays, as it does for the derivative.
  void put_less(const CountNoise::Less& less, int x, int y, const exec::TilePlanes& planes, TileEdit& edit) const {
    int plane = 0;
    for (int k = 0; k < guides_.channels(); ++k) edit.set(planes.row(plane++, y) + x, less.channel[k][x]);
    for (int g = 0; g < guides_.groups(); ++g) edit.set(planes.row(plane++, y) + x, less.variance[g][x]);
    const int colour = colour_plane();
    for (int c = 0; c < 3; ++c) {
      float* const own = planes.row(colour + c, y) + x;
      const float change = less.colour[c][x] - *own;
      edit.set(own, less.colour[c][x]);
      for (int dy = -kBlurRadius; dy <= kBlurRadius; ++dy) {
        for (int dx = -kBlurRadius; dx <= kBlurRadius; ++dx) {
          const float weight = (dx == 0 ? 1.0F : rows_.blur) * (dy == 0 ? 1.0F : rows_.blur);
          const float gain = planes.row(colour + 6, y + dy)[x + dx];
          float* const blurred = planes.row(colour + 3 + c, y + dy) + x + dx;
          edit.set(blurred, *blurred + gain * weight * change);
        }
      }
    }
  }

  const Source& source_;
  const GuideRows& guides_;
  const LayerSource* layers_;
  Divergence divergence_;
  exec::TileLayout layout_;
  std::vector<std::ptrdiff_t> taps_;
  CountNoise counts_;
  bool has_counts_ = false;
  kernels::CrossNlmRows rows_;  // what all tiles share
};

}  // namespace

std::vector<int> halos(const CrossNlmParams& params) { return {tile_halo(params) + kBlurRadius}; }

GuideRows make_guides(const CrossNlmParams& params, const Source& source, const GuideWindow& window) {
  return {source, params.guides, 0.0F, window};
}

std::unique_ptr<PreparedFilter> prepare(const CrossNlmParams& params, const FilterContext& context) {
  return std::make_unique<CrossNlm>(params, context);
}

}  // namespace stein
