// SPDX-License-Identifier: Apache-2.0
//
// What the machine could do at most: the denominators of the benchmarks.
#pragma once

#include <cstddef>

namespace stein::bench {

/// Flops of one call to fma_burst.
[[nodiscard]] double fma_burst_flops();

/// Independent multiply-adds in registers, on the widest vectors. The result only keeps the work from being optimised
/// away.
float fma_burst();

/// a[i] = b[i] + s * c[i] over n floats.
void triad(float* a, const float* b, const float* c, float s, std::size_t n);

}  // namespace stein::bench
