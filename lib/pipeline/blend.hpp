// SPDX-License-Identifier: Apache-2.0
//
// The pictures of several filters and the input, mixed with the weights of least estimated error around each pixel.
#pragma once

#include <array>
#include <vector>

#include "exec/rect.hpp"
#include "exec/runner.hpp"
#include "pipeline/mixture.hpp"
#include "prefilter/layer_source.hpp"
#include "prefilter/source.hpp"
#include "select/mixture_weights.hpp"

namespace stein {

/// Picture 0 is the input, picture k that of filter k - 1.
class Blend {
 public:
  /// Estimates the weights: one set for each block of pixels, from the risks around it, as far as they go, and those of
  /// the whole image. `pictures`: of the whole image; they must outlive this. The first `trusted` of them say what
  /// errors are relative to, and where variances cannot be right; the others can be anything.
  Blend(const Source& source, const LayerSource& layers, const std::vector<MixtureRows>& pictures, int trusted,
        exec::Runner& runner, double progress_weight);

  /// Mixes the tile's rows of the pictures; weights between the centres of blocks are interpolated. `choice` gets the
  /// picture of largest weight. `lines`: tile.width() floats of scratch for each picture, `pitch` apart.
  void run(const Rect& tile, const Mixture& out, float* lines, std::ptrdiff_t pitch) const;

  [[nodiscard]] int pictures() const noexcept { return count_; }
  /// Mean over the image.
  [[nodiscard]] MixtureWeights mean_weights() const;

 private:
  [[nodiscard]] MixtureRisk block_risk(int column, int row, float* lines) const;
  [[nodiscard]] const MixtureWeights& weights(int column, int row) const noexcept;
  void weight_rows(const Rect& tile, int y, float* lines, std::ptrdiff_t pitch) const;

  const Source& source_;
  const LayerSource& layers_;
  std::vector<MixtureRows> pictures_;
  int count_;
  int trusted_;
  int columns_;
  int rows_;
  std::vector<MixtureWeights> weights_;  // per block
};

}  // namespace stein
