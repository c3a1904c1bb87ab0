// SPDX-License-Identifier: Apache-2.0
//
// Frames of half floats.
#pragma once

#include <cstdint>
#include <vector>

#include "stein/frame.hpp"

namespace stein::test {

/// The half float next to `value`, towards 0; |value| in [0, 65504].
[[nodiscard]] float round_to_half(float value);

/// Makes all planes that filters read views of half floats in `memory`: interleaved, or one after the other without
/// gaps. The values must be half floats already.
void hold_as_half(Frame& frame, bool is_interleaved, std::vector<std::uint16_t>& memory);

}  // namespace stein::test
