// SPDX-License-Identifier: Apache-2.0
//
// The method as a short driver. SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and
// Reconstruction", 2012.
#include "stein/denoise.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/parameter_check.hpp"
#include "exec/runner.hpp"
#include "kernels/guides.hpp"
#include "pipeline/blend.hpp"
#include "pipeline/error_stages.hpp"
#include "pipeline/external_picture.hpp"
#include "pipeline/filter_job.hpp"
#include "pipeline/layers.hpp"
#include "pipeline/picture_errors.hpp"
#include "pipeline/risk_choice.hpp"
#include "pipeline/second_pass.hpp"
#include "pipeline/summary.hpp"
#include "prefilter/outliers.hpp"
#include "prefilter/source.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

constexpr int kDefaultTileWidth = 128;
constexpr int kDefaultTileHeight = 32;
constexpr double kMainShare = 0.97;              // of the progress
constexpr double kRestShare = 1.0 - kMainShare;  // inspecting the input and summing up
constexpr double kSurveyShare = 0.12;            // of a filter's share
constexpr double kBlendShare = 0.05;             // of the main share, where there are several filters
constexpr double kExternalShare = 0.05;          // of the main share, for each external candidate

bool is_limited(const Execution& execution) { return execution.memory && execution.memory->limit().bytes > 0; }

exec::RowPipelineGeometry geometry_of(const Frame& frame, const Execution& execution, int threads) {
  exec::RowPipelineGeometry geometry;
  geometry.width = frame.width;
  geometry.height = frame.height;
  const int width = execution.tile_width > 0 ? execution.tile_width : kDefaultTileWidth;
  geometry.tile_width = (width + kernels::kMaxLanes - 1) / kernels::kMaxLanes * kernels::kMaxLanes;
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

// What the steps of a run share.
struct Run {
  const DenoiseParams& params;
  const Source& source;
  const Source& given;  // before outliers were scaled down
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

  // Surveys for the filter where it wants that. Returns what is left of the share.
  double survey(FilterJob& job, double share) {
    if (!job.wants_survey()) return share;
    const double part = share * kSurveyShare;
    clock.measure("survey", [&] { job.survey(runner, part); });
    return share - part;
  }

  void doubt(const Survey& findings, bool knows_covariances) {
    for (std::string& text : doubts(findings, knows_covariances)) result.report.warnings.push_back(std::move(text));
  }
};

// One filter: its picture is the result, and no plane of the image's size is needed beside that.
void filter_alone(Run& run, bool knows_covariances) {
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

// A filter's picture of the whole image.
struct Picture {
  exec::RowRing rows;
  Plane choice;  // none of an external candidate, which is one entry
};

Picture make_picture(Run& run, const FilterPlan& plan, double share, Survey* findings) {
  const exec::RowPipelineGeometry& geometry = run.geometry;
  Picture picture{exec::RowRing(MixtureRows::planes(run.layers.channels()), geometry.width, geometry.height,
                                run.source.memory(), Memory::Use::kImage),
                  Plane(geometry.width, geometry.height, run.source.memory())};
  FilterJob job(run.source, run.layers, plan, run.params.selection, geometry, {}, run.runner.slots());
  const double left = run.survey(job, share);
  run.execute(job.plan_stages({MixtureRows(picture.rows), &picture.choice}), left);
  if (findings != nullptr) *findings = job.findings();
  return picture;
}

// The mixture gets back what outliers lost, whatever it is of; a candidate that never lost it must not have it twice.
void take_outlier_energy(Run& run, const exec::RowRing& rows) {
  const MixtureRows picture(rows);
  const int width = run.geometry.width;
  run.runner.for_each(run.geometry.height, 0.0, [&](int y, int) {
    for (int c = 0; c < 3; ++c) {
      run.energy.add_colour(c, y, 0, width, -1.0F, picture.result(c, y));
      run.energy.add_divergence(c, y, 0, width, -1.0F, picture.divergence(c, y));
    }
    for (int c = 0; c < run.layers.channels(); ++c) run.energy.add_layer(c, y, 0, width, -1.0F, picture.layer(c, y));
  });
}

std::vector<Picture> external_pictures(Run& run) {
  std::vector<Picture> pictures;
  for (const ExternalCandidate& candidate : run.params.candidates) {
    run.clock.measure("external", [&] {
      pictures.push_back(
          {external_picture(run.given, candidate, run.runner, kMainShare * kExternalShare, run.result.report.warnings),
           Plane()});
      take_outlier_energy(run, pictures.back().rows);
    });
  }
  return pictures;
}

// From the index of a picture to that of an entry of all filters, in the order of candidate_names().
void name_choices(const std::vector<Picture>& pictures, const std::vector<int>& first_entry, const Rect& tile,
                  Plane& choice) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    float* row = choice.row(y);
    for (int x = tile.x0; x < tile.x1; ++x) {
      const auto picture = static_cast<std::size_t>(row[x]);
      if (picture == 0) continue;
      const Plane& own = pictures[picture - 1].choice;
      const float entry = own ? own.row(y)[x] : 1.0F;
      row[x] = entry == 0.0F ? 0.0F : entry + static_cast<float>(first_entry[picture - 1]);
    }
  }
}

