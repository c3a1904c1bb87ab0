// SPDX-License-Identifier: Apache-2.0
#include "exr/source_file.hpp"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfPartType.h>
#include <ImfThreading.h>
#include <ImfTileDescription.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "exr/header_walk.hpp"

namespace stein::exr {
namespace {

constexpr std::int64_t kMaxSide = std::int64_t{1} << 20;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 30;
// OpenEXR decodes into buffers of whole chunks, also where the image fills only a corner of one.
constexpr std::int64_t kAlwaysAllowedChunkBytes = std::int64_t{64} << 20;

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kIo, "cannot read '" + path + "': " + why);
}

int chunk_lines(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 32;
  }
}

std::int64_t bytes_per_pixel(const Imf::Header& header) {
  std::int64_t bytes = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    bytes += it.channel().type == Imf::HALF ? 2 : 4;
  }
  return bytes;
}

/// Bytes of one decoded chunk.
std::int64_t chunk_bytes(const Imf::Header& header) {
  std::int64_t pixels = std::int64_t{width_of(header)} * chunk_lines(header.compression());
  if (header.hasTileDescription())
    pixels = std::int64_t{header.tileDescription().xSize} * header.tileDescription().ySize;
  return pixels * std::max<std::int64_t>(bytes_per_pixel(header), 4);
}

/// Whether the pixels of a part can come out of a file of that size. Nothing is allocated for pixels before this.
void check_plausible(const SourceFile& file, int part) {
  const Imf::Header& header = file.header(part);
  const Imath::Box2i& box = header.dataWindow();
  const std::int64_t width = std::int64_t{box.max.x} - box.min.x + 1;
  const std::int64_t height = std::int64_t{box.max.y} - box.min.y + 1;
  const std::string size = std::to_string(width) + " x " + std::to_string(height);
  if (width < 1 || height < 1) fail(file.path(part), "its data window is empty");
  if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
    fail(file.path(part), "its data window of " + size + " pixels is larger than any image stein reads (2^30 pixels)");
  }
  // Subsampled channels hold fewer samples than pixels: they are refused where they matter, and counted as empty here.
  // So is a deep part as a whole: it is never decoded, and may hold no samples.
  std::int64_t pixel_bytes = bytes_per_pixel(header);
  for (const SourceChannel& channel : file.channels()) {
    if (channel.part == part && channel.subsampled) pixel_bytes -= channel.type == Imf::HALF ? 2 : 4;
  }
  const std::int64_t ratio = largest_ratio(header.compression());
  const std::int64_t plausible =
      file.size(part) > std::numeric_limits<std::int64_t>::max() / ratio ? file.size(part) : file.size(part) * ratio;
  if (!file.is_deep(part) && pixel_bytes > 0 && width * height > plausible / pixel_bytes) {
    fail(file.path(part), "its data window of " + size + " pixels cannot fit in its " +
                              std::to_string(file.size(part)) + " bytes: it is truncated or damaged");
  }
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tiles = header.tileDescription();
    if (tiles.xSize > kMaxSide || tiles.ySize > kMaxSide) fail(file.path(part), "its tiles are larger than any image");
  }
  if (chunk_bytes(header) > std::max(plausible, kAlwaysAllowedChunkBytes)) {
    fail(file.path(part), "its chunks are larger than the file can hold: it is damaged");
  }
}

std::int64_t regular_size(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) fail(path, "no such file");
  if (!std::filesystem::is_regular_file(path, error)) fail(path, "it is not a regular file");
  const auto size = std::filesystem::file_size(path, error);
  if (error) fail(path, error.message());
  return static_cast<std::int64_t>(size);
}

}  // namespace

SourceFile::SourceFile(std::string path, const std::vector<Companion>& companions,
                       const std::function<bool(double)>& progress)
    : progress_(std::make_unique<ByteProgress>(progress)) {
  open(std::move(path), {});
  for (const Companion& companion : companions) open(companion.path, companion.name);
}

void SourceFile::open(std::string path, std::string name) {
  File& file = files_.emplace_back(File{std::move(path), std::move(name), 0, nullptr, nullptr});
  with_io_errors("read '" + file.path + "'", [&] {
    file.size = regular_size(file.path);
    check_header_sizes(file.path, file.size);
    progress_->expect(file.size);
    file.stream = std::make_unique<GuardedStream>(file.path, *progress_);
    // A table of chunks with holes is the mark of an unfinished file: not reconstructed, but reported.
    file.input = std::make_unique<Imf::MultiPartInputFile>(*file.stream, Imf::globalThreadCount(), false);
    const int first = parts();
    for (int part = 0; part < file.input->parts(); ++part) parts_.push_back({files_.size() - 1, part});
    for (int part = first; part < parts(); ++part) {
      const Imf::ChannelList& list = header(part).channels();
      for (auto it = list.begin(); it != list.end(); ++it) {
        const Imf::Channel& channel = it.channel();
        channels_.push_back({part, it.name(), channel.type, channel.xSampling != 1 || channel.ySampling != 1});
      }
    }
    for (int part = first; part < parts(); ++part) check_plausible(*this, part);
  });
}

std::string SourceFile::part_name(int part) const {
  if (!is_own(part)) return files_[at(part).file].name;
  return header(part).hasName() ? header(part).name() : std::string();
}

bool SourceFile::is_deep(int part) const { return header(part).hasType() && Imf::isDeepData(header(part).type()); }

bool SourceFile::is_tiled(int part) const { return header(part).hasTileDescription() && !is_deep(part); }

void SourceFile::require_complete(int part) const {
  if (files_[at(part).file].input->partComplete(number(part))) return;
  fail(path(part), std::string(is_tiled(part) ? "tiles" : "scanlines") + " are missing" +
                       (parts() > 1 ? " in part '" + part_name(part) + "'" : "") +
                       ": the file was not written to its end; render or copy it again");
}

std::int64_t largest_ratio(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return 1;
    case Imf::RLE_COMPRESSION:
      return 64;
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return 16;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return 250'000;  // 8x8 blocks, then deflate
    default:
      return 1400;  // deflate 1032, times 4/3 for PXR24; PIZ is below
  }
}

int width_of(const Imf::Header& header) { return header.dataWindow().max.x - header.dataWindow().min.x + 1; }
int height_of(const Imf::Header& header) { return header.dataWindow().max.y - header.dataWindow().min.y + 1; }

std::array<int, 4> window_of(const Imf::Header& header) {
  const Imath::Box2i& box = header.dataWindow();
  return {box.min.x, box.min.y, box.max.x, box.max.y};
}

ScalarType scalar_type(Imf::PixelType type) {
  if (type == Imf::HALF) return ScalarType::kFloat16;
  return type == Imf::UINT ? ScalarType::kUint32 : ScalarType::kFloat32;
}

Imf::PixelType pixel_type(ScalarType type) {
  if (type == ScalarType::kFloat16) return Imf::HALF;
  return type == ScalarType::kUint32 ? Imf::UINT : Imf::FLOAT;
}

}  // namespace stein::exr
