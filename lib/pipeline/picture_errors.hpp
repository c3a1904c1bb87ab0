// SPDX-License-Identifier: Apache-2.0
//
// The error of each picture of a mixture.
#pragma once

#include <array>
#include <vector>

#include "exec/runner.hpp"
#include "pipeline/mixture.hpp"
#include "prefilter/outlier_energy.hpp"
#include "prefilter/source.hpp"
#include "stein/plane.hpp"

namespace stein {

/// Mean over measured pixels and channels of (F - B)^2 / (B^2 + 0.01), for each picture F, with what outliers lost, and
/// the mixture B. That is what F has more of an error than B: where the weights are the best, the derivative of the
/// mixture's error towards F is 0, hence E (F - B) (B - x) = 0 with x the truth, and
///     E |F - x|^2 = E |B - x|^2 + E |F - B|^2.
/// Where F has no weight the derivative may be above 0, and its error with it.
[[nodiscard]] std::vector<double> distances_from_mixture(const std::vector<MixtureRows>& pictures,
                                                         const std::array<Plane, 3>& mixture, const Source& source,
                                                         const OutlierEnergy& energy, exec::Runner& runner);

}  // namespace stein
