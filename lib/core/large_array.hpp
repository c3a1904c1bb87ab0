// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include "core/aligned_zeros.hpp"

namespace stein {

/// An array that grows with the image: from a Memory where there is one. Its elements are zero bits at first.
template <class T>
class LargeArray {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 64);

 public:
  LargeArray(std::size_t count, Memory* memory)
      : block_(shared_zeros((count * sizeof(T) + sizeof(float) - 1) / sizeof(float), memory)),
        data_(reinterpret_cast<T*>(block_.get())),
        size_(count) {}
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] T* data() noexcept { return data_; }

 private:
  std::shared_ptr<float> block_;
  T* data_;
  std::size_t size_;
};

}  // namespace stein
