// SPDX-License-Identifier: Apache-2.0
#include "filters/layer_pointers.hpp"

#include <algorithm>

#include "filters/filter.hpp"
#include "filters/guide_rows.hpp"

namespace stein {

kernels::LayerChannels LayerPointers::reserve(int channels, int rows, int targets, std::size_t floats) {
  values_.resize(std::max(values_.size(), static_cast<std::size_t>(rows * channels)));
  results_.resize(std::max(results_.size(), static_cast<std::size_t>(targets * channels)));
  return {channels, values_.data(), results_.data(), scratch_.reserve(floats)};
}

void LayerPointers::set_values(const exec::TilePlanes& planes, int first_plane, int channels, int y) {
  for (int k = 0; k < channels; ++k) values_[static_cast<std::size_t>(k)] = planes.row(first_plane + k, y);
}

void LayerPointers::set_results(const CandidateRows& out, int candidates, int x, int y, std::size_t first) {
  for (int s = 0; s < candidates; ++s) {
    for (int k = 0; k < out.layers(); ++k) results_[first++] = out.layer(s, k, y) + x;
  }
}

void load_layers(const LayerSource& layers, const Rect& tile, const Frame& frame, exec::TilePlanes& planes,
                 int first_plane) {
  for (int k = 0; k < layers.channels(); ++k) {
    load_tile(tile, frame.width, frame.height, planes, first_plane + k, 1,
              [&](int y, int x, int n, float* const* rows) { layers.row(k, y, x, n, rows[0]); });
  }
}

}  // namespace stein
