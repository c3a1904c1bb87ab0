// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace stein {

/// `count` zeros at an address that is a multiple of 64; free with std::free(raw). From calloc: large blocks come as
/// untouched zero pages, so that it is the threads that use them, and not the one that allocates, who wait for the
/// memory.
struct AlignedZeros {
  explicit AlignedZeros(std::size_t count) {
    constexpr std::uintptr_t kAlignment = 64;
    raw = std::calloc(count + kAlignment / sizeof(float), sizeof(float));
    if (raw == nullptr) throw std::bad_alloc();
    const auto address = reinterpret_cast<std::uintptr_t>(raw);
    data = static_cast<float*>(raw) + (kAlignment - address % kAlignment) % kAlignment / sizeof(float);
  }
  void* raw = nullptr;
  float* data = nullptr;
};

}  // namespace stein
