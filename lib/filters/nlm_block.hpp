// SPDX-License-Identifier: Apache-2.0
//
// What a kernel of non-local means needs for a few rows of a tile beside the tile's planes: the covariances of their
// pixels, and where results go.
#pragma once

#include <cstddef>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/filter.hpp"
#include "filters/nlm_taps.hpp"
#include "kernels/cross_nlm.hpp"
#include "prefilter/source.hpp"

namespace stein {

/// Sets what the kernel knows of the window; `taps` are its nlm_taps().
void set_window(const NlmWindow& window, const std::vector<std::ptrdiff_t>& taps, const exec::TileLayout& layout,
                kernels::CrossNlmRows& rows);

/// One candidate per sigma; distances are sums over `channels`.
void set_range_sigmas(const std::vector<float>& sigmas, double channels, kernels::CrossNlmRows& rows);

/// Candidates of the kernel write to the target, at most kNlmBlockRows rows.
void set_outputs(const Rect& target, const CandidateRows& out, int candidates, kernels::CrossNlmRows& rows);

/// The same for layers, which lie in the tile's planes from first_plane on, `y` being the target's row in the tile.
void set_layers(const Rect& target, const CandidateRows& out, int candidates, const exec::TilePlanes& planes,
                int first_plane, int y, LayerPointers& layers);

/// Covariances of the means of the pixels' own colour, and of their colour with further channels, in planes of
/// kNlmBlockRows rows.
class OwnCovariances {
 public:
  static constexpr int kColour = 6;  ///< planes: RR, GG, BB, RG, RB, GB

  OwnCovariances(const Source& source, Divergence divergence, const exec::TileLayout& layout, int channels);

  /// Floats of all planes.
  [[nodiscard]] std::size_t floats() const noexcept { return static_cast<std::size_t>(planes() * plane_stride_); }

  /// Row y of every plane of `memory`: the colour's, then [c * channels + channel].
  void set_rows(float* memory, int y, float** rows) const {
    for (int k = 0; k < planes(); ++k) rows[k] = memory + k * plane_stride_ + y * pitch_;
  }

  /// Fills `memory`, floats() of it, for the rows of the target, and points at it: colour[k], others[c][channel].
  /// load_others(y, rows) writes row y to rows[c * channels + channel], if there are further channels.
  template <std::size_t kMost, class LoadOthers>
  void load(const Rect& target, float* memory, const float* (&colour)[kColour], const float* (&others)[3][kMost],
            LoadOthers load_others) const {
    for (int k = 0; k < kColour; ++k) colour[k] = memory + k * plane_stride_;
    for (int k = kColour; k < planes(); ++k) {
      others[(k - kColour) / channels_][(k - kColour) % channels_] = memory + k * plane_stride_;
    }
    float* rows[kColour + 3 * kMost];
    for (int y = 0; y < target.height(); ++y) {
      set_rows(memory, y, rows);
      load_colour(target, target.y0 + y, rows);
      if (channels_ > 0) load_others(target.y0 + y, rows + kColour);
      pad(target.width(), rows);
    }
  }

 private:
  [[nodiscard]] int planes() const noexcept { return kColour + 3 * channels_; }
  void load_colour(const Rect& target, int y, float* const* rows) const;
  void pad(int count, float* const* rows) const;

  const Source& source_;
  Divergence divergence_;
  int channels_;
  std::ptrdiff_t pitch_;
  std::ptrdiff_t plane_stride_;
};

}  // namespace stein
