// SPDX-License-Identifier: Apache-2.0
//
// What a fuzz target makes of its bytes, and the function that each of them defines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

namespace stein::fuzz {

/// Bytes as text, line by line; the text ends where the bytes do.
class Lines {
 public:
  Lines(const std::uint8_t* bytes, std::size_t size) : rest_(reinterpret_cast<const char*>(bytes), size) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

  std::string next() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string line(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return line;
  }

 private:
  std::string_view rest_;
};

/// Bytes as values; zeros once they are used up.
class Values {
 public:
  Values(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes), size_(size) {}

  [[nodiscard]] bool at_end() const { return size_ == 0; }

  template <class T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof value, size_);
    std::memcpy(&value, bytes_, count);
    skip(count);
    return value;
  }

  /// Up to a zero or a line's end.
  std::string text() {
    const auto* end = std::find_if(bytes_, bytes_ + size_, [](std::uint8_t b) { return b == 0 || b == '\n'; });
    std::string text(bytes_, end);
    skip(std::min(text.size() + 1, size_));
    return text;
  }

 private:
  void skip(std::size_t count) {
    bytes_ += count;
    size_ -= count;
  }

  const std::uint8_t* bytes_;
  std::size_t size_;
};

}  // namespace stein::fuzz
