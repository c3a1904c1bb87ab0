// SPDX-License-Identifier: Apache-2.0
#include "parsing.hpp"

#include <cmath>
#include <cstddef>

#include "stein/error.hpp"

namespace stein::cli {

void fail_argument(const std::string& option, const std::string& text, const std::string& expected) {
  throw Error(ErrorCode::kInvalidArgument, option + ": '" + text + "' is not " + expected);
}

bool split(std::string_view text, char separator, std::string_view& before, std::string_view& after) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos) {
    return false;
  }
  before = text.substr(0, at);
  after = text.substr(at + 1);
  return true;
}

std::int64_t parse_bytes(const std::string& option, const std::string& text) {
  constexpr std::string_view kUnits = "KMGT";
  constexpr double kMost = 1e18;
  const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
  const bool has_unit = unit != std::string_view::npos;
  double bytes = 0;
  const bool is_number = parse_number(std::string_view(text).substr(0, text.size() - (has_unit ? 1 : 0)), bytes);
  if (has_unit) bytes *= std::pow(1024.0, static_cast<double>(unit + 1));
  if (!is_number || !(bytes >= 1) || bytes > kMost)
    fail_argument(option, text, "a number of bytes, such as 512M or 2G");
  return static_cast<std::int64_t>(bytes);
}

std::array<int, 2> parse_size(const std::string& option, const std::string& text) {
  std::string_view width;
  std::string_view height;
  std::array<int, 2> size{};
  if (!split(text, 'x', width, height) || !parse_number(width, size[0]) || !parse_number(height, size[1])) {
    fail_argument(option, text, "WIDTHxHEIGHT in pixels, such as 64x64");
  }
  return size;
}

}  // namespace stein::cli
