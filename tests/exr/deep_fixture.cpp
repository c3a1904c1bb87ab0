// SPDX-License-Identifier: Apache-2.0
#include "deep_fixture.hpp"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <half.h>

#include <cstring>
#include <map>

namespace fixture {
namespace {

/// Values of one channel in the file's type, and where those of each pixel begin.
struct DeepChannel {
  std::vector<char> bytes;
  std::vector<const char*> starts;
};

std::size_t size_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

void store(float value, Imf::PixelType type, char* to) {
  const half short_value(value);
  const auto whole = static_cast<std::uint32_t>(value);
  const void* from = &value;
  if (type == Imf::HALF) from = &short_value;
  if (type == Imf::UINT) from = &whole;
  std::memcpy(to, from, size_of(type));
}

DeepChannel make(const DeepSpec::Channel& channel, int width, int height) {
  const std::size_t size = size_of(channel.type);
  DeepChannel made;
  std::vector<std::size_t> offsets;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      offsets.push_back(made.bytes.size());
      for (std::uint32_t i = 0; i < sample_count(column, row); ++i) {
        made.bytes.resize(made.bytes.size() + size);
        store(sample_value(channel.name, column, row, i), channel.type, &made.bytes[made.bytes.size() - size]);
      }
    }
  }
  for (const std::size_t offset : offsets) made.starts.push_back(made.bytes.data() + offset);
  return made;
}

}  // namespace

std::uint32_t sample_count(int column, int row) {
  return row == 2 ? 0 : static_cast<std::uint32_t>((column * 3 + row * 7) % 5);
}

float sample_value(const std::string& channel, int column, int row, std::uint32_t i) {
  return static_cast<float>(channel.front() % 16 * 8 + channel.back() % 8 + column + 64 * static_cast<int>(i) +
                            16 * row);
}

std::vector<float> row_samples(const std::vector<std::string>& channels, int width, int row) {
  std::vector<float> samples;
  for (int column = 0; column < width; ++column) {
    for (std::uint32_t i = 0; i < sample_count(column, row); ++i) {
      for (const std::string& channel : channels) samples.push_back(sample_value(channel, column, row, i));
    }
  }
  return samples;
}

std::vector<std::uint32_t> row_counts(int width, int row) {
  std::vector<std::uint32_t> counts;
  for (int column = 0; column < width; ++column) counts.push_back(sample_count(column, row));
  return counts;
}

void write_deep_file(const std::string& path, const DeepSpec& spec) {
  const Imath::Box2i window({spec.window[0], spec.window[1]}, {spec.window[2], spec.window[3]});
  const int width = window.max.x - window.min.x + 1;
  const int height = window.max.y - window.min.y + 1;
  Imf::Header header(Imath::Box2i({-50, -50}, {50, 50}), window);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = spec.compression;
  Imf::addOwner(header, "a studio");
  std::vector<std::uint32_t> counts;
  for (int row = 0; row < height; ++row) {
    for (const std::uint32_t count : row_counts(width, row)) counts.push_back(count);
  }
  const std::ptrdiff_t origin = window.min.x + window.min.y * static_cast<std::ptrdiff_t>(width);
  const auto row_length = static_cast<std::size_t>(width);
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - origin), 4, 4 * row_length));
  std::map<std::string, DeepChannel> made;
  for (const DeepSpec::Channel& channel : spec.channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type));
    DeepChannel& values = made[channel.name] = make(channel, width, height);
    buffer.insert(channel.name, Imf::DeepSlice(channel.type, reinterpret_cast<char*>(values.starts.data() - origin),
                                               sizeof(char*), sizeof(char*) * row_length, size_of(channel.type)));
  }
  Imf::DeepScanLineOutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(height);
}

}  // namespace fixture
