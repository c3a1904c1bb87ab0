// SPDX-License-Identifier: Apache-2.0
#include "prefilter/layer_source.hpp"

namespace stein {

LayerSource::LayerSource(const Frame& frame, const FrameReport& report, const Source& source)
    : source_(source), filled_(frame.layers.size()) {
  for (std::size_t l = 0; l < frame.layers.size(); ++l) {
    const Layer& layer = frame.layers[l];
    const bool is_light = layer.mean.size() == 3;
    for (std::size_t c = 0; c < layer.mean.size(); ++c) {
      channels_.push_back({layer.mean[c], l, c});
      colours_.push_back(is_light ? static_cast<int>(c) : -1);
    }
    if (report.invalid_pixels > 0 || report.bad_layer_pixels[l] > 0)
      filled_[l].add(fill_layer(frame, layer, source.memory()), frame.height);
  }
}

void LayerSource::row(int channel, int y, int x, int count, float* out) const {
  const Channel& from = channels_[static_cast<std::size_t>(channel)];
  from.plane.read_row(y, x, count, out);
  if (colours_[static_cast<std::size_t>(channel)] >= 0) {
    source_.replaced().for_each(y, x, count, [&](const ReplacedPixel& p, int i) {
      if (p.is_source) out[i] *= p.scale;
    });
  }
  filled_[from.layer].for_each(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.colour[from.index]; });
}

void LayerSource::input_row(int channel, int y, int x, int count, float* out) const {
  const Channel& from = channels_[static_cast<std::size_t>(channel)];
  from.plane.read_row(y, x, count, out);
  filled_[from.layer].for_each(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.colour[from.index]; });
}

}  // namespace stein
