// SPDX-License-Identifier: Apache-2.0
#include "plane_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace stein::cli {

PlaneStatistics statistics(ConstPlaneView plane) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PlaneStatistics result{.minimum = kInfinity, .maximum = -kInfinity};
  double sum = 0;
  std::int64_t count = 0;
  std::vector<float> row(static_cast<std::size_t>(plane.width()));
  for (int y = 0; y < plane.height(); ++y) {
    plane.read_row(y, 0, plane.width(), row.data());
    for (const float value : row) {
      if (!std::isfinite(value)) {
        ++result.non_finite;
        continue;
      }
      result.minimum = std::min<double>(result.minimum, value);
      result.maximum = std::max<double>(result.maximum, value);
      sum += value;
      ++count;
    }
  }
  if (count == 0) {
    result.minimum = result.maximum = std::numeric_limits<double>::quiet_NaN();
  }
  result.mean = sum / static_cast<double>(count);
  return result;
}

}  // namespace stein::cli
