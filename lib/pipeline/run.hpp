// SPDX-License-Identifier: Apache-2.0
//
// One run of the method on a frame: what its steps share, and the steps between the input and the summary.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "exec/row_pipeline.hpp"
#include "exec/runner.hpp"
#include "pipeline/filter_job.hpp"
#include "pipeline/layers.hpp"
#include "prefilter/outlier_energy.hpp"
#include "prefilter/source.hpp"
#include "stein/denoise.hpp"

namespace stein {

inline constexpr double kMainShare = 0.97;  // of the progress, for filtering

/// Times stages by name; equal names add up.
class StageClock {
 public:
  explicit StageClock(std::vector<StageSeconds>& stages) : stages_(stages) {}
  void add(const std::string& name, double seconds) {
    const auto found =
        std::find_if(stages_.begin(), stages_.end(), [&](const StageSeconds& s) { return s.name == name; });
    if (found != stages_.end()) {
      found->seconds += seconds;
    } else {
      stages_.push_back({name, seconds});
    }
  }
  template <class Body>
  void measure(const std::string& name, Body body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    add(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }

 private:
  std::vector<StageSeconds>& stages_;
};

/// What the steps of a run share.
struct DenoiseRun {
  const DenoiseParams& params;
  const Source& source;
  const Source& given;  ///< before outliers were scaled down
  const LayerSource& layers;
  const OutlierEnergy& energy;
  exec::RowPipelineGeometry geometry;
  exec::Runner& runner;
  StageClock& clock;
  std::vector<FilterPlan> plans;
  DenoiseResult& result;

  void execute(const std::vector<exec::RowStage>& stages, double share) {
    const std::vector<double> seconds = exec::run_row_pipeline(geometry, stages, runner, share);
    for (std::size_t s = 0; s < seconds.size(); ++s) clock.add(stages[s].name, seconds[s]);
  }

  /// Surveys for the filter where it wants that. Returns what is left of its share of the progress.
  double survey(FilterJob& job, double share) {
    constexpr double kSurveyShare = 0.12;  // of the filter's
    if (!job.wants_survey()) return share;
    const double part = share * kSurveyShare;
    clock.measure("survey", [&] { job.survey(runner, part); });
    return share - part;
  }

  void doubt(const Survey& findings, bool knows_covariances) {
    for (std::string& text : doubts(findings, knows_covariances)) result.report.warnings.push_back(std::move(text));
  }
};

/// Several filters, one after the other, and other denoisers' pictures; then their mixture.
void filter_together(DenoiseRun& run, bool knows_covariances);

}  // namespace stein
