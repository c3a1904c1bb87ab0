// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "stein/denoise.hpp"

namespace stein {

/// The risk estimate that a run uses.
struct RiskChoice {
  Risk method = Risk::kPlain;  ///< never kAuto
  std::string name;
  std::string reason;
  bool knows_covariances = true;  ///< uses those of the colour with all that guides the filter and is noisy
  std::vector<std::string> warnings;
};

/// For one of the filters of `params`. @throws Error kInvalidArgument where the filter cannot do what `params` asks
/// for, kInvalidFrame where the frame lacks what it takes.
[[nodiscard]] RiskChoice choose_risk(const Frame& frame, const FilterSpec& filter, const DenoiseParams& params);

/// For an external candidate, of which is not known what it reads.
[[nodiscard]] RiskChoice external_risk(const Frame& frame, int draws);

}  // namespace stein
