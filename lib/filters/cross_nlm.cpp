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
#include <cmath>
#include <numbers>

#include "filters/blurred_rows.hpp"
#include "filters/filter.hpp"
#include "filters/nlm_taps.hpp"

namespace stein {
namespace {

constexpr double kLog2E = std::numbers::log2e;
constexpr float kSlope = static_cast<float>(2.0 * std::numbers::ln2);  // see CrossBilateralRow::covariance

int tile_halo(const CrossNlmParams& params) { return params.window_radius + std::max(params.patch_radius, 1); }

class CrossNlm final : public PreparedFilter {
 public:
  CrossNlm(const CrossNlmParams& params, const FilterContext& context)
      : source_(context.source),
        guides_(context.guides),
        divergence_(context.divergence),
        layout_(context.tile_width, context.tile_height, tile_halo(params)),
        taps_(nlm_taps({params.window_radius, params.patch_radius}, layout_)) {
    rows_.taps = taps_.data();
    rows_.tap_count = (2 * params.window_radius + 1) * (2 * params.window_radius + 1);
    rows_.near_radius = near_radius({params.window_radius, params.patch_radius});
    rows_.pitch = layout_.pitch;
    rows_.patch_radius = params.patch_radius;
    rows_.window_radius = params.window_radius;
    rows_.blur = params.patch_blur;
    rows_.is_normalised = params.distance == PatchDistance::kVarianceNormalised;
    rows_.has_guide_covariance = divergence_ == Divergence::kJoint && guides_.has_covariance(divergence_);
    rows_.candidates = static_cast<int>(params.range_sigmas.size());
    const double channels = rows_.is_normalised ? 1.0 : 3.0;  // noise and distance are sums over the channels alike
    for (std::size_t s = 0; s < params.range_sigmas.size(); ++s) {
      const double sigma = params.range_sigmas[s];
      rows_.exponent[s] = static_cast<float>(kLog2E / (2.0 * sigma * sigma * channels));
      rows_.slope[s] = static_cast<float>(1.0 / (sigma * sigma * channels));
    }
  }

  [[nodiscard]] int candidates() const noexcept override { return rows_.candidates; }

  void run(int /*pass*/, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    exec::TilePlanes& planes = scratch.tile;
    const int colour = guides_.planes();
    planes.reserve(layout_, colour + 3 + kBlurredPlanes);
    guides_.load(tile, planes);
    load_colour(tile, planes, colour);

    kernels::CrossNlmRows rows = rows_;
    rows.count = tile.width();
    const std::size_t own_floats = own_planes() * plane_floats();
    float* own = scratch.lines.reserve(own_floats + kernels::cross_nlm_scratch(rows.candidates));
    rows.scratch = own + own_floats;
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
      load_own(target, own, rows);
      set_outputs(target, out, rows);
      kernels::cross_nlm_rows(rows);
    }
  }

 private:
  // Planes of the pixels' own covariances: six of the colour, then those with the guides.
  [[nodiscard]] std::size_t own_planes() const {
    return 6 + (rows_.has_guide_covariance ? 3 * static_cast<std::size_t>(guides_.channels()) : 0);
  }
  [[nodiscard]] std::size_t plane_floats() const {  // one line more: planes do not share cache sets
    return static_cast<std::size_t>(layout_.pitch) * kernels::kNlmBlockRows + kernels::kMaxLanes;
  }

  void load_colour(const Rect& tile, exec::TilePlanes& planes, int first_plane) const {
    const Frame& frame = source_.frame();
    load_tile(tile, frame.width, frame.height, planes, first_plane, 3 + kBlurredPlanes,
              [&](int y, int x, int n, float* const* rows) {
                for (std::size_t c = 0; c < 3; ++c) source_.colour_row(c, y, x, n, rows[c]);
                blurred_row(source_, rows_.blur, y, x, n, rows + 3);
              });
  }

  static void set_outputs(const Rect& target, const CandidateRows& out, kernels::CrossNlmRows& rows) {
    for (int y = 0; y < target.height(); ++y) {
      for (int s = 0; s < rows.candidates; ++s) {
        for (int c = 0; c < 3; ++c) {
          rows.result[y][s][c] = out.result(s, c, target.y0 + y) + target.x0;
          rows.divergence[y][s][c] = out.divergence(s, c, target.y0 + y) + target.x0;
        }
      }
    }
  }

  void load_own(const Rect& target, float* first, kernels::CrossNlmRows& rows) const {
    const auto channels = static_cast<std::size_t>(guides_.channels());
    for (std::size_t k = 0; k < own_planes(); ++k) {
      const float*& plane =
          k < 6 ? rows.colour_covariance[k] : rows.guide_covariance[(k - 6) / channels][(k - 6) % channels];
      plane = first + k * plane_floats();
    }
    constexpr std::size_t kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    const int n = target.width();
    const int tail = (kernels::kMaxLanes - n % kernels::kMaxLanes) % kernels::kMaxLanes;
    for (int y = 0; y < target.height(); ++y) {
      const int image_y = target.y0 + y;
      const auto row = [&](std::size_t k) { return first + k * plane_floats() + y * layout_.pitch; };
      for (std::size_t k = 0; k < 6; ++k) {
        if (k < 3 || divergence_ == Divergence::kJoint) {
          source_.colour_covariance_row(kPairs[k][0], kPairs[k][1], image_y, target.x0, n, row(k));
        } else {
          std::fill_n(row(k), n, 0.0F);
        }
      }
      float* guide_rows[3 * kernels::kMaxGuideChannels];
      for (std::size_t k = 6; k < own_planes(); ++k) guide_rows[k - 6] = row(k);
      if (rows.has_guide_covariance) {
        guides_.covariance_rows(divergence_, kSlope, image_y, target.x0, n, guide_rows);
      }
      for (std::size_t k = 0; k < own_planes(); ++k) std::fill_n(row(k) + n, tail, 0.0F);
    }
  }

  const Source& source_;
  const GuideRows& guides_;
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
