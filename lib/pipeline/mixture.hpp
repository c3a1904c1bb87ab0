// SPDX-License-Identifier: Apache-2.0
//
// What a filter makes of the frame once its candidates are mixed.
#pragma once

#include <functional>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "prefilter/layer_source.hpp"
#include "prefilter/source.hpp"
#include "stein/plane.hpp"

namespace stein {

/// Planes of a row window, or of the whole image where the window is as high: F.R, F.G, F.B, D.R, D.G, D.B, the
/// channels of the layers, and the optimism.
class MixtureRows {
 public:
  /// How many the window has.
  static constexpr int planes(int layer_channels) noexcept { return kLayers + layer_channels + 1; }
  explicit MixtureRows(const exec::RowRing& rows) : rows_(&rows) {}

  /// By their index in the order above.
  [[nodiscard]] float* plane(int index, int y) const noexcept { return rows_->row(index, y); }
  /// The filtered colour.
  [[nodiscard]] float* result(int channel, int y) const noexcept { return plane(channel, y); }
  /// Its divergence term, as CandidateRows::divergence.
  [[nodiscard]] float* divergence(int channel, int y) const noexcept { return plane(kDivergences + channel, y); }
  /// A filtered channel of the layers.
  [[nodiscard]] float* layer(int channel, int y) const noexcept { return plane(kLayers + channel, y); }
  /// By how much the relative risk of F is too low as F was chosen by it (optimism_row); not part of D.
  [[nodiscard]] float* optimism(int y) const noexcept { return plane(rows_->planes() - 1, y); }

  static constexpr int kDivergences = 3;
  static constexpr int kLayers = 6;

 private:
  const exec::RowRing* rows_;
};

/// Where a mixture goes: the rows, and the index of the entry of largest weight.
struct Mixture {
  MixtureRows rows;
  Plane* choice = nullptr;
};

/// For given weights F and D of a mixture are the mixtures of F and D, and so are layers. The optimism is not touched.
/// Entry 0 is the input; of entry k + 1 `entry(k, plane)` has the tile's row of a plane of MixtureRows. `weights`: of
/// each entry, from the tile's first pixel on.
void mix_row(const Source& source, const LayerSource& layers,
             const std::function<const float*(int k, int plane)>& entry, const float* const* weights, int entries,
             const Rect& tile, int y, const MixtureRows& out);

}  // namespace stein
