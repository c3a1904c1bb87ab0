// SPDX-License-Identifier: Apache-2.0
//
// What the attribute `chromaticities` says about R, G and B.
#pragma once

#include <ImfHeader.h>

#include <array>
#include <string>

namespace stein::exr {

struct ColourSpace {
  std::array<float, 3> luminance_weights = {0.2126F, 0.7152F, 0.0722F};
  std::array<float, 9> to_rec709 = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
  std::array<float, 9> to_xyz = {};                              ///< row-major
  std::array<float, 9> from_xyz = {};
};

/// Rec. 709 if the header has no chromaticities.
/// @throws Error kInvalidFrame naming the file if the chromaticities span no colour space.
[[nodiscard]] ColourSpace colour_space(const Imf::Header& header, const std::string& path);

}  // namespace stein::exr
