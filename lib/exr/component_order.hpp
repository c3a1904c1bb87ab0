// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cctype>
#include <string>
#include <string_view>
#include <utility>

namespace stein::exr {

/// R, G, B and X, Y, Z come in that order, with A and W last; anything else is alphabetical.
struct ComponentOrder {
  static std::string key(const std::string& component) {
    std::string lower = component;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    constexpr std::string_view kConvention = "rgbaxyzw";
    const std::size_t rank = lower.size() == 1 ? kConvention.find(lower[0]) : std::string_view::npos;
    return rank == std::string_view::npos ? "~" + lower : std::to_string(rank);
  }
  bool operator()(const std::string& a, const std::string& b) const {
    return std::pair(key(a), std::string_view(a)) < std::pair(key(b), std::string_view(b));
  }
};

}  // namespace stein::exr
