// SPDX-License-Identifier: Apache-2.0
#include "pipeline/mixture.hpp"

namespace stein {
namespace {

void input_row(const Source& source, const LayerSource& layers, int plane, int y, int x, int count, float* out) {
  if (plane < MixtureRows::kDivergences) {
    source.colour_row(static_cast<std::size_t>(plane), y, x, count, out);
  } else if (plane < MixtureRows::kLayers) {
    const auto channel = static_cast<std::size_t>(plane - MixtureRows::kDivergences);
    source.colour_covariance_row(channel, channel, y, x, count, out);
  } else {
    layers.row(plane - MixtureRows::kLayers, y, x, count, out);
  }
}

}  // namespace

void mix_row(const Source& source, const LayerSource& layers,
             const std::function<const float*(int k, int plane)>& entry, const float* const* weights, int entries,
             const Rect& tile, int y, const MixtureRows& out) {
  const int n = tile.width();
  for (int plane = 0; plane < MixtureRows::kLayers + layers.channels(); ++plane) {
    float* sum = out.plane(plane, y) + tile.x0;
    input_row(source, layers, plane, y, tile.x0, n, sum);
    for (int i = 0; i < n; ++i) sum[i] *= weights[0][i];
    for (int k = 0; k + 1 < entries; ++k) {
      const float* value = entry(k, plane);
      const float* w = weights[k + 1];
      for (int i = 0; i < n; ++i) sum[i] += w[i] * value[i];
    }
  }
}

}  // namespace stein
