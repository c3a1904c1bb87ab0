// SPDX-License-Identifier: Apache-2.0
#include "filters/nlm_block.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stein {

void set_window(const NlmWindow& window, const std::vector<std::ptrdiff_t>& taps, const exec::TileLayout& layout,
                kernels::CrossNlmRows& rows) {
  rows.taps = taps.data();
  rows.tap_count = (2 * window.radius + 1) * (2 * window.radius + 1);
  rows.near_radius = near_radius(window);
  rows.pitch = layout.pitch;
  rows.patch_radius = window.patch_radius;
  rows.window_radius = window.radius;
}

void set_range_sigmas(const std::vector<float>& sigmas, double channels, kernels::CrossNlmRows& rows) {
  rows.candidates = static_cast<int>(sigmas.size());
  for (std::size_t s = 0; s < sigmas.size(); ++s) {
    const double sigma = sigmas[s];
    rows.exponent[s] = static_cast<float>(std::numbers::log2e / (2.0 * sigma * sigma * channels));
    rows.slope[s] = static_cast<float>(1.0 / (sigma * sigma * channels));
  }
  constexpr int kMostSquares = 8;  // one after the other: each doubles the rounding error
  int squares = 0;
  for (std::size_t s = sigmas.size() - 1; s-- > 0;) {
    const float twice = 2.0F * rows.exponent[s + 1];
    rows.is_square[s] = squares < kMostSquares && std::abs(rows.exponent[s] - twice) < 1e-6F * twice;
    squares = rows.is_square[s] ? squares + 1 : 0;
  }
}

void set_outputs(const Rect& target, const CandidateRows& out, int candidates, kernels::CrossNlmRows& rows) {
  for (int y = 0; y < target.height(); ++y) {
    for (int s = 0; s < candidates; ++s) {
      for (int c = 0; c < 3; ++c) {
        rows.result[y][s][c] = out.result(s, c, target.y0 + y) + target.x0;
        rows.divergence[y][s][c] = out.divergence(s, c, target.y0 + y) + target.x0;
      }
    }
  }
}

void set_layers(const Rect& target, const CandidateRows& out, int candidates, const exec::TilePlanes& planes,
                int first_plane, int y, LayerPointers& layers) {
  layers.set_values(planes, first_plane, out.layers(), y);
  for (int row = 0; row < target.height(); ++row) {
    const int first = row * candidates * out.layers();
    layers.set_results(out, candidates, target.x0, target.y0 + row, static_cast<std::size_t>(first));
  }
}

OwnCovariances::OwnCovariances(const Source& source, Divergence divergence, const exec::TileLayout& layout,
                               int channels)
    : source_(source),
      divergence_(divergence),
      channels_(channels),
      pitch_(layout.pitch),
      plane_stride_(layout.pitch * kernels::kNlmBlockRows + kernels::kMaxLanes) {}  // planes do not share cache sets

void OwnCovariances::load_colour(const Rect& target, int y, float* const* rows) const {
  constexpr std::size_t kPairs[kColour][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < kColour; ++k) {
    if (k < 3 || divergence_ == Divergence::kJoint) {
      source_.colour_covariance_row(kPairs[k][0], kPairs[k][1], y, target.x0, target.width(), rows[k]);
    } else {
      std::fill_n(rows[k], target.width(), 0.0F);
    }
  }
}

// Kernels read whole vectors.
void OwnCovariances::pad(int count, float* const* rows) const {
  const int tail = (kernels::kMaxLanes - count % kernels::kMaxLanes) % kernels::kMaxLanes;
  for (int k = 0; k < planes(); ++k) std::fill_n(rows[k] + count, tail, 0.0F);
}

}  // namespace stein
