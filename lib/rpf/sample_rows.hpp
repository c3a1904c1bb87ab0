// SPDX-License-Identifier: Apache-2.0
//
// Rows of samples: a window that slides down the image.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exec/buffers.hpp"
#include "rpf/record_layout.hpp"

namespace stein::rpf {

inline constexpr int kMostPasses = 4;
inline constexpr int kColourStride = 4;  ///< of filtered colours: R, G, B and nothing

struct PixelShift {
  std::int8_t dx = 0;
  std::int8_t dy = 0;
};

/// Arrays are parts of `floats`.
struct SampleRow {
  std::vector<std::uint32_t> first;              ///< number of the first sample of each pixel, and that of all
  float* records = nullptr;                      ///< RecordLayout
  std::array<float*, kMostPasses> colours{};     ///< of each sample after pass 0, 1, ...
  std::array<float*, kMostPasses + 1> pixels{};  ///< of each pixel, three: their means; those of LightReturn
  float* balance = nullptr;                      ///< LightReturn: planes of the last pass
  float* directions = nullptr;                   ///< of each pixel, three: what its colour was moved by, where it was
  std::vector<PixelShift> shifts;                ///< of each pixel to its like in each adjacent frame
  exec::FloatBuffer floats;
};

/// What a row has room for besides records.
struct RowRoom {
  int passes = 0;
  std::size_t balance = 0;  ///< floats
};

struct SampleCounts {
  std::int64_t samples = 0;
  std::int64_t rejected = 0;
  std::int64_t repaired = 0;
  std::int64_t empty_pixels = 0;
  std::int64_t single_pixels = 0;
};

/// The random step of a pixel's samples for the estimate of the error: docs/risk.md.
struct SampleStep {
  std::uint64_t seed = 0;
  int draw = 0;
  float step = 0;
};

class SampleRows {
 public:
  /// Everything referred to must outlive this. `memory`: where the rows lie, null for the heap.
  SampleRows(const SampleSource& source, const RecordLayout& layout, RowRoom room, int capacity, Memory* memory);

  [[nodiscard]] int width() const noexcept { return source_.width; }
  [[nodiscard]] int height() const noexcept { return source_.height; }
  [[nodiscard]] const RecordLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] int rows_read() const noexcept { return rows_read_; }
  [[nodiscard]] const SampleCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] SampleRow& row(int y) noexcept { return *row_at_[static_cast<std::size_t>(y)]; }
  [[nodiscard]] const SampleRow& row(int y) const noexcept { return *row_at_[static_cast<std::size_t>(y)]; }

  /// The next row, in the place of the one `capacity` rows above.
  void read_row();
  /// The next row as that of `from`, with colours and features of each pixel's samples moved together: by step * b, b a
  /// random combination of its centred samples that has the covariance of their mean.
  void move_row(const SampleRows& from, const SampleStep& step);

 private:
  void make_room(SampleRow& row, std::size_t samples) const;
  [[nodiscard]] bool add_sample(const float* sample, int x, float* record);
  void add_position_and_randoms(const float* sample, int x, float* out, bool& was_broken) const;
  void count_pixel(std::uint32_t samples);
  void end_row();

  const SampleSource& source_;
  const RecordLayout& layout_;
  RowRoom room_;
  Memory* memory_;
  int rows_read_ = 0;
  std::vector<SampleRow> ring_;
  std::vector<SampleRow*> row_at_;  // of each row of the image, its place in the ring
  std::vector<std::uint32_t> row_counts_;
  std::vector<float> row_samples_;
  SampleCounts counts_;
};

}  // namespace stein::rpf
