// SPDX-License-Identifier: Apache-2.0
#include "stein/plane.hpp"

#include <bit>
#include <cstring>
#include <memory>

#include "core/aligned_zeros.hpp"
#include "kernels/convert.hpp"

namespace stein {
namespace {

constexpr std::size_t kAlignment = 64;
constexpr std::ptrdiff_t kFloatsPerLine = kAlignment / sizeof(float);

// An odd number of cache lines, so that rows and planes do not all start in the same cache set.
constexpr std::ptrdiff_t odd_lines(std::ptrdiff_t floats) {
  return ((floats + kFloatsPerLine - 1) / kFloatsPerLine | 1) * kFloatsPerLine;
}

constexpr std::ptrdiff_t pitch_of(int width) { return odd_lines(width); }

template <class T>
T load(const std::byte* p) noexcept {
  T value;
  std::memcpy(&value, p, sizeof value);
  return value;
}

// IEEE binary16 to binary32: the exponent is moved by a multiplication, which also normalises the denormals; infinities
// and NaNs get the exponent that the multiplication could not reach.
float half_to_float(std::uint16_t half) noexcept {
  const std::uint32_t magnitude = static_cast<std::uint32_t>(half & 0x7FFFU) << 13;
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000U) << 16;
  const float scaled = std::bit_cast<float>(magnitude) * 0x1p112F;
  const std::uint32_t special = (half & 0x7C00U) == 0x7C00U ? 0x7F800000U : 0U;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(scaled) | special | sign);
}

template <class T, class Convert>
void convert_row(const std::byte* p, std::ptrdiff_t stride, int count, float* out, Convert convert) noexcept {
  for (int i = 0; i < count; ++i) out[i] = convert(load<T>(p + i * stride));
}

}  // namespace

float ConstPlaneView::at(int x, int y) const noexcept {
  float value = 0;
  read_row(y, x, 1, &value);
  return value;
}

void ConstPlaneView::read_row(int y, int x, int count, float* out) const noexcept {
  const std::byte* p = data_ + y * row_stride_ + x * pixel_stride_;
  switch (type_) {
    case ScalarType::kFloat32:
      if (pixel_stride_ == static_cast<std::ptrdiff_t>(sizeof(float))) {
        std::memcpy(out, p, static_cast<std::size_t>(count) * sizeof(float));
        return;
      }
      return convert_row<float>(p, pixel_stride_, count, out, [](float v) { return v; });
    case ScalarType::kFloat16:
      if (pixel_stride_ == static_cast<std::ptrdiff_t>(sizeof(std::uint16_t)))
        return kernels::half_to_float_row(p, count, out);
      return convert_row<std::uint16_t>(p, pixel_stride_, count, out, half_to_float);
    case ScalarType::kUint32:
      return convert_row<std::uint32_t>(p, pixel_stride_, count, out,
                                        [](std::uint32_t v) { return static_cast<float>(v); });
  }
}

void PlaneView::write_row(int y, int x, int count, const float* values) const noexcept {
  std::byte* p = data_ + y * view_.row_stride() + x * view_.pixel_stride();
  for (int i = 0; i < count; ++i) std::memcpy(p + i * view_.pixel_stride(), &values[i], sizeof(float));
}

Plane::Plane(int width, int height, Memory* memory) : pitch_(pitch_of(width)), width_(width), height_(height) {
  const auto block = shared_zeros(static_cast<std::size_t>(pitch_) * static_cast<std::size_t>(height), memory);
  data_ = {block.get(), Free{block}};
}

std::array<Plane, 3> Plane::triple(int width, int height, Memory* memory) {
  const std::ptrdiff_t pitch = pitch_of(width);
  const std::ptrdiff_t distance = odd_lines(pitch * height);
  const auto block = shared_zeros(3 * static_cast<std::size_t>(distance), memory);
  std::array<Plane, 3> planes;
  for (std::size_t c = 0; c < planes.size(); ++c) {
    Plane& plane = planes.at(c);
    plane.data_ = {block.get() + static_cast<std::ptrdiff_t>(c) * distance, Free{block}};
    plane.pitch_ = pitch;
    plane.width_ = width;
    plane.height_ = height;
  }
  return planes;
}

}  // namespace stein
