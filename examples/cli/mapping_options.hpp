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
};

/// Declares them; `options` must outlive the parsing.
void declare(CLI::App& verb, MappingOptions& options);

/// @throws Error kInvalidArgument.
void apply(const MappingOptions& options, exr::ReadOptions& read);

}  // namespace stein::cli
