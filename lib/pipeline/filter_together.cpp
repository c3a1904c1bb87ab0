// SPDX-License-Identifier: Apache-2.0
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/blend.hpp"
#include "pipeline/error_stages.hpp"
#include "pipeline/external_picture.hpp"
#include "pipeline/picture_errors.hpp"
#include "pipeline/run.hpp"

namespace stein {
namespace {

constexpr double kBlendShare = 0.05;     // of the main share
constexpr double kExternalShare = 0.05;  // of the main share, for each external candidate

// A filter's picture of the whole image.
struct Picture {
  exec::RowRing rows;
  Plane choice;  // none of an external candidate, which is one entry
};

Picture make_picture(DenoiseRun& run, const FilterPlan& plan, double share, Survey* findings) {
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
void take_outlier_energy(DenoiseRun& run, const exec::RowRing& rows) {
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

std::vector<Picture> external_pictures(DenoiseRun& run) {
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
void tell_errors(DenoiseRun& run, const std::vector<Picture>& pictures) {
  if (run.params.strength != 1.0F) return;
  std::vector<MixtureRows> rows;
  for (const Picture& picture : pictures) rows.emplace_back(picture.rows);
  const std::vector<double> more = distances_from_mixture(rows, run.result.colour, run.source, run.energy, run.runner);
  DenoiseReport& report = run.result.report;
  for (std::size_t p = 0; p < more.size(); ++p)
    report.filters[p].mean_relative_error = report.mean_relative_error + more[p];
}

}  // namespace

void filter_together(DenoiseRun& run, bool knows_covariances) {
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
  const GuideRows guides = make_guides(
      run.plans.front().spec, run.source,
      {exec::ring_capacity(run.geometry, error_halos()), run.geometry.tile_width, run.geometry.tile_height});
  std::vector<exec::TileScratch> scratch(static_cast<std::size_t>(run.runner.slots()));
  ErrorStages errors(run.source, run.layers, run.energy, run.params, MixtureRows(mixed), guides, run.geometry,
                     run.runner.slots(), run.result);
  const int pitch = run.geometry.tile_width;
  std::vector<std::vector<float>> lines(
      static_cast<std::size_t>(run.runner.slots()),
      std::vector<float>(static_cast<std::size_t>(pitch) * static_cast<std::size_t>(blend->pictures())));
  std::vector<exec::RowStage> stages = {{"blend", 0, 1.0, [&](const Rect& tile, int slot) {
                                           guides.prepare(tile, scratch[static_cast<std::size_t>(slot)]);
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

}  // namespace stein
