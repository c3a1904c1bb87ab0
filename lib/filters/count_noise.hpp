// SPDX-License-Identifier: Apache-2.0
//
// Pixels of which few samples saw something bright, as on the rim of a lamp: their noise is that of a count. Colour,
// features and the features' variances move with it together, and too far for a derivative.
#pragma once

#include <cstddef>
#include <optional>

#include "filters/guide_rows.hpp"
#include "kernels/guides.hpp"

namespace stein {

/// Where the noise of the mean is that of a count k of equal events, its covariance with a function F is the mean of
/// k q (F(k) - F(k - 1)), q being what one event adds to the mean (the counterpart of Stein's lemma for a Poisson
/// distribution). Joint SURE Eq. 2 has variance times derivative in its place. Of a pixel with brightness m, the mean
/// of its channels, and variance v of that, q is v / m. What of its noise does not go with the brightness stays with
/// the derivative.
///
/// This finds such pixels and what they would be with an event less; filters know what F is then.
class CountNoise {
 public:
  /// Pixels of a row from (x, y) of the image on, in the rows of a tile.
  struct Pixels {
    const kernels::Guides& guides;
    const float* const* colour;
    float* const*
        guide_covariance;  ///< of colour channel c with guide channel k, times kGuideSlope: [c * channels + k]
    float* const* colour_covariance;  ///< RR, GG, BB, RG, RB, GB
    int x = 0;
    int y = 0;
    int count = 0;
  };

  /// Pixels of a row with an event less; each is a row of floats.
  struct Less {
    float* channel[kernels::kMaxGuideChannels];  ///< guides
    float* variance[kernels::kMaxGuideGroups];
    float* colour[3];
    float* likeness;   ///< weight that the pixel as it is would have as a neighbour
    float* factor[3];  ///< D is to have this times F(k) - F(k - 1); 0 where there is no count
    float* samples;
    [[nodiscard]] bool has_count(int i) const {
      return factor[0][i] != 0.0F || factor[1][i] != 0.0F || factor[2][i] != 0.0F;
    }
  };

  /// For rows of at most `width` pixels.
  CountNoise(const Source& source, const GuideRows& guides, int width);

  /// Floats of scratch for a row, aligned to 64 bytes.
  [[nodiscard]] std::size_t floats() const noexcept { return static_cast<std::size_t>(lines_ * pitch_); }
  /// Rows of that many floats in it.
  [[nodiscard]] std::ptrdiff_t pitch() const noexcept { return pitch_; }

  /// Finds pixels whose noise is a count's, if any, and takes it out of their covariances.
  bool split(const Pixels& pixels, float* scratch) const;

  /// What split() left there.
  [[nodiscard]] Less less(float* scratch) const;

 private:
  struct Count;
  [[nodiscard]] static std::optional<Count> count_at(const Pixels& pixels, int i);
  double move_guides(const Pixels& pixels, int i, Count& count, const Less& to) const;
  void take_out(const Pixels& pixels, int i, const Count& count) const;

  const Source& source_;
  const GuideRows& guides_;
  std::ptrdiff_t pitch_;
  std::ptrdiff_t lines_;
};

}  // namespace stein
