// SPDX-License-Identifier: Apache-2.0
//
// Neighbours of a pixel, drawn with a Gaussian around it: the screen term of RPF Eq. 2, sec. 4.5.1.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rpf/sample_rows.hpp"

namespace stein::rpf {

/// Where samples come from, and what is added to the pixel's place there.
struct NeighbourFrame {
  const SampleRows* rows = nullptr;
  int dx = 0;
  int dy = 0;
};

/// Offsets along one axis with the frequencies of a Gaussian whose standard deviation is a quarter of the box.
class OffsetTable {
 public:
  explicit OffsetTable(int box);
  static constexpr unsigned kBits = 12;
  [[nodiscard]] int operator[](std::uint64_t index) const noexcept { return offsets_[index]; }

 private:
  std::array<std::int8_t, std::size_t{1} << kBits> offsets_{};
};

/// Records of samples and their colours before the pass.
struct SampleList {
  std::vector<const float*> records;
  std::vector<const float*> colours;
  void clear() {
    records.clear();
    colours.clear();
  }
  [[nodiscard]] int size() const noexcept { return static_cast<int>(records.size()); }
};

struct DrawKey {
  std::uint64_t seed = 0;
  int pass = 0;
  int x = 0;
  int y = 0;
};

/// The colour of sample i of a row before a pass.
[[nodiscard]] inline const float* colour_before(const SampleRow& row, const RecordLayout& layout, int pass,
                                                std::size_t i) noexcept {
  return pass == 0 ? row.records + i * static_cast<std::size_t>(layout.stride) + layout.colour()
                   : row.colours[static_cast<std::size_t>(pass) - 1] + i * kColourStride;
}

/// Appends `wanted` samples of pixels other than (x, y) of the first frame. Fewer where the image has too few.
void draw_neighbours(const DrawKey& key, const OffsetTable& table, const std::vector<NeighbourFrame>& frames,
                     int wanted, SampleList& list);

}  // namespace stein::rpf
