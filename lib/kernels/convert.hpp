// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace stein::kernels {

/// Converts `count` packed IEEE half floats (at any address) to floats, exactly; infinities and NaNs stay what they
/// are.
void half_to_float_row(const std::byte* half, int count, float* out);

}  // namespace stein::kernels
