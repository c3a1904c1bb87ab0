// SPDX-License-Identifier: Apache-2.0
#include "frame_numbers.hpp"

#include <charconv>
#include <cstddef>
#include <string_view>
#include <system_error>
#include <unordered_set>

#include "parsing.hpp"

namespace stein::cli {
namespace {

constexpr long kMostFrames = 1'000'000;

struct Range {
  int first = 0;
  int last = 0;
  int step = 1;
};

/// Takes a number, which may be negative, from the front of the text.
bool take_number(std::string_view& text, int& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return true;
}

bool take(std::string_view& text, char expected) {
  if (text.empty() || text.front() != expected) return false;
  text.remove_prefix(1);
  return true;
}

/// "7", "1-10", "20-30:2", "-10--1"
bool parse_range(std::string_view text, Range& range) {
  if (!take_number(text, range.first)) return false;
  range.last = range.first;
  if (take(text, '-')) {
    if (!take_number(text, range.last)) return false;
    if (take(text, ':') && !take_number(text, range.step)) return false;
  }
  return text.empty() && range.first <= range.last && range.step >= 1;
}

/// A place for a number in a path: as many characters as it takes, and the digits that it asks for.
struct Place {
  std::size_t length = 0;
  std::size_t width = 0;
};

Place place_at(std::string_view text) {
  Place place;
  while (place.length < text.size() && text[place.length] == '#') ++place.length;
  if (place.length > 0) return {place.length, place.length};
  if (!take(text, '%')) return {};
  const std::string_view digits = text.substr(0, text.find_first_not_of("0123456789"));
  constexpr std::size_t kMostDigits = 2;
  const std::size_t end = digits.size();
  if (end >= text.size() || text[end] != 'd' || end > kMostDigits) return {};
  int width = 0;
  if (end > 0 && (digits.front() != '0' || !parse_number(digits, width))) return {};  // %4d would pad with spaces
  return {end + 2, static_cast<std::size_t>(width)};
}

std::string padded(int number, std::size_t width) {
  std::string digits = std::to_string(number);
  const std::size_t sign = number < 0 ? 1 : 0;
  if (digits.size() < width) digits.insert(sign, width - digits.size(), '0');
  return digits;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
  std::vector<int> frames;
  std::unordered_set<int> seen;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    Range range;
    if (!parse_range(rest.substr(0, comma), range)) {
      fail_argument("--frames", text, "a list of frames, such as 7 or 1-10,20-30:2");
    }
    for (long frame = range.first; frame <= range.last; frame += range.step) {
      if (static_cast<long>(frames.size()) >= kMostFrames) fail_argument("--frames", text, "at most 1000000 frames");
      if (seen.insert(static_cast<int>(frame)).second) frames.push_back(static_cast<int>(frame));
    }
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  return frames;
}

std::string frames_text(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(frames[i]);
    if (last > i) text += "-" + std::to_string(frames[last]);
    i = last + 1;
  }
  return text;
}

bool has_frame_place(const std::string& path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (place_at(std::string_view(path).substr(i)).length > 0) return true;
  }
  return false;
}

std::string frame_path(const std::string& path, int frame) {
  std::string result;
  for (std::size_t i = 0; i < path.size();) {
    const Place place = place_at(std::string_view(path).substr(i));
    result += place.length > 0 ? padded(frame, place.width) : std::string(1, path[i]);
    i += place.length > 0 ? place.length : 1;
  }
  return result;
}

}  // namespace stein::cli
