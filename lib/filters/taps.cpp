// SPDX-License-Identifier: Apache-2.0
#include "filters/taps.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/guides.hpp"

namespace stein {
namespace {

struct Tap {
  int first_scale = 0;
  int dy = 0;
  int dx = 0;
  [[nodiscard]] double distance2() const { return static_cast<double>(dx) * dx + static_cast<double>(dy) * dy; }
};

bool reaches(float sigma, const Tap& tap) {
  const double radius = static_cast<double>(ScaleTaps::kRadiusInSigmas) * sigma;
  return tap.distance2() <= radius * radius;
}

std::vector<Tap> taps_of(const std::vector<float>& sigmas) {
  std::vector<Tap> taps;
  const int radius = radius_of(sigmas);
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      Tap tap{0, dy, dx};
      const auto first = std::find_if(sigmas.begin(), sigmas.end(), [&](float sigma) { return reaches(sigma, tap); });
      tap.first_scale = static_cast<int>(first - sigmas.begin());
      if (first != sigmas.end()) taps.push_back(tap);
    }
  }
  std::stable_sort(taps.begin(), taps.end(), [](const Tap& a, const Tap& b) { return a.first_scale < b.first_scale; });
  return taps;
}

}  // namespace

int radius_of(const std::vector<float>& sigmas) {
  return static_cast<int>(std::floor(ScaleTaps::kRadiusInSigmas * sigmas.back()));
}

ScaleTaps::ScaleTaps(const std::vector<float>& sigmas, const exec::TileLayout& layout) {
  const std::vector<Tap> taps = taps_of(sigmas);
  const std::size_t scales = sigmas.size();
  for (std::size_t i = 0; i < taps.size();) {
    const std::size_t batch = first_scale.size();
    first_scale.push_back(taps[i].first_scale);
    spatial.resize(spatial.size() + scales * kernels::kTapBatch, 0.0F);
    for (int t = 0; t < kernels::kTapBatch; ++t) {
      if (i == taps.size() || taps[i].first_scale != first_scale.back()) {
        offsets.push_back(0);  // padding: the pixel itself with factor 0
        continue;
      }
      offsets.push_back(layout.offset(taps[i].dx, taps[i].dy));
      for (std::size_t s = static_cast<std::size_t>(taps[i].first_scale); s < scales; ++s) {
        const double sigma = sigmas[s];
        spatial[(batch * scales + s) * kernels::kTapBatch + static_cast<std::size_t>(t)] =
            static_cast<float>(std::exp(-taps[i].distance2() / (2.0 * sigma * sigma)));  // SBF Eq. 4, spatial term
      }
      ++i;
    }
  }
}

}  // namespace stein
