// SPDX-License-Identifier: Apache-2.0
#include "filters/filter.hpp"

namespace stein {

int halo(const FilterSpec& spec) {
  return std::visit([](const auto& params) { return halo(params); }, spec);
}

std::unique_ptr<PreparedFilter> prepare(const FilterSpec& spec, const FilterContext& context) {
  return std::visit([&](const auto& params) { return prepare(params, context); }, spec);
}

const CrossBilateralParams& guides_of(const FilterSpec& spec) {
  return std::visit([](const auto& params) -> const CrossBilateralParams& { return params; }, spec);
}

}  // namespace stein
