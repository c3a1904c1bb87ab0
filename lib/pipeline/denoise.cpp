// SPDX-License-Identifier: Apache-2.0
//
// The method as a short driver. SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and
// Reconstruction", 2012.
#include "stein/denoise.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/parameter_check.hpp"
#include "exec/runner.hpp"
#include "kernels/guides.hpp"
#include "pipeline/error_stages.hpp"
#include "pipeline/external_picture.hpp"
#include "pipeline/layers.hpp"
#include "pipeline/risk_choice.hpp"
#include "pipeline/run.hpp"
#include "pipeline/second_pass.hpp"
#include "pipeline/summary.hpp"
#include "prefilter/outliers.hpp"
#include "prefilter/source.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

constexpr int kDefaultTileWidth = 128;
constexpr int kDefaultTileHeight = 32;
constexpr double kRestShare = 1.0 - kMainShare;  // inspecting the input and summing up

bool is_limited(const Execution& execution) { return execution.memory && execution.memory->limit().bytes > 0; }

exec::RowPipelineGeometry geometry_of(const Frame& frame, const Execution& execution, int threads) {
  exec::RowPipelineGeometry geometry;
  geometry.width = frame.width;
  geometry.height = frame.height;
  const int width = execution.tile_width > 0 ? execution.tile_width : kDefaultTileWidth;
  geometry.tile_width = kernels::whole_vectors(width);
  geometry.tile_height = execution.tile_height > 0 ? execution.tile_height : kDefaultTileHeight;
  geometry.band_height = exec::band_height(geometry, threads, is_limited(execution));
  return geometry;
}

void allocate(const Frame& frame, Memory* memory, DenoiseResult& result) {
  result.colour = Plane::triple(frame.width, frame.height, memory);
  result.error = Plane::triple(frame.width, frame.height, memory);
  result.choice = Plane(frame.width, frame.height, memory);
  result.density = Plane(frame.width, frame.height, memory);
  result.layers = allocate_layers(frame, memory);
}

void replace_outliers(Source& source, const DenoiseParams& params, exec::Runner& runner, DenoiseReport& report) {
  if (!params.outliers.enabled) return;
  const OutlierReport outliers = find_outliers(source, params.outliers, runner);
  source.replace(outliers.pixels);
  report.outlier_pixels = static_cast<std::int64_t>(outliers.pixels.size());
  report.outlier_energy = outliers.removed;  // summarise() makes it a fraction
}

// One filter: its picture is the result, and no plane of the image's size is needed beside that.
void filter_alone(DenoiseRun& run, bool knows_covariances) {
  const int slots = run.runner.slots();
  FilterJob job(run.source, run.layers, run.plans.front(), run.params.selection, run.geometry, error_halos(), slots);
  const double left = run.survey(job, kMainShare);

  const exec::RowRing rows(MixtureRows::planes(run.layers.channels()), run.geometry.width,
                           exec::ring_capacity(run.geometry, {}), run.source.memory());
  const MixtureRows picture(rows);
  std::vector<exec::RowStage> stages = job.plan_stages({picture, &run.result.choice});
  ErrorStages errors(run.source, run.layers, run.energy, run.params, picture, job.guides(), run.geometry, slots,
                     run.result);
  stages.insert(stages.end(), errors.list().begin(), errors.list().end());
  run.execute(stages, left);
  run.doubt(job.findings(), knows_covariances);
  errors.calibrate(run.runner);
  FilterShare& filter = run.result.report.filters.front();
  filter.weight = 1.0;
  if (run.params.strength == 1.0F) filter.mean_relative_error = run.result.report.mean_relative_error;
}

void describe(const std::string& filter, const RiskChoice& risk, DenoiseReport& report) {
  report.filters.push_back({filter, 0.0, {}, risk.name, risk.reason});
  for (const std::string& warning : risk.warnings) {
    const auto same = std::find(report.warnings.begin(), report.warnings.end(), warning);
    if (same == report.warnings.end()) report.warnings.push_back(warning);
  }
}

}  // namespace

