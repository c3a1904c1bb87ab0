// SPDX-License-Identifier: Apache-2.0
//
// The filters of the list as the conformance tests run them.
#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "stein/filters.hpp"

namespace stein::test {

/// A window of hundreds of pixels tests nothing that a smaller one does not.
inline FilterSpec in_small_window(FilterSpec spec) {
  std::visit(
      [](auto& params) {
        if constexpr (requires { params.window_radius; }) params.window_radius = 6;
      },
      spec);
  return spec;
}

/// Every filter of the list with its defaults.
inline std::vector<FilterSpec> listed_specs() {
  std::vector<FilterSpec> all;
  for (const std::string_view name : filter_names()) all.push_back(in_small_window(make_filter(name)));
  return all;
}

}  // namespace stein::test
