// SPDX-License-Identifier: Apache-2.0
#include "pipeline/layers.hpp"

#include <algorithm>
#include <string>

namespace stein {

std::string plane_name(const FilteredLayer& layer, std::size_t channel) {
  return plane_name(Layer{layer.name, std::vector<ConstPlaneView>(layer.mean.size())}, channel);
}

std::vector<FilteredLayer> allocate_layers(const Frame& frame, Memory* memory) {
  std::vector<FilteredLayer> layers;
  for (const Layer& layer : frame.layers) {
    layers.push_back({layer.name, {}});
    for (std::size_t c = 0; c < layer.mean.size(); ++c)
      layers.back().mean.emplace_back(frame.width, frame.height, memory);
  }
  return layers;
}

void warn_of_layers(const Frame& frame, DenoiseReport& report) {
  for (std::size_t l = 0; l < frame.layers.size(); ++l) {
    const std::int64_t bad = report.frame.bad_layer_pixels[l];
    if (bad == 0) continue;
    report.warnings.push_back(
        "layer '" + frame.layers[l].name + "' is unusable at " + std::to_string(bad) +
        " pixels where the colour is not, the first in plane '" + report.frame.first_bad_layer[l].plane + "' at (" +
        std::to_string(report.frame.first_bad_layer[l].x) + ", " + std::to_string(report.frame.first_bad_layer[l].y) +
        "); it was filled from its neighbours: near them the layers need not add up to the colour");
  }
}

void finish_layers_row(const LayerSource& layers, const OutlierEnergy& energy, const MixtureRows& filtered,
                       float strength, const Rect& tile, int y, float* line, std::vector<FilteredLayer>& out) {
  const int n = tile.width();
  int channel = 0;
  for (FilteredLayer& layer : out) {
    for (Plane& plane : layer.mean) {
      layers.input_row(channel, y, tile.x0, n, line);
      const float* F = filtered.layer(channel, y) + tile.x0;
      float* result = plane.row(y) + tile.x0;
      for (int i = 0; i < n; ++i) result[i] = strength * F[i] + (1.0F - strength) * line[i];
      energy.add_layer(channel, y, tile.x0, n, strength, result);
      ++channel;
    }
  }
}

}  // namespace stein
