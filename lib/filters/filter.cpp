// SPDX-License-Identifier: Apache-2.0
#include "filters/filter.hpp"

namespace stein {

int halo(const FilterSpec& spec) {
  return std::visit([](const auto& params) { return halo(params); }, spec);
}

std::unique_ptr<PreparedFilter> prepare(const FilterSpec& spec, const FilterContext& context) {
  return std::visit([&](const auto& params) { return prepare(params, context); }, spec);
}

GuideRows make_guides(const FilterSpec& spec, const Source& source, int rows) {
  return std::visit([&](const auto& params) { return make_guides(params, source, rows); }, spec);
}

}  // namespace stein
