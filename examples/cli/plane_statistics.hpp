// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "stein/plane.hpp"

namespace stein::cli {

/// Of the finite values of a plane; NaN where it has none.
struct PlaneStatistics {
  double minimum = 0;
  double mean = 0;
  double maximum = 0;
  std::int64_t non_finite = 0;
};

[[nodiscard]] PlaneStatistics statistics(ConstPlaneView plane);

}  // namespace stein::cli
