// SPDX-License-Identifier: Apache-2.0
//
// `stein denoise --filter rpf`: the filter that reads raw samples.
#pragma once

#include <string>
#include <vector>

#include "denoise_options.hpp"
#include "frame_range.hpp"
#include "stein/rpf.hpp"
#include "verbs.hpp"

namespace stein::cli {

struct SampleFilterOptions {
  std::string preset = "default";
  std::vector<std::string> adjacent;
  std::vector<std::string> features;
  std::vector<std::string> randoms;
};

/// Declares them, after those of the pixel filters; `options` must outlive the parsing.
void declare(CLI::App& verb, SampleFilterOptions& options);

/// Whether the filter that was asked for reads samples. @throws Error kInvalidArgument for options given to `verb` that
/// are not for that filter.
[[nodiscard]] bool reads_samples(const CLI::App& verb, const DenoiseOptions& options);

/// @throws Error kInvalidArgument.
[[nodiscard]] RpfParams rpf_params(const DenoiseOptions& options, const SampleFilterOptions& filter);

void denoise_samples(const FrameTask& task, const RpfParams& params, const std::vector<std::string>& adjacent_paths);

}  // namespace stein::cli
