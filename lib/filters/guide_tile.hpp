// SPDX-License-Identifier: Apache-2.0
//
// Loads the planes that weights are made of into a tile: the one place where features, sigmas and kernels meet.
#pragma once

#include <algorithm>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "kernels/guides.hpp"
#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein {

/// Which features guide, and how strongly; optionally the colour itself (the range term of SBF Eq. 4).
class GuideSet {
 public:
  GuideSet(const Source& source, const CrossBilateralParams& params, bool with_range_term);

  /// Planes of a tile: guides first, then the mask.
  [[nodiscard]] int planes() const noexcept { return mask_plane() + 1; }
  [[nodiscard]] int mask_plane() const noexcept { return channels_ + static_cast<int>(groups_.size()); }

  /// Fills planes [0, planes()) of the tile and its halo; the mask is 0 outside of the image.
  void load(const Rect& tile, exec::TilePlanes& planes) const;

  /// Kernel arguments for row y of the tile.
  [[nodiscard]] kernels::Guides row(const exec::TilePlanes& planes, int y) const;

 private:
  struct Group {
    int feature = 0;  ///< index into the frame's features; -1: the colour
    int channels = 0;
    float factor =
        0;  ///< to the normalised feature, such that the kernel's squared distance is D^2 / (2 sigma^2) * log2(e)
  };
  void add(int feature, int channels, float sigma);

  const Source& source_;
  std::vector<Group> groups_;
  int channels_ = 0;
  float min_variance_ = 0;
};

/// Clears planes [first, first + count) of the tile and its halo, then calls load(image_y, image_x, n, rows) for each
/// row that lies in the image; it writes n floats, for pixels [image_x, image_x + n), to each of rows[0..count).
template <class Load>
void load_tile(const Rect& tile, int image_width, int image_height, exec::TilePlanes& planes, int first, int count,
               Load load) {
  const int halo = planes.layout().halo;
  const int x0 = std::max(tile.x0 - halo, 0);
  const int x1 = std::min(tile.x1 + halo, image_width);
  const int padded = (tile.width() + 15) / 16 * 16 + halo;
  float* rows[kernels::kMaxGuideChannels];
  for (int y = -halo; y < tile.height() + halo; ++y) {
    const int image_y = tile.y0 + y;
    const bool inside = image_y >= 0 && image_y < image_height;
    for (int k = 0; k < count; ++k) {
      float* row = planes.row(first + k, y);
      rows[k] = row + (x0 - tile.x0);
      if (!inside || x0 > tile.x0 - halo || x1 - tile.x0 < padded) std::fill(row - halo, row + padded, 0.0F);
    }
    if (inside) load(image_y, x0, x1 - x0, rows);
  }
}

}  // namespace stein
