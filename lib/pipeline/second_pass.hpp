// SPDX-License-Identifier: Apache-2.0
//
// The method on its own result: what it leaves is less noise than the input's, which a regression with narrower weights
// takes away. The picture joins the mixture as an external candidate's does, with a divergence from perturbed runs of
// both passes.
#pragma once

#include "stein/denoise.hpp"
#include "stein/frame.hpp"

namespace stein {

inline constexpr const char* kSecondPass = "second-pass";  ///< its name among the candidates

/// For DenoiseParams::second_pass. `params` and `frame` are checked.
[[nodiscard]] DenoiseResult denoise_twice(const Frame& frame, const DenoiseParams& params);

}  // namespace stein
