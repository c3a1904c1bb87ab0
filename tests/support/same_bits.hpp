// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "stein/denoise.hpp"
#include "stein/plane.hpp"

namespace stein::test {

inline bool same_bits(const Plane& a, const Plane& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (int y = 0; y < a.height(); ++y) {
    if (std::memcmp(a.row(y), b.row(y), static_cast<std::size_t>(a.width()) * sizeof(float)) != 0) return false;
  }
  return true;
}

/// All that is told of errors in the mean.
inline bool same_errors(const DenoiseReport& a, const DenoiseReport& b) {
  const auto same = [](const FilterShare& f, const FilterShare& g) {
    return f.weight == g.weight && f.mean_relative_error == g.mean_relative_error;
  };
  return a.mean_error == b.mean_error && a.mean_relative_error == b.mean_relative_error &&
         std::equal(a.filters.begin(), a.filters.end(), b.filters.begin(), b.filters.end(), same);
}

}  // namespace stein::test
