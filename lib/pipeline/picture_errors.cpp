// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture_errors.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "pipeline/relative_risk.hpp"

namespace stein {
namespace {

// `own`: of the mixture, without what outliers lost, as F.
double row_distance(const float* mask, const float* F, const float* own, const float* mixture, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    if (mask[i] == 0.0F) continue;
    const float difference = F[i] - own[i];
    sum += static_cast<double>(difference * difference / (mixture[i] * mixture[i] + kRelativeEpsilon));
  }
  return sum;
}

}  // namespace

std::vector<double> distances_from_mixture(const std::vector<MixtureRows>& pictures,
                                           const std::array<Plane, 3>& mixture, const Source& source,
                                           const OutlierEnergy& energy, exec::Runner& runner) {
  const int width = mixture[0].width();
  const int height = mixture[0].height();
  const auto rows = static_cast<std::size_t>(height);
  std::vector<double> sums(pictures.size() * rows);
  std::vector<int> measured(rows);  // pixels
  std::vector<std::vector<float>> lines(static_cast<std::size_t>(runner.slots()),
                                        std::vector<float>(2 * static_cast<std::size_t>(width)));
  runner.for_each(height, 0.0, [&](int y, int slot) {
    float* own = lines[static_cast<std::size_t>(slot)].data();
    float* mask = own + width;
    source.mask_row(y, 0, width, mask);
    measured[static_cast<std::size_t>(y)] = width - static_cast<int>(std::count(mask, mask + width, 0.0F));
    for (int c = 0; c < 3; ++c) {
      const float* B = mixture[static_cast<std::size_t>(c)].row(y);
      std::copy_n(B, width, own);
      energy.add_colour(c, y, 0, width, -1.0F, own);
      for (std::size_t p = 0; p < pictures.size(); ++p)
        sums[p * rows + static_cast<std::size_t>(y)] += row_distance(mask, pictures[p].result(c, y), own, B, width);
    }
  });
  const double values = 3.0 * static_cast<double>(std::accumulate(measured.begin(), measured.end(), std::int64_t{0}));
  std::vector<double> means;
  for (auto row = sums.begin(); row != sums.end(); row += height)
    means.push_back(std::accumulate(row, row + height, 0.0) / values);
  return means;
}

}  // namespace stein
