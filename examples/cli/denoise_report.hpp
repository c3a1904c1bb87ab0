// SPDX-License-Identifier: Apache-2.0
//
// What `stein denoise` tells about its work, for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stein/denoise.hpp"
#include "stein/exr.hpp"

namespace stein::cli {

struct Seconds {
  double read = 0;
  double compute = 0;
  double write = 0;
  double total = 0;
};

struct DenoiseSummary {
  const exr::LoadedFrame& input;
  const DenoiseReport& report;
  std::string output_path;
  std::string filter;
  int threads = 0;  ///< those that were available where none were asked for
  Seconds seconds;
  std::optional<int> frame;  ///< its number, of a sequence
};

/// Adds a warning where the process held more than `memory` allows.
void warn_if_exceeded(const Memory& memory, std::vector<std::string>& warnings);

/// The line of a summary, on standard output.
void print_memory(std::int64_t scratch_bytes);

/// On standard output.
void print_summary(const DenoiseSummary& summary);

/// On standard output, for one of many frames.
void print_line_of_frame(const DenoiseSummary& summary);

/// On standard error, one line each.
void print_warnings(const std::string& path, const DenoiseReport& report);

[[nodiscard]] nlohmann::ordered_json to_json(const DenoiseSummary& summary);

/// One view's report, or those of several as a list `views`.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<DenoiseSummary>& views);

}  // namespace stein::cli
