// SPDX-License-Identifier: Apache-2.0
#include "fixture.hpp"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace fixture {
namespace {

std::uint32_t hash(std::uint32_t value) {
  value ^= value >> 16;
  value *= 0x7feb352dU;
  value ^= value >> 15;
  value *= 0x846ca68bU;
  return value ^ (value >> 16);
}

std::uint32_t hash_name(const std::string& name) {
  std::uint32_t value = 1;
  for (const char c : name) value = hash(value * 31 + static_cast<unsigned char>(c));
  return value;
}

std::size_t size_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// One pixel of a channel in the file's type.
void store(const ChannelSpec& channel, int x, int y, unsigned char* to) {
  const float value = value_of(channel.name, x, y);
  const half short_value(value);
  const auto whole = static_cast<std::uint32_t>(value);
  const std::uint32_t bits = hash(hash_name(channel.name) + static_cast<std::uint32_t>(x * 7919 + y));
  const void* from = &value;
  if (channel.type == Imf::HALF) from = &short_value;
  if (channel.type == Imf::UINT) from = &whole;
  std::memcpy(to, channel.any_bits ? static_cast<const void*>(&bits) : from, size_of(channel.type));
}

std::vector<std::vector<unsigned char>> pixels(const PartSpec& part, int width, int height, Imf::FrameBuffer& buffer) {
  std::vector<std::vector<unsigned char>> planes;
  for (const ChannelSpec& channel : part.channels) {
    const std::size_t size = size_of(channel.type);
    auto& plane = planes.emplace_back(size * static_cast<std::size_t>(width * height));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) store(channel, x, y, &plane[size * static_cast<std::size_t>(y * width + x)]);
    }
    // Subsampled channels just read the same plane more sparsely.
    buffer.insert(channel.name, Imf::Slice::Make(channel.type, plane.data(), Imath::V2i(part.window[0], part.window[1]),
                                                 std::int64_t{width}, std::int64_t{height}, std::size_t{0},
                                                 std::size_t{0}, channel.sampling, channel.sampling));
  }
  return planes;
}

void write_deep(Imf::MultiPartOutputFile& file, int index, const PartSpec& part, int width, int height) {
  const auto w = static_cast<std::size_t>(width);
  const std::size_t count = w * static_cast<std::size_t>(height);
  std::vector<unsigned int> counts(count);
  std::vector<float> samples(2 * count);
  std::vector<const float*> starts(count);
  for (std::size_t i = 0; i < count; ++i) {
    counts[i] = static_cast<unsigned int>(i % 3);
    starts[i] = &samples[2 * i];
    samples[2 * i] = static_cast<float>(i);
    samples[2 * i + 1] = -static_cast<float>(i);
  }
  const auto origin = (part.window[0] + part.window[1] * static_cast<std::ptrdiff_t>(width));
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - origin),
                                           sizeof(unsigned int), sizeof(unsigned int) * w));
  for (const ChannelSpec& channel : part.channels) {
    buffer.insert(channel.name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(starts.data() - origin),
                                               sizeof(float*), sizeof(float*) * w, sizeof(float)));
  }
  Imf::DeepScanLineOutputPart output(file, index);
  output.setFrameBuffer(buffer);
  output.writePixels(height);
}

Imf::Header header_for(const PartSpec& part) {
  const Imath::Box2i window({part.window[0], part.window[1]}, {part.window[2], part.window[3]});
  const Imath::Box2i display({-100, -100}, {200, 200});
  Imf::Header header(display, window);
  header.compression() = part.compression;
  if (!part.name.empty()) header.setName(part.name);
  const bool tiled = part.storage == Storage::kTiles || part.storage == Storage::kMipmap;
  header.setType(part.storage == Storage::kDeep ? Imf::DEEPSCANLINE : tiled ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  if (tiled) {
    header.setTileDescription(
        Imf::TileDescription(8, 5, part.storage == Storage::kMipmap ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL));
  }
  for (const ChannelSpec& channel : part.channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type, channel.sampling, channel.sampling));
  }
  if (part.edit) part.edit(header);
  return header;
}

void write_tiles(Imf::MultiPartOutputFile& file, int index, const PartSpec& part) {
  Imf::TiledOutputPart output(file, index);
  for (int level = 0; level < output.numLevels(); ++level) {
    Imf::FrameBuffer buffer;
    const auto planes = pixels(part, output.levelWidth(level), output.levelHeight(level), buffer);
    output.setFrameBuffer(buffer);
    output.writeTiles(0, output.numXTiles(level) - 1, 0, output.numYTiles(level) - 1, level);
  }
}

}  // namespace

float value_of(const std::string& channel, int x, int y) {
  return static_cast<float>(hash_name(channel) % 61U) + 0.25F * static_cast<float>(x) + 8.0F * static_cast<float>(y) +
         1;
}

