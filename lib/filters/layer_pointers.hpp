// SPDX-License-Identifier: Apache-2.0
//
// Kernel arguments for layers, of which there can be any number: lists of pointers that grow once per thread.
#pragma once

#include <cstddef>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "kernels/guides.hpp"
#include "prefilter/layer_source.hpp"

namespace stein {

class CandidateRows;

class LayerPointers {
 public:
  /// Makes room for the values of `rows` rows and the results of `targets` candidates or rows of candidates, for the
  /// channels of each, and for `floats` of scratch.
  kernels::LayerChannels reserve(int channels, int rows, int targets, std::size_t floats);

  void set_value(std::size_t index, const float* row) { values_[index] = row; }
  void set_result(std::size_t index, float* row) { results_[index] = row; }

  /// Points at the channels in a tile's planes, in its row y.
  void set_values(const exec::TilePlanes& planes, int first_plane, int channels, int y);
  /// Points at the candidates' channels in row y from pixel x on, as results from index `first` on.
  void set_results(const CandidateRows& out, int candidates, int x, int y, std::size_t first = 0);

 private:
  std::vector<const float*> values_;
  std::vector<float*> results_;
  exec::FloatBuffer scratch_;
};

/// Fills planes [first_plane, first_plane + channels) of the tile and its halo; 0 outside of the image.
void load_layers(const LayerSource& layers, const Rect& tile, const Frame& frame, exec::TilePlanes& planes,
                 int first_plane);

}  // namespace stein
