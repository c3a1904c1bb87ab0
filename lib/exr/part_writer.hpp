// SPDX-License-Identifier: Apache-2.0
//
// One part of an output file: channels streamed from a source file next to channels in memory, or a raw copy.
#pragma once

#include <ImfMultiPartOutputFile.h>

#include <string>
#include <vector>

#include "exr/output_plan.hpp"

namespace stein::exr {

/// A channel of the output that is in memory. Where `type` is not the view's own, values are converted to half; what
/// half cannot hold is clamped to +-65504.
struct MemoryChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  ConstPlaneView view;
  int part = -1;  ///< of the source; -1: the one with the colour
};

/// Copies the chunks of a part without decoding them: flat or deep, scanlines or tiles of any number of levels.
void copy_part(SourceFile& source, const PartPlan& plan, Imf::MultiPartOutputFile& output, int output_part);

/// Writes the rows of a part, holding a block of rows of the channels from the source at a time.
/// `source` may be null if nothing is carried. `memory` is trimmed between blocks.
void write_part(SourceFile* source, const PartPlan& plan, const std::vector<MemoryChannel>& channels,
                Imf::MultiPartOutputFile& output, int output_part, const Memory* memory = nullptr);

}  // namespace stein::exr
