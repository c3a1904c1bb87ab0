// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "rpf/neighbour_draws.hpp"

#include <cmath>

#include "core/hash.hpp"

namespace stein::rpf {
namespace {

std::uint64_t stream_of(const DrawKey& key) noexcept {
  return mixed(mixed(key.seed + kGoldenRatioBits * static_cast<std::uint64_t>(key.pass + 1)) + pixel_key(key.x, key.y));
}

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

}  // namespace

OffsetTable::OffsetTable(int box) {
  const double sigma = box / 4.0;
  const int half = box / 2;
  const double lowest = normal_distribution((-half - 0.5) / sigma);
  const double total = normal_distribution((half + 0.5) / sigma) - lowest;
  int offset = -half;
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(offsets_.size());
    while (offset < half && normal_distribution((offset + 0.5) / sigma) - lowest < u * total) ++offset;
    offsets_[i] = static_cast<std::int8_t>(offset);
  }
}

void draw_neighbours(const DrawKey& key, const OffsetTable& table, const std::vector<NeighbourFrame>& frames,
                     int wanted, SampleList& list) {
  constexpr int kTries = 4;  // per sample: in the corner of an image three of four draws lie outside
  constexpr std::uint64_t kMask = (std::uint64_t{1} << OffsetTable::kBits) - 1;
  const std::uint64_t stream = stream_of(key);
  const int end = list.size() + wanted;
  for (int q = 0; q < kTries * wanted && list.size() < end; ++q) {
    const std::uint64_t bits = mixed(stream + kGoldenRatioBits * static_cast<std::uint64_t>(q + 1));
    const std::uint64_t frame = ((bits >> 24U & 0xFFU) * frames.size()) >> 8U;
    const int dx = table[bits & kMask];
    const int dy = table[bits >> OffsetTable::kBits & kMask];
    const NeighbourFrame& from = frames[frame];
    const int x = key.x + from.dx + dx;
    const int y = key.y + from.dy + dy;
    if (x < 0 || y < 0 || x >= from.rows->width() || y >= from.rows->height()) continue;
    if (frame == 0 && dx == 0 && dy == 0) continue;
    const SampleRow& row = from.rows->row(y);
    const std::uint32_t first = row.first[static_cast<std::size_t>(x)];
    const std::uint64_t count = row.first[static_cast<std::size_t>(x) + 1] - first;
    if (count == 0) continue;
    const std::size_t i = first + ((bits >> 32U) * count >> 32U);
    const RecordLayout& layout = from.rows->layout();
    const float* record = row.records + i * static_cast<std::size_t>(layout.stride);
    __builtin_prefetch(record);
    __builtin_prefetch(record + 16);
    list.records.push_back(record);
    list.colours.push_back(colour_before(row, layout, key.pass, i));
  }
}

}  // namespace stein::rpf
