// SPDX-License-Identifier: Apache-2.0
#include "filters/filter.hpp"

#include <numeric>

namespace stein {

std::vector<int> halos(const FilterSpec& spec) {
  return std::visit([](const auto& params) { return halos(params); }, spec);
}

GuideRows make_guides(const FilterSpec& spec, const Source& source, const GuideWindow& window) {
  return std::visit([&](const auto& params) { return make_guides(params, source, window); }, spec);
}

std::unique_ptr<PreparedFilter> prepare(const FilterSpec& spec, const FilterContext& context) {
  return std::visit([&](const auto& params) { return prepare(params, context); }, spec);
}

int reach(const FilterSpec& spec) {
  const std::vector<int> all = halos(spec);
  const int of_guides = std::visit(
      []<class Params>(const Params& params) {
        if constexpr (requires { params.guides; }) {
          return GuideRows::halo(params.guides);
        } else {
          return 0;
        }
      },
      spec);
  return std::accumulate(all.begin(), all.end(), of_guides);
}

}  // namespace stein
