// SPDX-License-Identifier: Apache-2.0
#include "exr/header_walk.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <utility>

#include "stein/error.hpp"

namespace stein::exr {
namespace {

constexpr std::int32_t kMagic = 20000630;
constexpr std::int32_t kMultiPartFlag = 0x1000;
constexpr std::int64_t kChannelBytes = 16;  // after the name: type, flags, sampling

// Types whose values have one size; all others are read by the size that stands before them.
constexpr std::array<std::pair<std::string_view, std::int32_t>, 24> kFixedSizes = {{
    {"box2i", 16},
    {"box2f", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33f", 36},
    {"m33d", 72},
    {"m44f", 64},
    {"m44d", 128},
    {"rational", 8},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2i", 8},
    {"v2f", 8},
    {"v2d", 16},
    {"v3i", 12},
    {"v3f", 12},
    {"v3d", 24},
}};

class HeaderWalk {
 public:
  HeaderWalk(const std::string& path, std::int64_t size) : path_(path), file_(path, std::ios::binary), size_(size) {}

  void check() {
    if (!file_) fail("it cannot be opened");
    if (read_int() != kMagic) fail("it is not an OpenEXR file");
    const bool multi_part = (read_int() & kMultiPartFlag) != 0;
    // An empty header ends the list of a multi-part file.
    bool more = walk_header();
    while (multi_part && more) more = walk_header();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kIo, "cannot read '" + path_ + "': " + why);
  }

  /// False if it has no attributes.
  bool walk_header() {
    bool any = false;
    for (std::string name = read_string(); !name.empty(); name = read_string()) {
      any = true;
      check_attribute(name);
    }
    return any;
  }

  void check_attribute(const std::string& name) {
    const std::string type = read_string();
    const std::int32_t length = read_int();
    const std::int64_t begin = file_.tellg();
    if (length < 0 || length > size_ - begin) {
      fail("attribute " + name + " claims to be longer than the file: it is truncated or damaged");
    }
    const auto* fixed =
        std::find_if(kFixedSizes.begin(), kFixedSizes.end(), [&](const auto& f) { return f.first == type; });
    const std::int64_t end = begin + length;
    if (type == "chlist") {
      while (!read_string().empty()) skip_to(static_cast<std::int64_t>(file_.tellg()) + kChannelBytes);
      if (file_.tellg() != end) fail("attribute " + name + " has a wrong size: the file is damaged");
    } else if (fixed != kFixedSizes.end() && fixed->second != length) {
      fail("attribute " + name + " has a wrong size: the file is damaged");
    }
    skip_to(end);
  }

  void skip_to(std::int64_t position) {
    if (position > size_) fail_short();
    file_.seekg(position);
  }

  std::string read_string() {
    std::string text;
    for (int byte = next(); byte != 0; byte = next()) text += static_cast<char>(byte);
    return text;
  }

  std::int32_t read_int() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += 8) value |= static_cast<std::uint32_t>(next()) << shift;
    return static_cast<std::int32_t>(value);
  }

  int next() {
    const int byte = file_.get();
    if (byte < 0) fail_short();
    return byte;
  }

  [[noreturn]] void fail_short() const { fail("it ends within its header: it is truncated or not an OpenEXR file"); }

  const std::string& path_;
  std::ifstream file_;
  std::int64_t size_;
};

}  // namespace

void check_header_sizes(const std::string& path, std::int64_t file_size) { HeaderWalk(path, file_size).check(); }

}  // namespace stein::exr
