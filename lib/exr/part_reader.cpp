// SPDX-License-Identifier: Apache-2.0
#include "exr/part_reader.hpp"

#include <ImfTileDescription.h>

namespace stein::exr {

// A multiple of every codec's chunk but DWAB's, which OpenEXR keeps decoded between calls.
constexpr int kScanlineBlock = 64;

Imf::Slice packed_slice(const Imf::Header& header, Imf::PixelType type, const void* data, int first_y, int rows) {
  const Imath::V2i origin(header.dataWindow().min.x, first_y);
  return Imf::Slice::Make(type, data, origin, width_of(header), rows);
}

PartReader::PartReader(SourceFile& file, int part) : top_(file.header(part).dataWindow().min.y) {
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

}  // namespace stein::exr
