// SPDX-License-Identifier: Apache-2.0
#include "filters/filter.hpp"

namespace stein {

std::unique_ptr<PreparedFilter> prepare(const FilterSpec& spec, const Source& source, int tile_width, int tile_height) {
  return std::visit([&](const auto& params) { return prepare(params, source, tile_width, tile_height); }, spec);
}

}  // namespace stein
