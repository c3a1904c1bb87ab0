// SPDX-License-Identifier: Apache-2.0
//
// The method on its own result: what it leaves is less noise than the input's, which a regression with narrower weights
// takes away. The picture joins the mixture as an external candidate's does, with a divergence from perturbed runs of
// both passes. That sees the noise which the first pass left better than what the passes lost for good, so the
// picture's gain decides about its weight, but is not told.
#pragma once

#include "stein/denoise.hpp"
#include "stein/frame.hpp"

namespace stein {

struct FirstPass;

inline constexpr const char* kSecondPass = "second-pass";  ///< its name among the candidates

/// For DenoiseParams::second_pass. `params` and `frame` are checked.
[[nodiscard]] DenoiseResult denoise_twice(const Frame& frame, const DenoiseParams& params);

/// denoise() without a second pass. `first`: null, or what the last of the external candidates is a second pass of.
[[nodiscard]] DenoiseResult denoise_once(const Frame& frame, const DenoiseParams& params, const FirstPass* first);

}  // namespace stein
