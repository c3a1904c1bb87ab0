// SPDX-License-Identifier: Apache-2.0
#include "exec/buffers.hpp"

#include <cstdint>
#include <set>

#include "catch.hpp"

namespace stein::exec {
namespace {

std::uintptr_t address(const float* p) { return reinterpret_cast<std::uintptr_t>(p); }

// The cache line that an address falls into, modulo a page: equal lines of many streams fight for one cache set.
std::uintptr_t line_in_page(const float* p) { return address(p) % 4096 / 64; }

bool is_zero(const float* first, int count) {
  for (int i = 0; i < count; ++i) {
    if (first[i] != 0.0F) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("float buffer: aligned, zero at first, keeps its contents while it suffices") {
  FloatBuffer buffer;
  CHECK(buffer.data() == nullptr);
  CHECK(buffer.size() == 0);
  float* data = buffer.reserve(1000);
  REQUIRE(address(data) % 64 == 0);
  CHECK(is_zero(data, 1000));
  data[999] = 3.0F;
  CHECK(buffer.reserve(10) == data);
  CHECK(buffer.reserve(1000)[999] == 3.0F);
  CHECK(buffer.size() == 1000);
  CHECK(is_zero(buffer.reserve(5000), 5000));
  CHECK(buffer.size() == 5000);
}

TEST_CASE("row ring: rows are aligned, come back after `capacity` rows, and planes fall into different cache sets") {
  constexpr int kPlanes = 12;
  for (const int width : {1, 15, 16, 17, 100, 992, 1000, 1024, 1920, 4096}) {
    for (const int capacity : {1, 2, 7, 64}) {
      const RowRing ring(kPlanes, width, capacity);
      CHECK(ring.capacity() == capacity);
      std::set<std::uintptr_t> lines;
      for (int p = 0; p < kPlanes; ++p) {
        lines.insert(line_in_page(ring.row(p, 0)));
        CHECK(address(ring.row(p, 0)) % 64 == 0);
        CHECK(address(ring.row(p, capacity - 1)) % 64 == 0);
        CHECK(ring.row(p, 3) == ring.row(p, 3 + 5 * capacity));
      }
      CHECK(lines.size() == kPlanes);
      if (capacity > 1) CHECK(line_in_page(ring.row(0, 0)) != line_in_page(ring.row(0, 1)));
    }
  }
}

TEST_CASE("row ring: rows and planes do not overlap, and their padding is readable and zero") {
  for (const int width : {1, 16, 37, 64}) {
    constexpr int kPlanes = 3;
    constexpr int kCapacity = 5;
    const RowRing ring(kPlanes, width, kCapacity);
    for (int p = 0; p < kPlanes; ++p) {
      for (int y = 0; y < kCapacity; ++y) {
        for (int x = 0; x < width; ++x) ring.row(p, y)[x] = static_cast<float>(1 + x + 100 * (y + 10 * p));
      }
    }
    for (int p = 0; p < kPlanes; ++p) {
      for (int y = 0; y < kCapacity; ++y) {
        int wrong = 0;
        for (int x = 0; x < width; ++x) {
          wrong += ring.row(p, y)[x] == static_cast<float>(1 + x + 100 * (y + 10 * p)) ? 0 : 1;
        }
        CHECK(wrong == 0);
        CHECK(is_zero(ring.row(p, y) - RowRing::kPadding, RowRing::kPadding));
        CHECK(is_zero(ring.row(p, y) + width, RowRing::kPadding));
      }
    }
  }
}

TEST_CASE("row ring: whole vectors may be written at the end of a row without reaching another row") {
  for (const int width : {1, 16, 37}) {
    const RowRing ring(2, width, 3);
    const int written = (width + 15) / 16 * 16;
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < written; ++x) ring.row(0, y)[x] = 9.0F;
    }
    for (int y = 0; y < 3; ++y) {
      CHECK(is_zero(ring.row(0, y) - RowRing::kPadding, RowRing::kPadding));
      CHECK(is_zero(ring.row(1, y) - RowRing::kPadding, RowRing::kPadding + written));
    }
  }
}

TEST_CASE("tiles: one pitch, offsets of neighbours, and planes in different cache sets") {
  constexpr int kPlanes = 10;
  for (const int width : {16, 64, 128, 1024}) {
    for (const int halo : {0, 1, 16, 17}) {
      const TileLayout layout(width, 32, halo);
      TilePlanes planes;
      planes.reserve(layout, kPlanes);
      CHECK(layout.pitch % 16 == 0);
      CHECK(layout.pitch / 16 % 2 == 1);  // rows, too, fall into different cache sets
      CHECK(planes.layout().pitch == layout.pitch);
      std::set<std::uintptr_t> lines;
      for (int p = 0; p < kPlanes; ++p) {
        CHECK(address(planes.row(p, 0)) % 64 == 0);
        CHECK(address(planes.row(p, -halo)) % 64 == 0);
        lines.insert(line_in_page(planes.row(p, 0)));
      }
      CHECK(lines.size() == kPlanes);
      CHECK(planes.row(1, 5) + layout.offset(-3, halo) == planes.row(1, 5 + halo) - 3);
      CHECK(planes.row(1, 5) + layout.offset(7, -halo) == planes.row(1, 5 - halo) + 7);
    }
  }
}

TEST_CASE("tiles: a tile, its halo and a vector more belong to one row alone, and are zero at first") {
  for (const int halo : {0, 3, 16, 21}) {
    constexpr int kWidth = 48;
    constexpr int kHeight = 6;
    const TileLayout layout(kWidth, kHeight, halo);
    TilePlanes planes;
    planes.reserve(layout, 3);
    const auto value = [&](int p, int y) { return static_cast<float>(1 + y + halo + 1000 * p); };
    int not_zero = 0;
    for (int p = 0; p < 3; ++p) {
      for (int y = -halo; y < kHeight + halo; ++y) {
        for (int x = -halo; x < kWidth + halo + 16; ++x) {
          not_zero += planes.row(p, y)[x] == 0.0F ? 0 : 1;
          planes.row(p, y)[x] = value(p, y);
        }
      }
    }
    CHECK(not_zero == 0);
    int wrong = 0;
    for (int p = 0; p < 3; ++p) {
      for (int y = -halo; y < kHeight + halo; ++y) {
        for (int x = -halo; x < kWidth + halo + 16; ++x) wrong += planes.row(p, y)[x] == value(p, y) ? 0 : 1;
      }
    }
    CHECK(wrong == 0);
  }
}

}  // namespace stein::exec
