// SPDX-License-Identifier: Apache-2.0
//
// The options of `stein denoise` and what they mean to the library.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "candidate_options.hpp"
#include "filter_options.hpp"
#include "mapping_options.hpp"
#include "stein/denoise.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {

struct DenoiseOptions {
  std::string input;
  std::string output;
  std::string json;
  FilterOptions filter;
  MappingOptions mapping;
  std::string risk = "auto";
  int draws = MonteCarloParams{}.draws;
  std::uint64_t seed = MonteCarloParams{}.seed;
  std::string selection = "evidence";
  float strength = 1;
  SamplesOption samples;
  CandidateOptions candidates;
  std::vector<std::string> layers;
  bool straight_alpha = false;
  std::string tile;
  std::string max_memory;  // a number of bytes; empty: no limit
  std::string scratch;
  int threads = 0;
  bool strict = false;
  bool outliers = true;
  bool quiet = false;
  exr::WriteOptions write;
};

/// Declares them; `options` must outlive the parsing.
void declare(CLI::App& verb, DenoiseOptions& options);

/// Of these, what is read and how it is worked on: not what is written.
void declare_method(CLI::App& verb, DenoiseOptions& options);

/// Null where no limit is set. @throws Error kInvalidArgument, kIo for a folder that is none.
[[nodiscard]] std::shared_ptr<Memory> make_memory(const DenoiseOptions& options);

/// Without progress. @throws Error kInvalidArgument.
[[nodiscard]] DenoiseParams denoise_params(const DenoiseOptions& options);

/// Reads the input as the options want it; `memory`, `progress`: as those of ReadOptions.
[[nodiscard]] exr::LoadedFrame read_input(const DenoiseOptions& options, std::shared_ptr<Memory> memory,
                                          const std::function<bool(double)>& progress);

}  // namespace stein::cli
