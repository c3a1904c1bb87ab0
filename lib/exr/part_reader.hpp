// SPDX-License-Identifier: Apache-2.0
//
// Rows of one flat part, whether it is stored in scanlines or tiles.
#pragma once

#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfTiledInputPart.h>

#include <cstdint>
#include <optional>

#include "exr/source_file.hpp"
#include "stein/memory.hpp"

namespace stein::exr {

/// A slice over packed rows: `data` is the pixel at the left end of row `first_y` of the window.
[[nodiscard]] Imf::Slice packed_slice(const Imf::Header& header, Imf::PixelType type, const void* data, int first_y,
                                      int rows);

class PartReader {
 public:
  /// One reader per part and SourceFile: OpenEXR keeps a part in the form it was first asked for.
  /// @throws Error kIo if the part is not complete.
  PartReader(SourceFile& file, int part);

  /// Rows that are decoded together; blocks start at multiples of it, counted from the top of the data window.
  [[nodiscard]] int block_rows() const noexcept { return block_rows_; }

  /// Reads rows [first_y, last_y] of level 0, in the file's coordinates; `first_y` must start a block.
  void read(const Imf::FrameBuffer& target, int first_y, int last_y);

  /// All rows: a few at a time where `memory` is limited, at once where it is not, or null. `row_bytes`: of the
  /// target's planes, in all.
  void read_all(const Imf::FrameBuffer& target, std::int64_t row_bytes, const Memory* memory);

 private:
  std::optional<Imf::InputPart> scanlines_;
  std::optional<Imf::TiledInputPart> tiles_;
  int top_ = 0;
  int height_ = 0;
  int block_rows_ = 0;
};

}  // namespace stein::exr
