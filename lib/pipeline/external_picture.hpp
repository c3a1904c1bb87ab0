// SPDX-License-Identifier: Apache-2.0
//
// The picture of an external candidate: its image of the frame, and its divergence from those of perturbed frames.
#pragma once

#include <string>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/runner.hpp"
#include "prefilter/source.hpp"
#include "stein/candidate.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// Planes of the whole image as in MixtureRows. `given`: the frame without outliers scaled down, as the
/// candidate saw it. Pixels without usable colour are filled from their neighbours. `warnings` gets what is doubtful.
/// @throws Error kInvalidArgument naming the candidate for images of another size, that hold what is no colour where
/// the frame has one, or that do not follow the perturbation; kCancelled; what the denoiser throws.
[[nodiscard]] exec::RowRing external_picture(const Source& given, const ExternalCandidate& candidate,
                                             exec::Runner& runner, double progress_weight,
                                             std::vector<std::string>& warnings);

/// All of them together, with the filters. @throws Error kInvalidArgument.
void check_candidates(const DenoiseParams& params);

/// @throws Error kInvalidArgument for a frame with layers, where there are candidates without.
void require_layers(const Frame& frame, const DenoiseParams& params);

/// Runs of the candidate on perturbed frames.
[[nodiscard]] int draws_of(const ExternalCandidate& candidate) noexcept;

}  // namespace stein
