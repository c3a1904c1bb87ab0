// SPDX-License-Identifier: Apache-2.0
//
// Range checks of parameters with one wording for all: name, value, range.
#pragma once

#include <string>
#include <string_view>

namespace stein {

/// The shortest text that reads back as the same float, or at most `digits` significant digits; "nan" and "inf" as
/// such. Independent of the locale.
[[nodiscard]] std::string to_text(float value);
[[nodiscard]] std::string to_text(float value, int digits);

/// `what` names the parameter with its owner, such as "cross-bilateral: range_sigma". NaN is never in range.
/// @throws Error kInvalidArgument unless low <= value <= high.
void require_in_range(std::string_view what, float value, float low, float high, std::string_view unit = "");

/// @throws Error kInvalidArgument unless value is finite and >= 0.
void require_not_negative(std::string_view what, float value);

}  // namespace stein
