// SPDX-License-Identifier: Apache-2.0
#include "exec/buffers.hpp"

#include "core/aligned_zeros.hpp"

namespace stein::exec {
namespace {

constexpr std::ptrdiff_t kLine = 16;            // floats in a cache line, and the widest vector
constexpr std::ptrdiff_t kPage = 1024;          // floats whose addresses repeat modulo 4096 bytes
constexpr std::ptrdiff_t kStagger = 5 * kLine;  // planes start this far apart modulo a page

std::ptrdiff_t round_up(std::ptrdiff_t value, std::ptrdiff_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

// The next plane stride that is kStagger modulo a page: streams over the same pixel of many planes then fall into
// different cache sets. With equal sets the bank is three times slower.
std::ptrdiff_t staggered(std::ptrdiff_t floats) { return round_up(floats - kStagger, kPage) + kStagger; }

}  // namespace

float* FloatBuffer::reserve(std::size_t count, Memory* memory, Memory::Use use) {
  if (count > size_) {
    const std::shared_ptr<float> block = shared_zeros(count, memory, use);
    data_ = {block.get(), Free{block}};
    size_ = count;
  }
  return data_.get();
}

TileLayout::TileLayout(int tile_width, int tile_height, int tile_halo)
    : max_width(tile_width), max_height(tile_height), halo(tile_halo) {
  const std::ptrdiff_t left = round_up(halo, kLine);
  // An odd number of lines: successive rows do not share cache sets either.
  pitch = ((left + round_up(max_width, kLine) + round_up(halo, kLine) + kLine) / kLine | 1) * kLine;
  plane_stride = staggered(pitch * (max_height + 2 * halo));
}

void TilePlanes::reserve(const TileLayout& layout, int planes) {
  layout_ = layout;
  left_ = round_up(layout.halo, kLine);
  buffer_.reserve(static_cast<std::size_t>(layout.plane_stride * planes + kLine));
}

RowRing::RowRing(int planes, int width, int capacity, Memory* memory, Memory::Use use)
    : planes_(planes), capacity_(capacity) {
  pitch_ = ((round_up(width, kLine) + 2 * kPadding) / kLine | 1) * kLine;
  plane_stride_ = staggered(pitch_ * capacity);
  buffer_.reserve(static_cast<std::size_t>(plane_stride_ * planes + kPadding), memory, use);
}

}  // namespace stein::exec
