// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <utility>
#include <vector>

#include "core/plane_slots.hpp"
#include "stein/frame.hpp"

namespace stein {

std::vector<std::pair<std::string, ConstPlaneView>> named_planes(const Frame& frame) {
  std::vector<std::pair<std::string, ConstPlaneView>> planes;
  const auto add = [&](const std::string& name, const ConstPlaneView& view) {
    if (view) planes.emplace_back(name, view);
  };
  for_each_colour_slot(frame, add);
  for (const Feature& feature : frame.features) for_each_slot(feature, add);
  for (const Layer& layer : frame.layers) {
    for (std::size_t c = 0; c < layer.mean.size(); ++c) add(plane_name(layer, c), layer.mean[c]);
  }
  return planes;
}

}  // namespace stein
