// SPDX-License-Identifier: Apache-2.0
//
// The moments of a file of samples, a band of rows at a time.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stein/accumulate.hpp"
#include "stein/exr_samples.hpp"

namespace stein::cli {

using NamedView = std::pair<std::string, ConstPlaneView>;

/// Which layers of the samples go into the planes.
struct SamplePlan {
  SampleLayout layout;
  std::map<std::string, std::string> names;  ///< of planes in the output, by their conventional ones
  std::vector<std::string> channels;         ///< to read, in the order of the layout
  std::vector<std::string> left_out;         ///< names of layers
};

/// Features, but for those that are named.
/// @throws Error kInvalidArgument for a name that is no feature of the samples.
[[nodiscard]] SamplePlan plan_samples(const exr::SampleReader& samples, const std::vector<std::string>& leave_out,
                                      bool covariances);

struct SampleCounts {
  std::int64_t total = 0;     ///< taken
  std::int64_t rejected = 0;  ///< with a colour that is not finite
  std::int64_t repaired = 0;  ///< with a feature that is not finite
  std::uint32_t fewest = 0;   ///< in the file, per pixel
  std::uint32_t most = 0;
  std::int64_t empty_pixels = 0;   ///< without a sample that was taken
  std::int64_t single_pixels = 0;  ///< with one, whose variance nobody knows
};

class AccumulatedRows {
 public:
  AccumulatedRows(exr::SampleReader& samples, const SamplePlan& plan);

  /// Reads the next rows, as many as memory should hold at a time. False after the last.
  [[nodiscard]] bool next();

  [[nodiscard]] int rows_done() const noexcept { return rows_done_; }
  /// Of the rows at hand.
  [[nodiscard]] std::vector<NamedView> planes() const;
  [[nodiscard]] const SampleCounts& counts() const noexcept { return counts_; }

 private:
  void add_row(Accumulator& band, int row);
  void count_pixels();

  exr::SampleReader& samples_;
  const SamplePlan& plan_;
  int band_rows_;
  int rows_done_ = 0;
  std::vector<std::uint32_t> row_counts_;
  std::vector<float> row_samples_;
  std::optional<Moments> moments_;
  SampleCounts counts_;
};

}  // namespace stein::cli
