// SPDX-License-Identifier: Apache-2.0
//
// The verbs of the program. Each declares its options on `verb` and returns what to do once they are parsed.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "run_program.hpp"

namespace stein::cli {

[[nodiscard]] Action add_denoise(CLI::App& verb);
[[nodiscard]] Action add_accumulate(CLI::App& verb);
[[nodiscard]] Action add_info(CLI::App& verb);
[[nodiscard]] Action add_compare(CLI::App& verb);
[[nodiscard]] Action add_merge(CLI::App& verb);
[[nodiscard]] Action add_perturb(CLI::App& verb);
[[nodiscard]] Action add_preview(CLI::App& verb);
[[nodiscard]] Action add_sample_map(CLI::App& verb);

}  // namespace stein::cli
