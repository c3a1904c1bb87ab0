// SPDX-License-Identifier: Apache-2.0
//
// The pictures of several filters and the input, mixed with the weights of least estimated error around each pixel.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/large_array.hpp"
#include "exec/rect.hpp"
#include "exec/runner.hpp"
#include "pipeline/mixture.hpp"
#include "prefilter/layer_source.hpp"
#include "prefilter/source.hpp"
#include "select/mixture_weights.hpp"

namespace stein {

/// Of the whole image.
struct BlendPicture {
  MixtureRows rows;
  bool is_external = false;  ///< can be anything, also of another frame
};

/// Picture 0 is the input, picture k that of pictures[k - 1].
class Blend {
 public:
  /// Estimates the weights: one set for each block of pixels, from the risks around it, as far as they go, and those of
  /// the whole image. `pictures`: external ones last, and not all of them; what they view must outlive this.
  Blend(const Source& source, const LayerSource& layers, const std::vector<BlendPicture>& pictures,
        exec::Runner& runner, double progress_weight);

  /// Mixes the tile's rows of the pictures; weights between the centres of blocks are interpolated. `choice` gets the
  /// picture of largest weight. `lines`: tile.width() floats of scratch for each picture, `pitch` apart.
  void run(const Rect& tile, const Mixture& out, float* lines, std::ptrdiff_t pitch) const;

  [[nodiscard]] int pictures() const noexcept { return count_; }
  /// Mean over the image.
  [[nodiscard]] MixtureWeights mean_weights() const;

 private:
  /// Bits of pictures.
  using Pictures = std::uint32_t;
  struct Risks {
    LargeArray<MixtureRisk> blocks;          // of each, with its surroundings
    std::map<Pictures, MixtureRisk> images;  // of all blocks in which the same pictures are compared
    [[nodiscard]] MixtureRisk of(std::size_t block, Pictures compared) const;
  };
  [[nodiscard]] Risks block_risks(const std::vector<Pictures>& compared, exec::Runner& runner,
                                  double progress_weight) const;
  [[nodiscard]] MixtureRisk block_risk(int column, int row, Pictures compared, float* lines) const;
  void add_externals(const Risks& own_risks, exec::Runner& runner, double progress_weight);
  [[nodiscard]] Pictures plausible(const MixtureRisk& risk, const MixtureWeights& own) const;
  [[nodiscard]] std::size_t row_start(int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  }
  [[nodiscard]] const MixtureWeights& weights(int column, int row) const noexcept;
  void weight_rows(const Rect& tile, int y, float* lines, std::ptrdiff_t pitch) const;

  const Source& source_;
  const LayerSource& layers_;
  std::vector<BlendPicture> pictures_;
  int count_;
  int own_;  // how many of these are the input and the filters' pictures
  int columns_;
  int rows_;
  std::vector<MixtureWeights> weights_;  // per block
};

}  // namespace stein
