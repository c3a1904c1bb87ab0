// SPDX-License-Identifier: Apache-2.0
#include "stein/plane.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "catch.hpp"

namespace {

using stein::ConstPlaneView;
using stein::Plane;
using stein::PlaneView;
using stein::ScalarType;

/// IEEE binary16 by its definition: sign * 2^(e-15) * (1 + m / 1024), or sign * 2^-14 * m / 1024 for e = 0.
double half_value(std::uint16_t bits) {
  const int exponent = (bits >> 10) & 31;
  const int mantissa = bits & 1023;
  const double sign = (bits & 0x8000) != 0 ? -1.0 : 1.0;
  if (exponent == 31) return mantissa == 0 ? sign * std::numeric_limits<double>::infinity() : std::nan("");
  if (exponent == 0) return sign * std::ldexp(mantissa, -24);
  return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

std::vector<float> read(ConstPlaneView view, int y, int x, int count) {
  // One more than asked for, to see that nothing is written past the end.
  std::vector<float> row(static_cast<std::size_t>(count) + 1, -77.0F);
  view.read_row(y, x, count, row.data());
  CHECK(row.back() == -77.0F);
  row.pop_back();
  return row;
}

}  // namespace

TEST_CASE("A default view is absent, and Plane is move-only") {
  CHECK_FALSE(ConstPlaneView());
  CHECK_FALSE(PlaneView());
  CHECK_FALSE(Plane());
  static_assert(!std::is_copy_constructible_v<Plane> && !std::is_copy_assignable_v<Plane>);
  static_assert(std::is_nothrow_move_constructible_v<Plane>);
}

TEST_CASE("Packed floats of all kinds are read as they are") {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> data = {0.0F, -0.0F, 1.5F, -1e30F, inf, 1e-45F};
  const ConstPlaneView view(data.data(), 3, 2);
  CHECK(view.width() == 3);
  CHECK(view.height() == 2);
  CHECK(view.pixel_stride() == 4);
  CHECK(view.row_stride() == 12);
  CHECK(view.at(2, 0) == 1.5F);
  CHECK(view.at(0, 1) == -1e30F);
  CHECK(std::signbit(view.at(1, 0)));
  CHECK(read(view, 1, 0, 3) == std::vector<float>{-1e30F, inf, 1e-45F});
  CHECK(read(view, 0, 1, 2) == std::vector<float>{0.0F, 1.5F});
  CHECK(read(view, 0, 1, 0).empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(std::isnan(ConstPlaneView(&nan, 1, 1).at(0, 0)));
}

TEST_CASE("Every half is converted exactly") {
  std::vector<std::uint16_t> all(65536);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i);
  const ConstPlaneView view(all.data(), ScalarType::kFloat16, 65536, 1);
  CHECK(view.row_stride() == 131072);
  const std::vector<float> row = read(view, 0, 0, 65536);
  int wrong = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double expected = half_value(all[i]);
    const bool same = std::isnan(expected) ? std::isnan(row[i])
                                           : row[i] == expected && std::signbit(row[i]) == std::signbit(expected);
    wrong +=
        same && std::bit_cast<std::uint32_t>(view.at(static_cast<int>(i), 0)) == std::bit_cast<std::uint32_t>(row[i])
            ? 0
            : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("Unsigned integers become the nearest float") {
  const std::vector<std::uint32_t> data = {0, 1, 16777216, 16777217, UINT32_MAX};
  const ConstPlaneView view(data.data(), ScalarType::kUint32, 5, 1);
  CHECK(read(view, 0, 0, 5) == std::vector<float>{0.0F, 1.0F, 16777216.0F, 16777216.0F, 4294967296.0F});
}

TEST_CASE("Interleaved channels of half and float are read in place") {
  const std::vector<float> rgb = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};  // 2x2
  const ConstPlaneView green(rgb.data() + 1, 2, 2, 12);
  CHECK(green.row_stride() == 24);
  CHECK(read(green, 0, 0, 2) == std::vector<float>{2, 5});
  CHECK(read(green, 1, 0, 2) == std::vector<float>{8, 11});
  const std::vector<std::uint16_t> half_pairs = {0x3C00, 0xFFFF, 0x4000,
                                                 0xFFFF, 0x4200, 0xFFFF};  // 1 2 3, each with a NaN
  CHECK(read({half_pairs.data(), ScalarType::kFloat16, 3, 1, 4}, 0, 0, 3) == std::vector<float>{1, 2, 3});
}

TEST_CASE("Rows and pixels may run backwards") {
  const std::vector<float> data = {1, 2, 3, 4, 5, 6};  // 3x2
  const ConstPlaneView bottom_up(data.data() + 3, 3, 2, 0, -12);
  CHECK(read(bottom_up, 0, 0, 3) == std::vector<float>{4, 5, 6});
  CHECK(read(bottom_up, 1, 1, 2) == std::vector<float>{2, 3});
  const ConstPlaneView mirrored(data.data() + 2, 3, 2, -4, 12);
  CHECK(read(mirrored, 0, 0, 3) == std::vector<float>{3, 2, 1});
  CHECK(mirrored.at(2, 1) == 4.0F);
}

TEST_CASE("Strides need not be multiples of the element's size") {
  constexpr std::ptrdiff_t kPixel = 7;
  constexpr std::ptrdiff_t kRow = 31;
  std::vector<std::byte> bytes(1 + 2 * kRow);
  const PlaneView writable(reinterpret_cast<float*>(bytes.data() + 1), 4, 2, kPixel, kRow);
  const std::array<float, 4> first = {1, 2, 3, 4};
  const std::array<float, 3> second = {-5, -6, -7};
  writable.write_row(0, 0, 4, first.data());
  writable.write_row(1, 1, 3, second.data());
  const ConstPlaneView view = writable;
  CHECK(read(view, 0, 0, 4) == std::vector<float>{1, 2, 3, 4});
  CHECK(read(view, 1, 0, 4) == std::vector<float>{0, -5, -6, -7});
}

TEST_CASE("Writing through a view leaves the pixels beside it alone") {
  std::vector<float> rgb(18, 9.0F);  // 3x2
  const PlaneView red(rgb.data(), 3, 2, 12);
  const std::array<float, 2> values = {1, 2};
  red.write_row(1, 1, 2, values.data());
  red.at(0, 0) = 5;
  CHECK(rgb == std::vector<float>{5, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 1, 9, 9, 2, 9, 9});
  CHECK(static_cast<ConstPlaneView>(red).at(2, 1) == 2.0F);
}

TEST_CASE("Plane starts at zero, with rows aligned to 64 bytes") {
  for (const int width : {1, 15, 16, 17, 32, 100, 1024}) {
    CAPTURE(width);
    Plane plane(width, 3);
    REQUIRE(plane);
    CHECK(plane.width() == width);
    CHECK(plane.height() == 3);
    CHECK(plane.row_stride() >= std::ptrdiff_t{4} * width);
    for (int y = 0; y < 3; ++y) {
      CHECK(reinterpret_cast<std::uintptr_t>(plane.row(y)) % 64 == 0);
      CHECK(read(std::as_const(plane).view(), y, 0, width) == std::vector<float>(static_cast<std::size_t>(width)));
    }
    plane.view().at(width - 1, 2) = 3;
    CHECK(plane.row(2)[width - 1] == 3.0F);
    CHECK(std::as_const(plane).row(2)[width - 1] == 3.0F);
  }
}

TEST_CASE("Moving a Plane keeps its memory where it is") {
  Plane plane(5, 4);
  plane.row(3)[4] = 2;
  const float* memory = plane.row(0);
  Plane moved = std::move(plane);
  CHECK(moved.row(0) == memory);
  CHECK(moved.view().at(4, 3) == 2.0F);
  Plane assigned(1, 1);
  assigned = std::move(moved);
  CHECK(assigned.row(0) == memory);
  CHECK(assigned.width() == 5);
  CHECK(assigned.height() == 4);
}

TEST_CASE("A triple is one block of memory that lives as long as any of its planes") {
  Plane last;
  {
    std::array<Plane, 3> planes = Plane::triple(5, 3);
    for (const Plane& plane : planes) {
      CHECK((plane.width() == 5 && plane.height() == 3));
      CHECK(reinterpret_cast<std::uintptr_t>(plane.row(0)) % 64 == 0);
    }
    CHECK(planes[1].row(0) - planes[0].row(0) == planes[2].row(0) - planes[1].row(0));
    CHECK(planes[1].row(0) - planes[0].row(0) >= 3 * planes[0].row_stride() / 4);
    planes[0].row(2)[4] = 1;
    planes[2].row(0)[0] = 3;
    CHECK(planes[1].row(0)[0] == 0);
    last = std::move(planes[2]);
  }
  CHECK(last.row(0)[0] == 3);  // AddressSanitizer would see a block that is gone
  CHECK(last.row(2)[4] == 0);
}
