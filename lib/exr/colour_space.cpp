// SPDX-License-Identifier: Apache-2.0
#include "exr/colour_space.hpp"

#include <ImfChromaticities.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "stein/error.hpp"

namespace stein::exr {
namespace {

[[noreturn]] void fail(const std::string& path) {
  throw Error(ErrorCode::kInvalidFrame,
              "'" + path + "': the attribute chromaticities spans no colour space; correct or remove it");
}

ColourSpace from(const Imf::Chromaticities& primaries) {
  // Imath multiplies row vectors: XYZ = RGB * M.
  const Imath::M44f to_xyz = Imf::RGBtoXYZ(primaries, 1.0F);
  const Imath::M44f to_rec709 = to_xyz * Imf::XYZtoRGB(Imf::Chromaticities(), 1.0F);
  ColourSpace space;
  for (unsigned column = 0; column < 3; ++column) {
    space.luminance_weights[column] = to_xyz.x[column][1];
    for (unsigned row = 0; row < 3; ++row) space.to_rec709[row * 3 + column] = to_rec709.x[column][row];
  }
  return space;
}

}  // namespace

ColourSpace colour_space(const Imf::Header& header, const std::string& path) {
  if (!Imf::hasChromaticities(header)) return {};
  const Imf::Chromaticities& primaries = Imf::chromaticities(header);
  if (primaries == Imf::Chromaticities()) return {};
  ColourSpace space;
  try {
    space = from(primaries);
  } catch (const std::exception&) {
    fail(path);
  }
  const auto finite = [](float value) { return std::isfinite(value); };
  if (!std::all_of(space.luminance_weights.begin(), space.luminance_weights.end(), finite) ||
      !std::all_of(space.to_rec709.begin(), space.to_rec709.end(), finite)) {
    fail(path);
  }
  return space;
}

}  // namespace stein::exr
