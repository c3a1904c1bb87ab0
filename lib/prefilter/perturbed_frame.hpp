// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "exec/runner.hpp"
#include "prefilter/source.hpp"
#include "stein/candidate.hpp"

namespace stein {

/// The frame of `source` with colour and features moved; `planes` gets what they lie in, from the source's memory.
[[nodiscard]] Frame perturbed_frame(const Source& source, const Perturbation& perturbation, exec::Runner& runner,
                                    std::vector<Plane>& planes);

}  // namespace stein
