// SPDX-License-Identifier: Apache-2.0
#include "parsing.hpp"

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
