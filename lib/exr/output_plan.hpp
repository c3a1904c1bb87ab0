// SPDX-License-Identifier: Apache-2.0
//
// What becomes of each part and channel of the source in a result file.
#pragma once

#include <ImfHeader.h>

#include <string>
#include <vector>

#include "exr/layout.hpp"

namespace stein::exr {

/// The source's attributes, those that speak of samples per pixel if asked for, with the storage of flat scanlines from
/// the top and no channels; ZIP where the source's compression is lossy. Not a copy without some: erasing an attribute
/// leaks in OpenEXR 3.1.
[[nodiscard]] Imf::Header scanline_header(const Imf::Header& source, bool keep_samples);

struct PartPlan {
  int source_part = 0;
  bool copied = false;               ///< chunks are copied as they are; otherwise rows are written anew
  Imf::Header header;                ///< of the output part
  std::vector<std::string> carried;  ///< channels taken from the source; meaningful if not copied
};

struct NewChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  int part = 0;  ///< of the source; takes the place of a channel of that name
};

struct OutputRules {
  bool keep_inputs = false;
  bool replace_noisy = false;
  bool replace_frame = false;  ///< nothing of the source's frame is kept: neither its features nor its sample count
  std::vector<NewChannel> new_channels = {};
  bool keep_all = false;  ///< but for what a new channel takes the place of
};

/// `roles`: of the source's channels. The parts of the output in the source's order; parts that lose all channels are
/// left out. A part that is written anew has scanlines from the top, and ZIP where the source's compression is lossy.
[[nodiscard]] std::vector<PartPlan> plan_output(const SourceFile& source, const std::vector<Role>& roles,
                                                const OutputRules& rules);

}  // namespace stein::exr
