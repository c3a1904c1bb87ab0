// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "false_colour.hpp"
#include "picture.hpp"

namespace stein::cli {

/// Writes digits and the other characters of a number ("+-.e"), white, with (x, y) at the top left.
void draw_number(Picture& picture, int x, int y, double value);

/// The picture with the false colours of `range` and their values at its right side.
[[nodiscard]] Picture with_scale_bar(Picture picture, ValueRange range);

/// The picture with the colours of the categories 0..last and their numbers at its right side.
[[nodiscard]] Picture with_category_key(Picture picture, int last);

}  // namespace stein::cli
