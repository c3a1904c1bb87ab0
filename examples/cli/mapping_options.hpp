// SPDX-License-Identifier: Apache-2.0
//
// How the channels of input files are understood; shared by all verbs that read frames.
#pragma once

#include <string>
#include <vector>

#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {

struct MappingOptions {
  std::string preset;
  std::vector<std::string> maps;
  std::string variance_of;
  std::string view;
};

/// Of one file: a number, or the channel that holds them.
struct SamplesOption {
  std::string text;
};

/// Declares them; `options` must outlive the parsing.
void declare(CLI::App& verb, MappingOptions& options);

void declare(CLI::App& verb, SamplesOption& option);

/// @throws Error kInvalidArgument.
void apply(const MappingOptions& options, exr::ReadOptions& read);
void apply(const SamplesOption& option, exr::ReadOptions& read);

}  // namespace stein::cli
