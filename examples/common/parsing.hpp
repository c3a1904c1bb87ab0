// SPDX-License-Identifier: Apache-2.0
//
// Texts of arguments into numbers.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace stein::cli {

/// @throws Error kInvalidArgument "OPTION: 'TEXT' is not EXPECTED".
[[noreturn]] void fail_argument(const std::string& option, const std::string& text, const std::string& expected);

/// The whole text must be the number.
template <class Number>
[[nodiscard]] bool parse_number(std::string_view text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

/// Splits at the first separator; false if there is none.
[[nodiscard]] bool split(std::string_view text, char separator, std::string_view& before, std::string_view& after);

/// Bytes, such as "512M" or "1.5G": K, M, G and T are powers of 1024. @throws Error kInvalidArgument naming the option.
[[nodiscard]] std::int64_t parse_bytes(const std::string& option, const std::string& text);

/// "64x32". @throws Error kInvalidArgument naming the option.
[[nodiscard]] std::array<int, 2> parse_size(const std::string& option, const std::string& text);

}  // namespace stein::cli
