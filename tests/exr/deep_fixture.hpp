// SPDX-License-Identifier: Apache-2.0
//
// Small files of raw samples, written with OpenEXR alone, whatever stein would write.
#pragma once

#include <ImfCompression.h>
#include <ImfPixelType.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fixture {

struct DeepSpec {
  struct Channel {
    std::string name;
    Imf::PixelType type = Imf::FLOAT;
  };
  std::vector<Channel> channels;
  std::array<int, 4> window = {0, 0, 8, 6};
  Imf::Compression compression = Imf::ZIPS_COMPRESSION;
};

/// Counts of 0 to 4 that vary from pixel to pixel; a row of zeros in between.
[[nodiscard]] std::uint32_t sample_count(int column, int row);

/// What sample i of a pixel (columns and rows from 0) holds; whole, and exact in half.
[[nodiscard]] float sample_value(const std::string& channel, int column, int row, std::uint32_t i);

/// All samples of a row as stein delivers them.
[[nodiscard]] std::vector<float> row_samples(const std::vector<std::string>& channels, int width, int row);
[[nodiscard]] std::vector<std::uint32_t> row_counts(int width, int row);

void write_deep_file(const std::string& path, const DeepSpec& spec);

}  // namespace fixture
