// SPDX-License-Identifier: Apache-2.0
#include "quality/reliability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stein::quality {
namespace {

constexpr double kEpsilon = 0.01;
constexpr double kLeast = 1e-5;
constexpr double kDecades = 5.0;
constexpr int kPerDecade = 2;

std::vector<ReliabilityBin> empty_bins() {
  std::vector<ReliabilityBin> bins;
  double lower = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= static_cast<int>(kDecades) * kPerDecade; ++i) {
    const double upper = kLeast * std::pow(10.0, static_cast<double>(i) / kPerDecade);
    bins.push_back({lower, upper});
    lower = upper;
  }
  bins.push_back({lower, std::numeric_limits<double>::infinity()});
  return bins;
}

}  // namespace

std::vector<ReliabilityBin> reliability(const DenoiseResult& result, const exr::NamedPlanes& reference,
                                        double reference_noise) {
  std::vector<ReliabilityBin> bins = empty_bins();
  const int width = result.colour[0].width();
  const int height = result.colour[0].height();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double reported = 0;
      double truth = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double r = reference.planes[c].row(y)[x];
        const double weight = 1.0 / (3.0 * (r * r + kEpsilon));
        const double error = result.colour[c].row(y)[x] - r;
        reported += weight * result.error[c].row(y)[x];
        truth += weight * error * error;
      }
      const auto bin = std::find_if(bins.begin(), bins.end() - 1,
                                    [reported](const ReliabilityBin& b) { return reported < b.upper; });
      bin->share += 1.0;
      bin->reported += reported;
      bin->truth += truth;
    }
  }
  for (ReliabilityBin& bin : bins) {
    if (bin.share == 0) continue;
    bin.reported /= bin.share;
    bin.truth = bin.truth / bin.share - reference_noise;
    bin.share /= static_cast<double>(width) * height;
  }
  return bins;
}

}  // namespace stein::quality
