// SPDX-License-Identifier: Apache-2.0
//
// The options of `stein denoise` for images of other denoisers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stein/candidate.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {

struct CandidateOptions {
  std::vector<std::string> images;     ///< [NAME=]FILE of each candidate
  std::vector<std::string> perturbed;  ///< FILE[,FILE...] of each candidate
  std::optional<std::uint64_t> seed;   ///< of files that do not say
  std::optional<float> step;

  /// All paths in them, each replaced by what `change` makes of it.
  void for_each_path(const std::function<void(std::string& path)>& change);
};

/// Declares them; `options` must outlive the parsing.
void declare(CLI::App& verb, CandidateOptions& options);

/// What of the options can be wrong without looking into files. @throws Error kInvalidArgument.
void check(const CandidateOptions& options);

/// The memory that the candidates look at, and these. Movable; the views stay valid.
struct LoadedCandidates {
  std::vector<exr::NamedPlanes> planes;
  std::vector<ExternalCandidate> list;
};

/// `memory`: where the planes lie, as ReadOptions::memory. `check_going_on` is called between files and throws if not.
/// @throws Error kInvalidArgument for files that contradict each other or the options, kIo, kInvalidFrame, kCancelled.
[[nodiscard]] LoadedCandidates read_candidates(const CandidateOptions& options, Memory* memory,
                                               const std::function<void()>& check_going_on);

}  // namespace stein::cli
