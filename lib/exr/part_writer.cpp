// SPDX-License-Identifier: Apache-2.0
#include "exr/part_writer.hpp"

#include <ImfChannelList.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <algorithm>
#include <optional>

#include "exr/loaded_frame.hpp"
#include "exr/part_reader.hpp"

namespace stein::exr {
namespace {

constexpr int kRowsWithoutSource = 64;

/// OpenEXR copies a deep chunk through a buffer of the size that the chunk claims.
void check_chunk(const SourceFile& source, std::uint64_t bytes) {
  if (bytes <= static_cast<std::uint64_t>(source.size(0))) return;
  throw Error(ErrorCode::kIo, "cannot read '" + source.path() + "': a deep chunk claims to be longer than the file");
}

void check_chunks(const SourceFile& source, Imf::DeepScanLineInputPart& part) {
  const Imath::Box2i& window = part.header().dataWindow();
  for (int y = window.min.y; y <= window.max.y; ++y) {
    std::uint64_t bytes = 0;
    part.rawPixelData(y, nullptr, bytes);
    check_chunk(source, bytes);
  }
}

void check_chunks(const SourceFile& source, Imf::DeepTiledInputPart& part) {
  for (int level_y = 0; level_y < part.numYLevels(); ++level_y) {
    for (int level_x = 0; level_x < part.numXLevels(); ++level_x) {
      if (!part.isValidLevel(level_x, level_y)) continue;
      const int columns = part.numXTiles(level_x);
      for (int tile = 0; tile < columns * part.numYTiles(level_y); ++tile) {
        int at_x = tile % columns;
        int at_y = tile / columns;
        std::uint64_t bytes = 0;
        part.rawTileData(at_x, at_y, level_x, level_y, nullptr, bytes);
        check_chunk(source, bytes);
      }
    }
  }
}

/// OpenEXR itself checks the chunks of flat parts.
void check_chunks(const SourceFile&, const Imf::InputPart&) {}
void check_chunks(const SourceFile&, const Imf::TiledInputPart&) {}

template <class In, class Out>
void copy_as(SourceFile& source, int part, Imf::MultiPartOutputFile& output, int output_part) {
  In in(source.input(part), source.number(part));
  check_chunks(source, in);
  Out(output, output_part).copyPixels(in);
}

class RowWriter {
 public:
  RowWriter(SourceFile* source, const PartPlan& plan, const std::vector<MemoryChannel>& channels,
            Imf::MultiPartOutputFile& output, int output_part)
      : plan_(plan), channels_(channels), output_(output, output_part) {
    if (!plan.carried.empty()) reader_.emplace(*source, plan.source_part);
    block_rows_ = reader_ ? reader_->block_rows() : kRowsWithoutSource;
    block_rows_ = std::min(block_rows_, height_of(plan.header));
    for (const std::string& name : plan.carried) add_buffer(plan.header.channels()[name].type);
    for (const MemoryChannel& channel : channels) {
      if (is_converted(channel)) add_buffer(channel.type);
    }
  }

  void write(const Memory* memory) {
    const int top = plan_.header.dataWindow().min.y;
    const int height = height_of(plan_.header);
    for (int row = 0; row < height; row += block_rows_) {
      const int rows = std::min(block_rows_, height - row);
      write_block(row, rows, top + row);
      if (memory != nullptr) memory->trim();
    }
  }

 private:
  static bool is_converted(const MemoryChannel& channel) { return channel.type != pixel_type(channel.view.type()); }

  void add_buffer(Imf::PixelType type) {
    const auto pixels = static_cast<std::size_t>(width_of(plan_.header)) * static_cast<std::size_t>(block_rows_);
    buffers_.emplace_back(pixels * static_cast<std::size_t>(byte_size(scalar_type(type))));
  }

  void write_block(int row, int rows, int first_y) {
    Imf::FrameBuffer block;
    std::size_t buffer = 0;
    for (const std::string& name : plan_.carried) {
      block.insert(name, slice(plan_.header.channels()[name].type, buffers_[buffer++].data(), first_y, rows));
    }
    if (reader_) reader_->read(block, first_y, first_y + rows - 1);
    for (const MemoryChannel& channel : channels_) {
      if (is_converted(channel)) {
        std::byte* to = buffers_[buffer++].data();
        to_half(channel.view, row, rows, reinterpret_cast<half*>(to));
        block.insert(channel.name, slice(channel.type, to, first_y, rows));
      } else {
        block.insert(channel.name, slice_of(channel.view, row, rows, first_y));
      }
    }
    output_.setFrameBuffer(block);
    output_.writePixels(rows);
  }

  [[nodiscard]] Imf::Slice slice(Imf::PixelType type, const std::byte* data, int first_y, int rows) const {
    return packed_slice(plan_.header, type, data, first_y, rows);
  }

  /// Rows of a plane in memory, where they lie.
  [[nodiscard]] Imf::Slice slice_of(const ConstPlaneView& view, int row, int rows, int first_y) const {
    const auto* data = static_cast<const std::byte*>(view.data()) + row * view.row_stride();
    const Imath::V2i origin(plan_.header.dataWindow().min.x, first_y);
    return Imf::Slice::Make(pixel_type(view.type()), data, origin, view.width(), rows,
                            static_cast<std::size_t>(view.pixel_stride()), static_cast<std::size_t>(view.row_stride()));
  }

  static void to_half(const ConstPlaneView& view, int row, int rows, half* to) {
    constexpr float kLargestHalf = 65504.0F;
    std::vector<float> values(static_cast<std::size_t>(view.width()));
    for (int y = row; y < row + rows; ++y) {
      view.read_row(y, 0, view.width(), values.data());
      for (const float value : values) *to++ = half(std::clamp(value, -kLargestHalf, kLargestHalf));
    }
  }

  const PartPlan& plan_;
  const std::vector<MemoryChannel>& channels_;
  Imf::OutputPart output_;
  std::optional<PartReader> reader_;
  int block_rows_ = 0;
  std::vector<PlaneMemory> buffers_;  // of one block: carried channels, then converted ones
};

}  // namespace

void copy_part(SourceFile& source, const PartPlan& plan, Imf::MultiPartOutputFile& output, int output_part) {
  const int part = plan.source_part;
  source.require_complete(part);
  const bool tiled = source.header(part).hasTileDescription();
  if (source.is_deep(part)) {
    if (tiled) {
      copy_as<Imf::DeepTiledInputPart, Imf::DeepTiledOutputPart>(source, part, output, output_part);
    } else {
      copy_as<Imf::DeepScanLineInputPart, Imf::DeepScanLineOutputPart>(source, part, output, output_part);
    }
  } else if (tiled) {
    copy_as<Imf::TiledInputPart, Imf::TiledOutputPart>(source, part, output, output_part);
  } else {
    copy_as<Imf::InputPart, Imf::OutputPart>(source, part, output, output_part);
  }
}

void write_part(SourceFile* source, const PartPlan& plan, const std::vector<MemoryChannel>& channels,
                Imf::MultiPartOutputFile& output, int output_part, const Memory* memory) {
  RowWriter(source, plan, channels, output, output_part).write(memory);
}

}  // namespace stein::exr
