// SPDX-License-Identifier: Apache-2.0
#include "filters/filter.hpp"

#include <numeric>

namespace stein {

std::vector<int> halos(const FilterSpec& spec) {
  return std::visit([](const auto& params) { return halos(params); }, spec);
}

GuideRows make_guides(const FilterSpec& spec, const Source& source, int rows) {
  return std::visit([&](const auto& params) { return make_guides(params, source, rows); }, spec);
}

std::unique_ptr<PreparedFilter> prepare(const FilterSpec& spec, const FilterContext& context) {
  return std::visit([&](const auto& params) { return prepare(params, context); }, spec);
}

int reach(const FilterSpec& spec) {
  const std::vector<int> all = halos(spec);
  return std::accumulate(all.begin(), all.end(), 0);
}

}  // namespace stein
