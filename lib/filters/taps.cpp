// SPDX-License-Identifier: Apache-2.0
#include "filters/taps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/guides.hpp"

namespace stein {
namespace {

// Four taps of one distance: a pixel and its mirror images; those on the axes by turning.
struct Batch {
  int first_scale = 0;
  int x = 0;
  int y = 0;
  [[nodiscard]] double distance2() const { return static_cast<double>(x) * x + static_cast<double>(y) * y; }
  [[nodiscard]] std::array<std::array<int, 2>, kernels::kTapBatch> taps() const {
    if (y == 0) return {{{0, -x}, {-x, 0}, {x, 0}, {0, x}}};
    return {{{-x, -y}, {x, -y}, {-x, y}, {x, y}}};
  }
};

bool reaches(float sigma, const Batch& batch) {
  const double radius = static_cast<double>(ScaleTaps::kRadiusInSigmas) * sigma;
  return batch.distance2() <= radius * radius;
}

// Row by row for each scale, so that what a batch reads is near to what the last one did.
std::vector<Batch> batches_of(const std::vector<float>& sigmas) {
  std::vector<Batch> batches;
  const int radius = radius_of(sigmas);
  for (int y = 0; y <= radius; ++y) {
    for (int x = y == 0 ? 0 : 1; x <= radius; ++x) {
      Batch batch{0, x, y};
      const auto first = std::find_if(sigmas.begin(), sigmas.end(), [&](float sigma) { return reaches(sigma, batch); });
      batch.first_scale = static_cast<int>(first - sigmas.begin());
      if (first != sigmas.end()) batches.push_back(batch);
    }
  }
  std::stable_sort(batches.begin(), batches.end(),
                   [](const Batch& a, const Batch& b) { return a.first_scale < b.first_scale; });
  return batches;
}

}  // namespace

int radius_of(const std::vector<float>& sigmas) {
  return static_cast<int>(std::floor(ScaleTaps::kRadiusInSigmas * sigmas.back()));
}

ScaleTaps::ScaleTaps(const std::vector<float>& sigmas, const exec::TileLayout& layout) {
  for (const Batch& batch : batches_of(sigmas)) {
    for (const auto& [dx, dy] : batch.taps()) offsets.push_back(layout.offset(dx, dy));
    const double share = batch.distance2() == 0 ? 1.0 / kernels::kTapBatch : 1.0;
    first_scale.push_back(batch.first_scale);
    for (const double sigma : sigmas) {  // SBF Eq. 4, spatial term
      spatial.push_back(static_cast<float>(share * std::exp(-batch.distance2() / (2.0 * sigma * sigma))));
    }
  }
}

}  // namespace stein
