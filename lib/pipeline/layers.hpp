// SPDX-License-Identifier: Apache-2.0
//
// Layers in the result: mixed with the weights that were chosen for the colour.
#pragma once

#include <vector>

#include "exec/rect.hpp"
#include "pipeline/mixture.hpp"
#include "prefilter/layer_source.hpp"
#include "prefilter/outlier_energy.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// Planes for the layers of the frame.
[[nodiscard]] std::vector<FilteredLayer> allocate_layers(const Frame& frame, Memory* memory);

/// Warns of each layer that had to be filled where the colour is usable.
void warn_of_layers(const Frame& frame, DenoiseReport& report);

/// The result: `filtered` and what outliers lost as far as `strength` goes, and the input. `line`: scratch as wide as
/// the tile.
void finish_layers_row(const LayerSource& layers, const OutlierEnergy& energy, const MixtureRows& filtered,
                       float strength, const Rect& tile, int y, float* line, std::vector<FilteredLayer>& out);

}  // namespace stein
