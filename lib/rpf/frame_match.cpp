// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "rpf/frame_match.hpp"

#include <algorithm>
#include <limits>

namespace stein::rpf {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double mean_of(const SampleRow& row, int stride, int x, int k) {
  double sum = 0;
  const std::size_t first = row.first[at(x)];
  const std::size_t end = row.first[at(x) + 1];
  for (std::size_t i = first; i < end; ++i) sum += row.records[i * at(stride) + at(k)];
  return sum / static_cast<double>(end - first);
}

bool has_samples(const SampleRow& row, int x) { return row.first[at(x) + 1] > row.first[at(x)]; }

}  // namespace

// What hardly varies within a pixel gets a floor.
void FrameMatcher::find_scales(const SampleRow& row, const RecordLayout& layout, int x) {
  constexpr double kLeastRelative = 1e-6;  // variance over the mean's square: rounding
  constexpr double kLeast = 1e-4;          // of features in [0, 1]
  scales_.clear();
  const std::size_t first = row.first[at(x)];
  const std::size_t end = row.first[at(x) + 1];
  for (int k = 0; k < layout.features; ++k) {
    if (!layout.is_clustered[at(k)]) continue;
    const double mean = mean_of(row, layout.stride, x, k);
    double variance = layout.is_location[at(k)] ? kLeastRelative * mean * mean : kLeast;
    for (std::size_t i = first; i < end; ++i) {
      const double e = row.records[i * at(layout.stride) + at(k)] - mean;
      variance += e * e / static_cast<double>(end - first);
    }
    if (variance > 0) scales_.push_back({k, mean, 1.0 / variance});
  }
}

double FrameMatcher::distance(const SampleRow& row, int stride, int x, double limit) const {
  if (!has_samples(row, x)) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t s = 0; s < scales_.size() && sum < limit; ++s) {
    const double e = mean_of(row, stride, x, scales_[s].column) - scales_[s].mean;
    sum += e * e * scales_[s].inverse_variance;
  }
  return sum;
}

PixelShift FrameMatcher::find(const SampleRows& rows, const SampleRows& frame, int x, int y, int radius) {
  const int stride = rows.layout().stride;
  find_scales(rows.row(y), rows.layout(), x);
  PixelShift best;
  double least = distance(frame.row(y), stride, x, std::numeric_limits<double>::infinity());
  for (int ny = std::max(y - radius, 0); ny <= std::min(y + radius, rows.height() - 1); ++ny) {
    for (int nx = std::max(x - radius, 0); nx <= std::min(x + radius, rows.width() - 1); ++nx) {
      const double there = distance(frame.row(ny), stride, nx, least);
      if (there >= least) continue;
      least = there;
      best = {static_cast<std::int8_t>(nx - x), static_cast<std::int8_t>(ny - y)};
    }
  }
  return best;
}

}  // namespace stein::rpf
