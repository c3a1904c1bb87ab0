// SPDX-License-Identifier: Apache-2.0
//
// Pixels of which few samples saw something bright, as on the rim of a lamp: their noise is that of a count. Colour,
// features and the features' variances move with it together, and too far for a derivative.
#pragma once

#include <cstddef>
#include <optional>

#include "filters/guide_rows.hpp"
#include "kernels/cross_bilateral.hpp"

namespace stein {

/// The count's part of the divergence of a cross-bilateral bank.
///
/// Where the noise of the mean is that of a count k of equal events, its covariance with a function F is the mean of
/// k q (F(k) - F(k - 1)), q being what one event adds to the mean (the counterpart of Stein's lemma for a Poisson
/// distribution). Joint SURE Eq. 2 has variance times derivative in its place. Of a pixel with brightness m, the mean
/// of its channels, and variance v of that, q is v / m. What of its noise does not go with the brightness stays with
/// the derivative.
class CountNoise {
 public:
  /// Colour and features of the pixels to look at: guides and colour as in the kernel's row, from (x, y) of the image.
  struct Pixels {
    const kernels::CrossBilateralRow& row;
    int x = 0;
    int y = 0;
    float* const* covariance;  ///< as CrossBilateralRow::covariance, [c * channels + k]
    float* const* variance;    ///< as CrossBilateralRow::variance
  };

  CountNoise(const Source& source, const GuideRows& guides, int width, int scales);

  /// Floats of scratch, aligned to 64 bytes.
  [[nodiscard]] std::size_t floats() const noexcept { return static_cast<std::size_t>(lines_ * pitch_); }

  /// Finds pixels whose noise is a count's, if any, and takes it out of their covariances and variances.
  bool split(const Pixels& pixels, float* scratch) const;

  /// Adds the count's part to the divergences of a row whose pixels were split, and filtered.
  void add(const kernels::CrossBilateralRow& row, float* scratch) const;

 private:
  struct Lines;
  struct Count;
  [[nodiscard]] Lines lines(float* scratch) const;
  [[nodiscard]] static std::optional<Count> count_at(const Pixels& pixels, const Lines& lines, int i);
  double move_guides(const Pixels& pixels, int i, Count& count, const Lines& to) const;
  void take_out(const Pixels& pixels, int i, const Count& count) const;
  void add_block(const kernels::CrossBilateralRow& row, const Lines& lines, int begin) const;

  const Source& source_;
  const GuideRows& guides_;
  int scales_;
  std::ptrdiff_t pitch_;
  std::ptrdiff_t lines_;
};

}  // namespace stein
