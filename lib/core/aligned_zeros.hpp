// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

#include "stein/memory.hpp"

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

/// The same from `memory`, or from the heap where there is none; given back with the last copy.
[[nodiscard]] inline std::shared_ptr<float> shared_zeros(std::size_t count, Memory* memory,
                                                         Memory::Use use = Memory::Use::kImage) {
  if (memory != nullptr) {
    const std::shared_ptr<void> block = memory->allocate(count * sizeof(float), use);
    return {block, static_cast<float*>(block.get())};
  }
  const AlignedZeros zeros(count);
  return {std::shared_ptr<void>(zeros.raw, std::free), zeros.data};
}

}  // namespace stein
