// SPDX-License-Identifier: Apache-2.0
//
// The method as a short driver. SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and
// Reconstruction", 2012.
#include "stein/denoise.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/parameter_check.hpp"
#include "exec/runner.hpp"
#include "kernels/guides.hpp"
#include "pipeline/filter_runs.hpp"
#include "pipeline/risk_choice.hpp"
#include "pipeline/stages.hpp"
#include "pipeline/summary.hpp"
#include "pipeline/survey.hpp"
#include "prefilter/outliers.hpp"
#include "prefilter/source.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

constexpr int kDefaultTileWidth = 128;
constexpr int kDefaultTileHeight = 32;
constexpr double kMainShare = 0.85;  // of the progress
constexpr double kSurveyShare = 0.12;
constexpr double kRestShare = 1.0 - kMainShare - kSurveyShare;  // inspecting the input and summing up

exec::RowPipelineGeometry geometry_of(const Frame& frame, const Execution& execution, int threads) {
  exec::RowPipelineGeometry geometry;
  geometry.width = frame.width;
  geometry.height = frame.height;
  const int width = execution.tile_width > 0 ? execution.tile_width : kDefaultTileWidth;
  geometry.tile_width = (width + kernels::kMaxLanes - 1) / kernels::kMaxLanes * kernels::kMaxLanes;
  geometry.tile_height = execution.tile_height > 0 ? execution.tile_height : kDefaultTileHeight;
  geometry.band_height = exec::band_height(geometry, threads);
  return geometry;
}

void allocate(const Frame& frame, DenoiseResult& result) {
  result.colour = Plane::triple(frame.width, frame.height);
  result.error = Plane::triple(frame.width, frame.height);
  result.choice = Plane(frame.width, frame.height);
  result.density = Plane(frame.width, frame.height);
}

// Times stages by name; equal names add up.
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

void replace_outliers(Source& source, const DenoiseParams& params, exec::Runner& runner, DenoiseReport& report) {
  if (!params.outliers.enabled) return;
  const OutlierReport outliers = find_outliers(source, params.outliers, runner);
  source.replace(outliers.pixels);
  report.outlier_pixels = static_cast<std::int64_t>(outliers.pixels.size());
  report.outlier_energy = outliers.removed;  // summarise() makes it a fraction
}

// Filters of many passes need nearly all rows of each for a few of the last: they do without.
bool wants_prior(const DenoiseParams& params, const FilterRuns& runs) {
  constexpr int kMostPasses = 2;
  return params.selection == Selection::kEvidence && runs.passes() <= kMostPasses;
}

void describe(const RiskChoice& risk, DenoiseReport& report) {
  report.risk = risk.name;
  report.risk_reason = risk.reason;
  report.warnings = risk.warnings;
}

}  // namespace

void check(const DenoiseParams& params) {
  check(params.filter);
  require_in_range("strength", params.strength, 0.0F, 1.0F);
  require_in_range("outliers.excess", params.outliers.excess, 0.0F, 100.0F);
  require_in_range("outliers.support", params.outliers.support, 1e-3F, 100.0F);
  require_in_range("monte_carlo.draws", static_cast<float>(params.monte_carlo.draws), 1.0F, 16.0F);
  require_in_range("monte_carlo.step", params.monte_carlo.step, 1e-3F, 1.0F, "standard deviations");
  require_in_range("density.epsilon", params.density.epsilon, 1e-9F, 1e9F);
  require_in_range("density.dimensions", params.density.dimensions, 1.0F, 100.0F);
  for (const float weight : params.luminance_weights) require_in_range("luminance_weights", weight, -10.0F, 10.0F);
  const Execution& execution = params.execution;
  require_in_range("execution.threads", static_cast<float>(execution.threads), 0.0F, 4096.0F);
  if (execution.tile_width != 0)
    require_in_range("execution.tile_width", static_cast<float>(execution.tile_width), 16.0F, 4096.0F, "px");
  if (execution.tile_height != 0)
    require_in_range("execution.tile_height", static_cast<float>(execution.tile_height), 1.0F, 4096.0F, "px");
}

DenoiseResult denoise(const Frame& frame, const DenoiseParams& params) {
  check(params);
  check(frame);
  const RiskChoice risk = choose_risk(frame, params);
  exec::Runner runner(params.execution);
  DenoiseResult result;
  DenoiseReport& report = result.report;
  describe(risk, report);
  StageClock clock(report.stages);

  clock.measure("inspect", [&] { report.frame = inspect(frame, runner, kRestShare / 2); });
  if (params.strict) require_clean(frame, report.frame);

  allocate(frame, result);
  Source source(frame, report.frame);
  clock.measure("outliers", [&] { replace_outliers(source, params, runner, report); });

  const exec::RowPipelineGeometry geometry = geometry_of(frame, params.execution, runner.slots());
  const int ring_rows = window_rows(params, risk.method, geometry);
  FilterRuns runs(source, params, risk.method, geometry, ring_rows, runner.slots());
  Surveyor surveyor(source, runs, geometry, runner.slots());
  const bool has_prior = wants_prior(params, runs);
  Survey prior;
  if (has_prior) clock.measure("survey", [&] { prior = survey(surveyor, runs, geometry, runner, kSurveyShare); });

  Stages pipeline(source, params, runs, has_prior ? &prior : nullptr, surveyor, geometry, ring_rows, runner.slots(),
                  result);
  const std::vector<double> seconds =
      exec::run_row_pipeline(geometry, pipeline.list(), runner, kMainShare + (has_prior ? 0.0 : kSurveyShare));
  for (std::size_t s = 0; s < seconds.size(); ++s) clock.add(pipeline.list()[s].name, seconds[s]);

  for (std::string& doubt : doubts(has_prior ? prior : surveyor.result(), risk.knows_covariances))
    report.warnings.push_back(std::move(doubt));
  report.mean_relative_error = pipeline.mean_relative_error();
  clock.measure("summarise", [&] { summarise(source, params, runner, kRestShare / 2, result); });
  return result;
}

}  // namespace stein
