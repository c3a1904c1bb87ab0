// SPDX-License-Identifier: Apache-2.0
//
// A look at a part of the image: what its mean risks say of the entries, and of the variances that were given.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exec/row_pipeline.hpp"
#include "pipeline/filter_runs.hpp"
#include "prefilter/source.hpp"

namespace stein {

/// A mean over the surveyed pixels and its standard error.
struct Estimate {
  double value = 0;
  double standard_error = 0;
};

struct Survey {
  std::vector<float> mean_risk;  ///< per entry: mean relative risk, clipped as for the choice
  int best = 0;                  ///< the entry where it is least
  /// Relative to the squared colour, as relative risks are:
  std::vector<Estimate> risk;  ///< per entry, not clipped
  double noise = 0;            ///< mean of the variances of the mean
  int common = 0;              ///< a fairly wide candidate
  double residual = 0;         ///< mean square of its residuals y - F
  Estimate correlation;        ///< mean product of the residuals of horizontal neighbours
};

/// Sums over the pixels of the surveyed rows: eight of every 64, of every 128 from 1024 rows on and so forth, all of
/// them in images of fewer than 256.
class Surveyor {
 public:
  Surveyor(const Source& source, const FilterRuns& runs, const exec::RowPipelineGeometry& geometry, int slots);
  ~Surveyor();
  Surveyor(const Surveyor&) = delete;
  Surveyor& operator=(const Surveyor&) = delete;

  /// The parts of a tile that are surveyed, or no more than `reach` rows away from one.
  [[nodiscard]] std::vector<Rect> parts(const Rect& tile, int reach) const;
  /// Takes in one of them, whose candidates are there.
  void add(const Rect& part, int slot);
  [[nodiscard]] Survey result() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Runs the filter on the surveyed rows only.
[[nodiscard]] Survey survey(Surveyor& surveyor, FilterRuns& runs, const exec::RowPipelineGeometry& geometry,
                            exec::Runner& runner, double progress_weight);

/// What the survey says against the variances that were given, in words. `joint`: the risk accounts for covariances of
/// all that guides the filter.
[[nodiscard]] std::vector<std::string> doubts(const Survey& survey, bool joint);

}  // namespace stein
