// SPDX-License-Identifier: Apache-2.0
#include "exr/part_reader.hpp"

#include <ImfTileDescription.h>

#include <algorithm>

namespace stein::exr {

// A multiple of every codec's chunk but DWAB's, which OpenEXR keeps decoded between calls.
constexpr int kScanlineBlock = 64;

Imf::Slice packed_slice(const Imf::Header& header, Imf::PixelType type, const void* data, int first_y, int rows) {
  const Imath::V2i origin(header.dataWindow().min.x, first_y);
  return Imf::Slice::Make(type, data, origin, width_of(header), rows);
}

PartReader::PartReader(SourceFile& file, int part)
    : top_(file.header(part).dataWindow().min.y), height_(height_of(file.header(part))) {
  file.require_complete(part);
  if (file.is_tiled(part)) {
    tiles_.emplace(file.input(part), file.number(part));
    block_rows_ = static_cast<int>(file.header(part).tileDescription().ySize);
  } else {
    scanlines_.emplace(file.input(part), file.number(part));
    block_rows_ = kScanlineBlock;
  }
}

void PartReader::read(const Imf::FrameBuffer& target, int first_y, int last_y) {
  if (scanlines_) {
    scanlines_->setFrameBuffer(target);
    scanlines_->readPixels(first_y, last_y);
    return;
  }
  tiles_->setFrameBuffer(target);
  tiles_->readTiles(0, tiles_->numXTiles(0) - 1, (first_y - top_) / block_rows_, (last_y - top_) / block_rows_, 0);
}

void PartReader::read_all(const Imf::FrameBuffer& target, std::int64_t row_bytes, const Memory* memory) {
  int rows = height_;
  if (memory != nullptr && memory->limit().bytes > 0) {
    constexpr std::int64_t kShare = 16;
    const std::int64_t blocks = memory->limit().bytes / kShare / (row_bytes * block_rows_);
    rows = static_cast<int>(std::min<std::int64_t>(std::max<std::int64_t>(blocks, 1) * block_rows_, rows));
  }
  for (int y = 0; y < height_; y += rows) {
    read(target, top_ + y, top_ + std::min(y + rows, height_) - 1);
    if (memory != nullptr) memory->trim();
  }
}

}  // namespace stein::exr