std::vector<ChannelSpec> layer(const std::string& name, const std::string& components, Imf::PixelType type) {
  std::vector<ChannelSpec> channels;
  for (const char c : components) channels.push_back({(name.empty() ? "" : name + ".") + c, type});
  return channels;
}

std::vector<ChannelSpec> operator+(std::vector<ChannelSpec> a, const std::vector<ChannelSpec>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<ChannelSpec> colour_channels(Imf::PixelType type) {
  return layer("", "RGB", type) + layer("variance", "RGB", type) + std::vector{ChannelSpec{"sampleCount", Imf::UINT}};
}

std::vector<ChannelSpec> native_channels() {
  return colour_channels() + layer("albedo", "RGB", Imf::HALF) + layer("albedo.variance", "RGB", Imf::HALF) +
         layer("normal", "XYZ", Imf::HALF) + layer("normal.variance", "XYZ", Imf::HALF) +
         layer("depth", "Z", Imf::FLOAT) + layer("depth.variance", "Z", Imf::FLOAT);
}

void write_file(const std::string& path, const std::vector<PartSpec>& parts) {
  std::vector<Imf::Header> headers;
  headers.reserve(parts.size());
  for (const PartSpec& part : parts) headers.push_back(header_for(part));
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartSpec& part = parts[i];
    const int width = part.window[2] - part.window[0] + 1;
    const int height = part.window[3] - part.window[1] + 1;
    const int index = static_cast<int>(i);
    if (part.storage == Storage::kDeep) {
      write_deep(file, index, part, width, height);
    } else if (part.storage != Storage::kScanlines) {
      write_tiles(file, index, part);
    } else {
      Imf::FrameBuffer buffer;
      const auto planes = pixels(part, width, height, buffer);
      Imf::OutputPart output(file, index);
      output.setFrameBuffer(buffer);
      output.writePixels(height);
    }
  }
}

RawChannel read_raw(const std::string& path, int part, const std::string& channel) {
  Imf::MultiPartInputFile file(path.c_str());
  const Imf::Header& header = file.header(part);
  const Imath::Box2i window = header.dataWindow();
  const auto width = static_cast<std::size_t>(std::int64_t{window.max.x} - window.min.x + 1);
  const auto height = static_cast<std::size_t>(std::int64_t{window.max.y} - window.min.y + 1);
  RawChannel raw{header.channels()[channel].type, {}};
  if (Imf::isDeepData(header.type())) {
    Imf::DeepScanLineInputPart input(file, part);
    std::vector<unsigned int> counts(width * height);
    std::vector<float> samples(2 * width * height);
    std::vector<float*> starts(width * height);
    for (std::size_t i = 0; i < starts.size(); ++i) starts[i] = &samples[2 * i];
    const std::ptrdiff_t origin = window.min.x + window.min.y * static_cast<std::ptrdiff_t>(width);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - origin), 4, 4 * width));
    buffer.insert(channel, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(starts.data() - origin), sizeof(float*),
                                          sizeof(float*) * width, sizeof(float)));
    input.setFrameBuffer(buffer);
    input.readPixelSampleCounts(window.min.y, window.max.y);
    input.readPixels(window.min.y, window.max.y);
    raw.bytes.resize(4 * (counts.size() + samples.size()));
    std::memcpy(raw.bytes.data(), counts.data(), 4 * counts.size());
    std::memcpy(raw.bytes.data() + 4 * counts.size(), samples.data(), 4 * samples.size());
    return raw;
  }
  raw.bytes.resize(width * height * size_of(raw.type));
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice::Make(raw.type, raw.bytes.data(), window));
  Imf::InputPart input(file, part);
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return raw;
}

std::vector<std::string> channel_names(const std::string& path, int part) {
  const Imf::Header header = header_of(path, part);
  std::vector<std::string> names;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) names.emplace_back(it.name());
  return names;
}

Imf::Header header_of(const std::string& path, int part) { return Imf::MultiPartInputFile(path.c_str()).header(part); }

int parts_of(const std::string& path) { return Imf::MultiPartInputFile(path.c_str()).parts(); }

std::vector<unsigned char> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::vector<unsigned char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

stein::DenoiseResult result_for(const stein::Frame& frame) {
  stein::DenoiseResult result;
  float base = 0;
  const auto plane = [&] {
    stein::Plane made(frame.width, frame.height);
    base += 1000;
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) made.row(y)[x] = base + static_cast<float>(y * frame.width + x);
    }
    return made;
  };
  for (auto& colour : result.colour) colour = plane();
  for (auto& error : result.error) error = plane();
  result.choice = plane();
  result.density = plane();
  return result;
}

bool holds(const stein::ConstPlaneView& view, const std::string& channel) {
  if (!view) return false;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      const float expected = value_of(channel, x, y);
      const bool whole = view.type() == stein::ScalarType::kUint32;
      if (view.at(x, y) != (whole ? static_cast<float>(static_cast<std::uint32_t>(expected)) : expected)) return false;
    }
  }
  return true;
}

}  // namespace fixture
