// SPDX-License-Identifier: Apache-2.0
#include "filters/taps.hpp"

#include <cmath>
#include <set>

#include "catch.hpp"
#include "kernels/guides.hpp"

namespace stein {

TEST_CASE("taps: every scale gets each pixel of its disc once, the own one in four parts, with its Gaussian") {
  const std::vector<float> sigmas = {1.0F, 1.41421356F, 2.0F, 4.0F};
  const exec::TileLayout layout(64, 16, radius_of(sigmas));
  const ScaleTaps taps(sigmas, layout);
  REQUIRE(taps.offsets.size() % kernels::kTapBatch == 0);
  for (std::size_t s = 0; s < sigmas.size(); ++s) {
    std::set<std::ptrdiff_t> seen;
    double sum = 0;
    for (std::size_t i = 0; i < taps.offsets.size(); ++i) {
      const std::size_t batch = i / kernels::kTapBatch;
      if (static_cast<int>(s) < taps.first_scale[batch]) continue;
      const bool is_new = seen.insert(taps.offsets[i]).second;
      CHECK((is_new || taps.offsets[i] == 0));
      sum += taps.spatial[batch * sigmas.size() + s];
    }
    double expected_sum = 0;
    std::size_t expected_count = 0;
    for (int dy = -8; dy <= 8; ++dy) {
      for (int dx = -8; dx <= 8; ++dx) {
        const double r2 = dx * dx + dy * dy;
        const double sigma = sigmas[s];
        if (r2 > 4.0 * sigma * sigma) continue;
        CHECK(seen.count(layout.offset(dx, dy)) == 1);
        ++expected_count;
        expected_sum += std::exp(-r2 / (2.0 * sigma * sigma));
      }
    }
    CHECK(seen.size() == expected_count);
    CHECK(sum == Approx(expected_sum).epsilon(1e-6));
  }
}

}  // namespace stein
