// SPDX-License-Identifier: Apache-2.0
//
// Working memory in rows of floats: a tile with its halo, and a window of rows that slides down the image.
#pragma once

#include <cstddef>
#include <memory>

#include "stein/memory.hpp"

namespace stein::exec {

/// 64-byte aligned floats, zero-initialised, never shrinking.
class FloatBuffer {
 public:
  /// At least `count` floats; the contents are kept only if the size suffices already. `memory`: where from.
  float* reserve(std::size_t count, Memory* memory = nullptr, Memory::Use use = Memory::Use::kWindow);
  [[nodiscard]] float* data() const noexcept { return data_.get(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  struct Free {
    std::shared_ptr<float> block;
    void operator()(float* /*p*/) noexcept { block.reset(); }
  };
  std::unique_ptr<float, Free> data_;
  std::size_t size_ = 0;
};

/// Geometry of tiles: one pitch for all of them, so that a neighbour's offset is the same everywhere.
struct TileLayout {
  int max_width = 0;  ///< a multiple of 16
  int max_height = 0;
  int halo = 0;
  TileLayout() = default;
  TileLayout(int tile_width, int tile_height, int tile_halo);

  std::ptrdiff_t pitch = 0;         ///< floats from row to row
  std::ptrdiff_t plane_stride = 0;  ///< floats from plane to plane; staggered so that planes do not share cache sets
  [[nodiscard]] std::ptrdiff_t offset(int dx, int dy) const noexcept { return dy * pitch + dx; }
};

/// Planes of one tile and its halo in one allocation.
class TilePlanes {
 public:
  void reserve(const TileLayout& layout, int planes);
  /// Pixel (0, y) of the tile, y in [-halo, max_height + halo); x from -halo on may be used, and 16 floats past the
  /// end.
  [[nodiscard]] float* row(int plane, int y) const noexcept {
    return buffer_.data() + plane * layout_.plane_stride + (y + layout_.halo) * layout_.pitch + left_;
  }
  [[nodiscard]] const TileLayout& layout() const noexcept { return layout_; }

 private:
  FloatBuffer buffer_;
  TileLayout layout_;
  std::ptrdiff_t left_ = 0;
};

/// Working memory of one thread.
struct TileScratch {
  TilePlanes tile;
  FloatBuffer lines;
};

/// The most recent rows of a set of image-wide planes: row y overwrites row y - capacity.
class RowRing {
 public:
  RowRing() = default;
  /// With `memory`, from there: as windows, or as images where the capacity is an image's height.
  RowRing(int planes, int width, int capacity, Memory* memory = nullptr, Memory::Use use = Memory::Use::kWindow);
  /// Readable floats left of pixel 0, and right of the last one; zero unless written.
  static constexpr int kPadding = 32;
  /// Pixel (0, y). Up to 15 floats past the last pixel may be written.
  [[nodiscard]] float* row(int plane, int y) const noexcept {
    return buffer_.data() + plane * plane_stride_ + static_cast<std::ptrdiff_t>(y % capacity_) * pitch_ + kPadding;
  }
  [[nodiscard]] int capacity() const noexcept { return capacity_; }
  [[nodiscard]] int planes() const noexcept { return planes_; }

 private:
  FloatBuffer buffer_;
  int planes_ = 0;
  std::ptrdiff_t pitch_ = 0;
  std::ptrdiff_t plane_stride_ = 0;
  int capacity_ = 1;
};

}  // namespace stein::exec
