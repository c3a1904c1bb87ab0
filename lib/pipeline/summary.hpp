// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "exec/runner.hpp"
#include "prefilter/source.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// Figures of the whole image for the report, warnings, and the density scaled to a mean of 1.
void summarise(const Source& source, const DenoiseParams& params, exec::Runner& runner, double progress_weight,
               DenoiseResult& result);

/// What it took, and warnings where a scratch folder does harm.
void tell_of_memory(const MemoryUsage& usage, DenoiseReport& report);

}  // namespace stein
