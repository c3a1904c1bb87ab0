// SPDX-License-Identifier: Apache-2.0
#include "arguments.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>

#include "stein/error.hpp"

namespace stein::cli {
namespace {

[[noreturn]] void fail(const std::string& option, const std::string& text, const std::string& expected) {
  throw Error(ErrorCode::kInvalidArgument, option + ": '" + text + "' is not " + expected);
}

// The whole text must be the number.
template <class Number>
bool parse(std::string_view text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

// Splits at the first separator; false if there is none.
bool split(std::string_view text, char separator, std::string_view& before, std::string_view& after) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos) {
    return false;
  }
  before = text.substr(0, at);
  after = text.substr(at + 1);
  return true;
}

}  // namespace

std::array<int, 2> parse_tile(const std::string& text) {
  std::string_view width;
  std::string_view height;
  std::array<int, 2> tile{};
  if (!split(text, 'x', width, height) || !parse(width, tile[0]) || !parse(height, tile[1])) {
    fail("--tile", text, "WIDTHxHEIGHT in pixels, such as 64x64");
  }
  return tile;
}

std::pair<double, double> parse_range(const std::string& text) {
  std::string_view low_text;
  std::string_view high_text;
  double low = 0;
  double high = 0;
  if (!split(text, ',', low_text, high_text) || !parse(low_text, low) || !parse(high_text, high) ||
      !std::isfinite(low) || !std::isfinite(high) || low >= high) {
    fail("--range", text, "LOW,HIGH with LOW < HIGH, such as 0,0.5");
  }
  return {low, high};
}

FeatureSigma parse_feature_sigma(const std::string& text) {
  std::string_view name;
  std::string_view value;
  FeatureSigma result;
  if (!split(text, '=', name, value) || name.empty() || !parse(value, result.sigma)) {
    fail("--feature-sigma", text, "NAME=VALUE, such as normal=0.8");
  }
  result.name = name;
  return result;
}

}  // namespace stein::cli
