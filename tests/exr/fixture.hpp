// SPDX-License-Identifier: Apache-2.0
//
// Small OpenEXR files made in code, and a plain reader of their bytes to compare with.
#pragma once

#include <ImfCompression.h>
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stein/exr.hpp"
#include "support/temporary_folder.hpp"

namespace fixture {

using ::TemporaryFolder;

struct ChannelSpec {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  bool any_bits = false;  ///< every bit pattern, also NaNs; otherwise `value_of`
  int sampling = 1;
};

enum class Storage { kScanlines, kTiles, kMipmap, kDeep };

struct PartSpec {
  std::string name;
  std::vector<ChannelSpec> channels;
  std::array<int, 4> window = {0, 0, 22, 12};
  Storage storage = Storage::kScanlines;
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  std::function<void(Imf::Header&)> edit = {};  ///< last word on the header
};

/// What a channel holds at column x and row y of its window; exact in half.
[[nodiscard]] float value_of(const std::string& channel, int x, int y);

/// R, G, B, their variances, sampleCount; every plane `type`, but sampleCount, which is uint.
[[nodiscard]] std::vector<ChannelSpec> colour_channels(Imf::PixelType type = Imf::FLOAT);
/// colour_channels and half albedo and normal, float depth, each with variances.
[[nodiscard]] std::vector<ChannelSpec> native_channels();
/// `<layer>.<component>` for each letter of `components`.
[[nodiscard]] std::vector<ChannelSpec> layer(const std::string& name, const std::string& components,
                                             Imf::PixelType type);
[[nodiscard]] std::vector<ChannelSpec> operator+(std::vector<ChannelSpec> a, const std::vector<ChannelSpec>& b);

void write_file(const std::string& path, const std::vector<PartSpec>& parts);

/// The bytes of a channel as the file's type, row by row (deep: the samples of all pixels; tiles: level 0).
struct RawChannel {
  Imf::PixelType type = Imf::FLOAT;
  std::vector<unsigned char> bytes;
  bool operator==(const RawChannel&) const = default;
};
[[nodiscard]] RawChannel read_raw(const std::string& path, int part, const std::string& channel);
[[nodiscard]] std::vector<std::string> channel_names(const std::string& path, int part = 0);
[[nodiscard]] Imf::Header header_of(const std::string& path, int part = 0);
[[nodiscard]] int parts_of(const std::string& path);

[[nodiscard]] std::vector<unsigned char> bytes_of(const std::string& path);
void write_bytes(const std::string& path, const std::vector<unsigned char>& bytes);

/// A result of distinct values for a frame.
[[nodiscard]] stein::DenoiseResult result_for(const stein::Frame& frame);

/// Whether the view holds value_of(channel) everywhere.
[[nodiscard]] bool holds(const stein::ConstPlaneView& view, const std::string& channel);

}  // namespace fixture
