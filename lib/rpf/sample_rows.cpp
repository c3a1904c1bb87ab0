// SPDX-License-Identifier: Apache-2.0
#include "rpf/sample_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/hash.hpp"
#include "stein/error.hpp"

namespace stein::rpf {
namespace {

constexpr std::size_t kReadable = 16;                         // floats that kernels may read past the last record
constexpr std::uint64_t kStepStream = 0xD1B54A32D192ED03ULL;  // apart from that of the neighbours
constexpr float kLargest = 1e15F;                             // squares and their sums stay finite

bool is_usable(float value) { return std::abs(value) <= kLargest; }

// RPF sec. 4.1: zero is what a sample has where it has nothing.
float repaired(float value, bool& was_broken) {
  if (is_usable(value)) return value;
  was_broken = true;
  return 0.0F;
}

}  // namespace

SampleRows::SampleRows(const SampleSource& source, const RecordLayout& layout, RowRoom room, int capacity,
                       Memory* memory)
    : source_(source), layout_(layout), room_(room), memory_(memory), ring_(static_cast<std::size_t>(capacity)) {
  const auto rows = static_cast<std::size_t>(source.height);
  for (std::size_t y = 0; y < rows; ++y) row_at_.push_back(&ring_[y % ring_.size()]);
}

// The arrays of a row for that many samples, as zeros.
void SampleRows::make_room(SampleRow& row, std::size_t samples) const {
  const std::size_t per_pixel = static_cast<std::size_t>(width()) * 3;
  const std::size_t records = samples * static_cast<std::size_t>(layout_.stride) + kReadable;
  const std::size_t colours = samples * kColourStride;
  const auto passes = static_cast<std::size_t>(room_.passes);
  const std::size_t size = records + passes * colours + (passes + 2) * per_pixel + room_.balance;
  float* next = row.floats.reserve(size, memory_);
  std::fill_n(next, size, 0.0F);
  const auto take = [&next](std::size_t count) { return std::exchange(next, next + count); };
  row.records = take(records);
  for (std::size_t p = 0; p < passes; ++p) row.colours[p] = take(colours);
  for (std::size_t p = 0; p <= passes; ++p) row.pixels[p] = take(per_pixel);
  row.balance = take(room_.balance);
  row.directions = take(per_pixel);
}

// Whether the sample can be used.
bool SampleRows::add_sample(const float* sample, int x, float* record) {
  if (!is_usable(sample[0]) || !is_usable(sample[1]) || !is_usable(sample[2])) {
    ++counts_.rejected;
    return false;
  }
  bool was_broken = false;
  for (const int from : layout_.feature_from) *record++ = repaired(sample[from], was_broken);
  record = std::copy_n(sample, 3, record);
  add_position_and_randoms(sample, x, record, was_broken);
  counts_.repaired += was_broken ? 1 : 0;
  ++counts_.samples;
  return true;
}

void SampleRows::add_position_and_randoms(const float* sample, int x, float* out, bool& was_broken) const {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const int from = layout_.pixel_from[axis];
    const float within = from < 0 ? 0.5F : repaired(sample[from], was_broken);
    const auto pixel = static_cast<float>(axis == 0 ? x : rows_read_);
    *out++ = pixel + within - std::floor(within);  // some renderers count from the image's corner
  }
  for (const int from : layout_.random_from) *out++ = repaired(sample[from], was_broken);
  if (layout_.has_first_bounce()) {
    std::array<float, 3> way{};
    for (std::size_t k = 0; k < 3; ++k) {
      const float end_of_way = repaired(sample[layout_.position2_from[k]], was_broken);
      way[k] = end_of_way - repaired(sample[layout_.position_from[k]], was_broken);
    }
    const float length = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    for (const float part : way) *out++ = length > 0 ? part / length : 0.0F;
  }
}

void SampleRows::count_pixel(std::uint32_t samples) {
  counts_.empty_pixels += samples == 0 ? 1 : 0;
  counts_.single_pixels += samples == 1 ? 1 : 0;
}

void SampleRows::end_row() {
  ++rows_read_;
  if (memory_ != nullptr) memory_->trim();
}

void SampleRows::read_row() {
  source_.next_row(row_counts_, row_samples_);
  const std::size_t total = std::accumulate(row_counts_.begin(), row_counts_.end(), std::size_t{0});
  const auto channels = static_cast<std::size_t>(layout_.source_channels);
  if (row_counts_.size() != static_cast<std::size_t>(width()) || row_samples_.size() < total * channels) {
    throw Error(ErrorCode::kInvalidFrame,
                "rpf: row " + std::to_string(rows_read_) + " of the samples has " + std::to_string(row_counts_.size()) +
                    " pixels and " + std::to_string(row_samples_.size()) + " values; " + std::to_string(width()) +
                    " pixels and " + std::to_string(total * channels) + " values are needed");
  }
  SampleRow& out = row(rows_read_);
  make_room(out, total);
  out.first.assign(1, 0);
  std::uint32_t used = 0;
  const float* sample = row_samples_.data();
  for (int x = 0; x < width(); ++x) {
    for (std::uint32_t i = 0; i < row_counts_[static_cast<std::size_t>(x)]; ++i, sample += channels) {
      if (add_sample(sample, x, out.records + used * static_cast<std::size_t>(layout_.stride))) ++used;
    }
    count_pixel(used - out.first.back());
    out.first.push_back(used);
  }
  end_row();
}

void SampleRows::move_row(const SampleRows& from, const SampleStep& step) {
  const SampleRow& in = from.row(rows_read_);
  SampleRow& out = row(rows_read_);
  out.first = in.first;
  const auto stride = static_cast<std::size_t>(layout_.stride);
  make_room(out, in.first.back());
  std::copy_n(in.records, in.first.back() * stride, out.records);
  const auto moved = static_cast<std::size_t>(layout_.features + 3);
  for (int x = 0; x < width(); ++x) {
    const std::size_t first = in.first[static_cast<std::size_t>(x)];
    const std::size_t n = in.first[static_cast<std::size_t>(x) + 1] - first;
    if (n < 2) continue;
    const std::uint64_t stream = mixed(mixed(step.seed + kGoldenRatioBits * static_cast<std::uint64_t>(step.draw + 1)) ^
                                       mixed(pixel_key(x, rows_read_) + kStepStream));
    const double scale = 1.0 / std::sqrt(static_cast<double>(n) * static_cast<double>(n - 1));
    for (std::size_t k = 0; k < moved; ++k) {
      const float* value = in.records + first * stride + k;
      double mean = 0;
      for (std::size_t i = 0; i < n; ++i) mean += value[i * stride] / static_cast<double>(n);
      double b = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const bool is_plus = (mixed(stream + i) >> 33U & 1U) != 0;
        b += scale * (is_plus ? 1.0 : -1.0) * (value[i * stride] - mean);
      }
      for (std::size_t i = 0; i < n; ++i) out.records[(first + i) * stride + k] += step.step * static_cast<float>(b);
      if (k + 3 >= moved) out.directions[static_cast<std::size_t>(3 * x) + k + 3 - moved] = static_cast<float>(b);
    }
  }
  end_row();
}

}  // namespace stein::rpf
