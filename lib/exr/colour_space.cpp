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

/// Imath multiplies row vectors: XYZ = RGB * M.
std::array<float, 9> column_form(const Imath::M44f& matrix) {
  std::array<float, 9> result = {};
  for (unsigned column = 0; column < 3; ++column) {
    for (unsigned row = 0; row < 3; ++row) result[row * 3 + column] = matrix.x[column][row];
  }
  return result;
}

void set_xyz(const Imf::Chromaticities& primaries, ColourSpace& space) {
  space.to_xyz = column_form(Imf::RGBtoXYZ(primaries, 1.0F));
  space.from_xyz = column_form(Imf::XYZtoRGB(primaries, 1.0F));
}

ColourSpace from(const Imf::Chromaticities& primaries) {
  ColourSpace space;
  set_xyz(primaries, space);
  space.to_rec709 = column_form(Imf::RGBtoXYZ(primaries, 1.0F) * Imf::XYZtoRGB(Imf::Chromaticities(), 1.0F));
  for (unsigned c = 0; c < 3; ++c) space.luminance_weights[c] = space.to_xyz[3 + c];
  return space;
}

ColourSpace rec709() {
  ColourSpace space;
  set_xyz(Imf::Chromaticities(), space);
  return space;
}

}  // namespace

ColourSpace colour_space(const Imf::Header& header, const std::string& path) {
  if (!Imf::hasChromaticities(header)) return rec709();
  const Imf::Chromaticities& primaries = Imf::chromaticities(header);
  if (primaries == Imf::Chromaticities()) return rec709();
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
