// SPDX-License-Identifier: Apache-2.0
//
// Planes: one channel of an image. Views look at the caller's memory as it is (float, half or uint32, any
// pixel and row stride, per channel), so planar, interleaved and tiled-row buffers need no copy. `Plane` owns float32.
//
// Common to the whole interface: y points down; strides are in bytes and may be negative; a default-constructed view
// is "absent". Views do not own: the memory must outlive every call that is handed the view.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#pragma GCC visibility push(default)
namespace stein {

class Memory;

enum class ScalarType : std::uint8_t { kFloat32, kFloat16, kUint32 };

/// Size of one element in bytes.
[[nodiscard]] constexpr std::ptrdiff_t byte_size(ScalarType type) noexcept {
  return type == ScalarType::kFloat16 ? 2 : 4;
}

/// Read-only view of one channel.
class ConstPlaneView {
 public:
  constexpr ConstPlaneView() = default;

  /// Strides in bytes; 0 means packed (pixel: the element's size; row: width times the pixel stride).
  constexpr ConstPlaneView(const void* data, ScalarType type, int width, int height, std::ptrdiff_t pixel_stride = 0,
                           std::ptrdiff_t row_stride = 0) noexcept
      : data_(static_cast<const std::byte*>(data)),
        pixel_stride_(pixel_stride != 0 ? pixel_stride : byte_size(type)),
        row_stride_(row_stride != 0 ? row_stride : pixel_stride_ * width),
        width_(width),
        height_(height),
        type_(type) {}

  constexpr ConstPlaneView(const float* data, int width, int height, std::ptrdiff_t pixel_stride = 0,
                           std::ptrdiff_t row_stride = 0) noexcept
      : ConstPlaneView(data, ScalarType::kFloat32, width, height, pixel_stride, row_stride) {}

  [[nodiscard]] constexpr explicit operator bool() const noexcept { return data_ != nullptr; }
  [[nodiscard]] constexpr const void* data() const noexcept { return data_; }
  [[nodiscard]] constexpr ScalarType type() const noexcept { return type_; }
  [[nodiscard]] constexpr int width() const noexcept { return width_; }
  [[nodiscard]] constexpr int height() const noexcept { return height_; }
  [[nodiscard]] constexpr std::ptrdiff_t pixel_stride() const noexcept { return pixel_stride_; }
  [[nodiscard]] constexpr std::ptrdiff_t row_stride() const noexcept { return row_stride_; }

  /// The value at (x, y) as float. No bounds check.
  [[nodiscard]] float at(int x, int y) const noexcept;

  /// Converts pixels [x, x + count) of row y to floats. No bounds check.
  void read_row(int y, int x, int count, float* out) const noexcept;

 private:
  const std::byte* data_ = nullptr;
  std::ptrdiff_t pixel_stride_ = 0;
  std::ptrdiff_t row_stride_ = 0;
  int width_ = 0;
  int height_ = 0;
  ScalarType type_ = ScalarType::kFloat32;
};

/// Writable float32 view of one channel.
class PlaneView {
 public:
  constexpr PlaneView() = default;
  PlaneView(float* data, int width, int height, std::ptrdiff_t pixel_stride = 0, std::ptrdiff_t row_stride = 0) noexcept
      : view_(data, width, height, pixel_stride, row_stride), data_(reinterpret_cast<std::byte*>(data)) {}

  [[nodiscard]] constexpr explicit operator bool() const noexcept { return static_cast<bool>(view_); }
  // NOLINTNEXTLINE(google-explicit-constructor): a view narrows freely
  constexpr operator ConstPlaneView() const noexcept { return view_; }
  [[nodiscard]] constexpr int width() const noexcept { return view_.width(); }
  [[nodiscard]] constexpr int height() const noexcept { return view_.height(); }

  [[nodiscard]] float& at(int x, int y) const noexcept {
    return *reinterpret_cast<float*>(data_ + y * view_.row_stride() + x * view_.pixel_stride());
  }
  /// Stores `count` floats at pixels [x, x + count) of row y. No bounds check.
  void write_row(int y, int x, int count, const float* values) const noexcept;

 private:
  ConstPlaneView view_;
  std::byte* data_ = nullptr;
};

/// Owning float32 plane, rows aligned to 64 bytes. Move-only: copying an image must be explicit. Zero-initialised.
class Plane {
 public:
  Plane() = default;
  /// With `memory`, from there (memory.hpp).
  Plane(int width, int height, Memory* memory = nullptr);
  /// Three planes of one block of memory, at equal distances: as a whole they are a strided array of three channels.
  [[nodiscard]] static std::array<Plane, 3> triple(int width, int height, Memory* memory = nullptr);

  [[nodiscard]] explicit operator bool() const noexcept { return data_ != nullptr; }
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] std::ptrdiff_t row_stride() const noexcept {
    return pitch_ * static_cast<std::ptrdiff_t>(sizeof(float));
  }  ///< bytes
  [[nodiscard]] float* row(int y) noexcept { return data_.get() + y * pitch_; }
  [[nodiscard]] const float* row(int y) const noexcept { return data_.get() + y * pitch_; }
  [[nodiscard]] PlaneView view() noexcept { return {data_.get(), width_, height_, 0, row_stride()}; }
  [[nodiscard]] ConstPlaneView view() const noexcept { return {data_.get(), width_, height_, 0, row_stride()}; }

 private:
  struct Free {
    std::shared_ptr<void> block;  // what was allocated; a plane starts at an aligned address in it
    void operator()(float* /*p*/) noexcept { block.reset(); }
  };
  std::unique_ptr<float, Free> data_;
  std::ptrdiff_t pitch_ = 0;  // floats
  int width_ = 0;
  int height_ = 0;
};

}  // namespace stein
#pragma GCC visibility pop
