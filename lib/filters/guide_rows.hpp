// SPDX-License-Identifier: Apache-2.0
//
// The planes that weights are made of, prepared once per row and shared by the filter and the smoothing of its risk:
// the one place where features, sigmas and kernels meet.
#pragma once

#include <algorithm>
#include <numbers>
#include <optional>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/feature_smoother.hpp"
#include "kernels/guides.hpp"
#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein {

/// -dw/df over w, for a weight w = 2^-d of the kernels' Guides, is this times (f_i - f_j) / V.
inline constexpr float kGuideSlope = static_cast<float>(2.0 * std::numbers::ln2);

/// What the divergence of a filter accounts for.
enum class Divergence {
  kPlain,  ///< each colour channel's own noise (SBF Eq. 2)
  kJoint,  ///< also the covariances with the other channels and with the features (Joint SURE Eq. 2)
};

/// How many rows are kept, and how large tiles are at most.
struct GuideWindow {
  int rows = 0;
  int tile_width = 0;
  int tile_height = 0;
};

class GuideRows {
 public:
  /// The frame's features guide as `guides` says, and the colour if range_sigma > 0 (SBF Eq. 4).
  GuideRows(const Source& source, const FeatureGuides& guides, float range_sigma, const GuideWindow& window);

  /// Pixels around a tile that its guides depend on.
  [[nodiscard]] static int halo(const FeatureGuides& guides);

  /// Fills the tile's pixels.
  void prepare(const Rect& tile, exec::TileScratch& scratch) const;

  /// Planes of a tile: guides first, then the mask.
  [[nodiscard]] int planes() const noexcept { return mask_plane() + 1; }
  /// Copies planes [0, planes()) of the tile and its halo; the mask is 0 outside of the image.
  void load(const Rect& tile, exec::TilePlanes& planes) const;

  /// Number of guide channels, the range term's included.
  [[nodiscard]] int channels() const noexcept { return channels_; }
  /// Groups of channels with a variance of their own, as in the kernels' Guides.
  [[nodiscard]] int groups() const noexcept { return static_cast<int>(groups_.size()); }
  /// Variance of the mean of group g, the sum over its channels in the units of the kernels' Guides, of a pixel of so
  /// many samples whose variance is `variance`; 0 for the range term, which has none.
  [[nodiscard]] double variance_of_mean(int g, double variance, double samples) const noexcept;
  /// Whether any guide moves with the colour's noise.
  [[nodiscard]] bool has_covariance(Divergence divergence) const noexcept;
  /// Covariances of the mean of colour channel c with guide channel k, for pixels [x, x + count) of row y, to
  /// rows[c * channels() + k]; in the units of the kernels' Guides, times `factor`.
  void covariance_rows(Divergence divergence, float factor, int y, int x, int count, float* const* rows) const;

  /// Kernel arguments for row y of a loaded tile, range term included.
  [[nodiscard]] kernels::Guides tile_row(const exec::TilePlanes& planes, int y) const;
  /// Kernel arguments for pixel (x, y) of the image in place, features only; RowRing::kPadding pixels beyond either
  /// side of the image may be read and have mask 0.
  [[nodiscard]] kernels::Guides feature_row(int x, int y) const;

 private:
  struct Group {
    int feature = 0;  ///< index into the frame's features; -1: the colour
    int channels = 0;
    float factor = 0;  ///< to the normalised feature, such that the kernel's distance is D^2 / (2 sigma^2) * log2(e)
  };
  void add(int feature, int channels, float sigma);
  void prepare_feature(int g, int first_channel, const Rect& tile, exec::TileScratch& scratch) const;
  void prepare_colour(const Group& group, int first_channel, const Rect& tile) const;
  [[nodiscard]] int mask_plane() const noexcept { return channels_ + static_cast<int>(groups_.size()); }
  template <class Row>
  [[nodiscard]] kernels::Guides arguments(std::size_t groups, Row row) const;

  const Source& source_;
  std::vector<Group> groups_;
  std::size_t feature_groups_ = 0;  ///< the first of groups_; the colour comes last
  int channels_ = 0;
  float min_variance_ = 0;
  std::optional<FeatureSmoother> smoother_;
  exec::RowRing ring_;
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
  float* rows[kernels::kMaxGuideChannels + kernels::kMaxGuideGroups + 1];
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