void check(const DenoiseParams& params) {
  require_in_range("the number of filters", static_cast<float>(params.filters.size()), 1.0F, kMaxFilters);
  for (const FilterSpec& filter : params.filters) check(filter);
  check_candidates(params);
  require_in_range("strength", params.strength, 0.0F, 1.0F);
  require_in_range("outliers.excess", params.outliers.excess, 0.0F, 100.0F);
  require_in_range("outliers.spread", params.outliers.spread, 0.0F, 100.0F, "px");
  require_in_range("outliers.support", params.outliers.support, 1e-3F, 100.0F);
  require_in_range("monte_carlo.draws", static_cast<float>(params.monte_carlo.draws), 1.0F, 16.0F);
  require_in_range("monte_carlo.step", params.monte_carlo.step, 1e-3F, 1.0F, "standard deviations");
  require_in_range("density.epsilon", params.density.epsilon, 1e-9F, 1e9F);
  require_in_range("density.dimensions", params.density.dimensions, 1.0F, 100.0F);
  for (const float weight : params.luminance_weights) require_in_range("luminance_weights", weight, -10.0F, 10.0F);
  const Execution& execution = params.execution;
  if (execution.memory && !is_limited(execution) && !execution.memory->limit().scratch_folder.empty()) {
    throw Error(ErrorCode::kInvalidArgument,
                "a scratch folder is named, but memory is not limited: nothing would go there; set max-memory");
  }
  require_in_range("execution.threads", static_cast<float>(execution.threads), 0.0F, 4096.0F);
  if (execution.tile_width != 0)
    require_in_range("execution.tile_width", static_cast<float>(execution.tile_width), 16.0F, 4096.0F, "px");
  if (execution.tile_height != 0)
    require_in_range("execution.tile_height", static_cast<float>(execution.tile_height), 1.0F, 4096.0F, "px");
}

DenoiseResult denoise(const Frame& frame, const DenoiseParams& params) {
  check(params);
  check(frame);
  require_layers(frame, params);
  if (params.second_pass) return denoise_twice(frame, params);
  DenoiseResult result;
  DenoiseReport& report = result.report;
  std::vector<FilterPlan> plans;
  bool knows_covariances = true;
  for (const FilterSpec& filter : params.filters) {
    const RiskChoice risk = choose_risk(frame, filter, params);
    plans.push_back({filter, risk.method, params.monte_carlo, params.risk == Risk::kAuto});
    knows_covariances = knows_covariances && risk.knows_covariances;
    describe(std::string(filter_name(filter)), risk, report);
  }
  for (const ExternalCandidate& candidate : params.candidates) {
    describe(candidate.name, external_risk(frame, draws_of(candidate)), report);
  }
  exec::Runner runner(params.execution);
  StageClock clock(report.stages);

  clock.measure("inspect", [&] { report.frame = inspect(frame, runner, kRestShare / 2); });
  if (params.strict) require_clean(frame, report.frame);
  warn_of_layers(frame, report);
  Memory* const memory = params.execution.memory.get();
  allocate(frame, memory, result);
  Source source(frame, report.frame, memory);
  const Source given = source;
  clock.measure("outliers", [&] { replace_outliers(source, params, runner, report); });

  const LayerSource layers(frame, report.frame, source);
  const OutlierEnergy energy(source, layers, params.outliers.spread);
  DenoiseRun run{params, source, given, layers, energy, geometry_of(frame, params.execution, runner.slots()),
                 runner, clock,  plans, result};
  if (plans.size() == 1 && params.candidates.empty()) {
    filter_alone(run, knows_covariances);
  } else {
    filter_together(run, knows_covariances);
  }
  if (memory != nullptr) tell_of_memory(memory->usage(), report);
  clock.measure("summarise", [&] { summarise(source, params, runner, kRestShare / 2, result); });
  return result;
}

}  // namespace stein