// What each picture has more of an error than the result, where that is their mixture and no more of the input.
void tell_errors(Run& run, const std::vector<Picture>& pictures) {
  if (run.params.strength != 1.0F) return;
  std::vector<MixtureRows> rows;
  for (const Picture& picture : pictures) rows.emplace_back(picture.rows);
  const std::vector<double> more = distances_from_mixture(rows, run.result.colour, run.source, run.energy, run.runner);
  DenoiseReport& report = run.result.report;
  for (std::size_t p = 0; p < more.size(); ++p)
    report.filters[p].mean_relative_error = report.mean_relative_error + more[p];
}

// Several filters, one after the other, and then their mixture.
void filter_together(Run& run, bool knows_covariances) {
  std::vector<Picture> pictures;
  std::vector<BlendPicture> rows;
  std::vector<int> first_entry;  // of a filter, minus 1
  std::vector<double> costs;
  for (const FilterPlan& plan : run.plans)
    costs.push_back(static_cast<double>(candidate_names(plan.spec).size() * static_cast<std::size_t>(plan.runs())));
  const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
  Survey findings;
  int entries = 0;
  std::vector<Picture> external = external_pictures(run);  // first: they are what can turn out to be unusable
  const double left = 1.0 - kBlendShare - kExternalShare * static_cast<double>(external.size());
  pictures.reserve(run.plans.size() + external.size());
  for (std::size_t f = 0; f < run.plans.size(); ++f) {
    pictures.push_back(
        make_picture(run, run.plans[f], kMainShare * left * costs[f] / all, f == 0 ? &findings : nullptr));
    first_entry.push_back(entries);
    entries += static_cast<int>(candidate_names(run.plans[f].spec).size()) - 1;
  }
  run.doubt(findings, knows_covariances);
  for (Picture& picture : external) {
    pictures.push_back(std::move(picture));
    first_entry.push_back(entries++);
  }
  for (std::size_t p = 0; p < pictures.size(); ++p)
    rows.push_back({MixtureRows(pictures[p].rows), p >= run.plans.size()});

  std::optional<Blend> blend;
  run.clock.measure("weigh",
                    [&] { blend.emplace(run.source, run.layers, rows, run.runner, kMainShare * kBlendShare / 2); });
  const exec::RowRing mixed(MixtureRows::planes(run.layers.channels()), run.geometry.width,
                            exec::ring_capacity(run.geometry, {}), run.source.memory());
  const GuideRows guides =
      make_guides(run.plans.front().spec, run.source, exec::ring_capacity(run.geometry, error_halos()));
  ErrorStages errors(run.source, run.layers, run.energy, run.params, MixtureRows(mixed), guides, run.geometry,
                     run.runner.slots(), run.result);
  const int pitch = run.geometry.tile_width;
  std::vector<std::vector<float>> lines(
      static_cast<std::size_t>(run.runner.slots()),
      std::vector<float>(static_cast<std::size_t>(pitch) * static_cast<std::size_t>(blend->pictures())));
  std::vector<exec::RowStage> stages = {{"blend", 0, 1.0, [&](const Rect& tile, int slot) {
                                           guides.prepare(tile);
                                           blend->run(tile, {MixtureRows(mixed), &run.result.choice},
                                                      lines[static_cast<std::size_t>(slot)].data(), pitch);
                                           name_choices(pictures, first_entry, tile, run.result.choice);
                                         }}};
  stages.insert(stages.end(), errors.list().begin(), errors.list().end());
  run.execute(stages, kMainShare * kBlendShare / 2);
  const MixtureWeights weights = blend->mean_weights();
  errors.calibrate(run.runner);
  for (std::size_t f = 0; f < pictures.size(); ++f) run.result.report.filters[f].weight = weights[f + 1];
  run.clock.measure("error", [&] { tell_errors(run, pictures); });
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
  Run run{params, source, given, layers, energy, geometry_of(frame, params.execution, runner.slots()),
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
