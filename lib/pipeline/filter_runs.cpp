// SPDX-License-Identifier: Apache-2.0
#include "pipeline/filter_runs.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "risk/sure.hpp"
#include "select/selection.hpp"
#include "stein/error.hpp"

namespace stein {

namespace {

std::vector<int> joined(std::vector<int> first, const std::vector<int>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

// Of the stages after the first pass, which may begin to add up candidates.
std::vector<int> without_first(std::vector<int> halos) {
  halos.erase(halos.begin());
  return halos;
}

}  // namespace

std::vector<int> run_halos(const FilterPlan& plan) {
  std::vector<int> all;
  for (int run = 0; run < plan.runs(); ++run) all = joined(all, halos(plan.spec));
  return all;
}

FilterRuns::FilterRuns(const Source& source, const LayerSource& layers, const FilterPlan& plan,
                       const exec::RowPipelineGeometry& geometry, const std::vector<int>& readers,
                       const std::vector<int>& guided, int slots)
    : source_(source),
      layers_(layers),
      plan_(plan),
      geometry_(geometry),
      passes_(halos(plan.spec)),
      scratch_(static_cast<std::size_t>(slots)),
      directions_(static_cast<std::size_t>(slots),
                  std::vector<float>(3 * static_cast<std::size_t>(geometry.tile_width))) {
  const std::vector<int> read_by = joined(run_halos(plan), readers);
  const int candidate_rows = exec::ring_capacity(geometry, without_first(read_by));
  add_run({}, exec::ring_capacity(geometry, joined(read_by, guided)), candidate_rows);
  layer_rows_ = exec::RowRing((entries_ - 1) * layers.channels(), geometry.width, candidate_rows, source.memory());
  for (int draw = 0; draw + 1 < plan.runs(); ++draw) {
    add_run(Perturbation{plan.monte_carlo.seed, draw, plan.monte_carlo.step}, exec::ring_capacity(geometry, passes_),
            exec::ring_capacity(geometry, without_first(passes_)));
  }
}

void FilterRuns::add_run(const std::optional<Perturbation>& perturbation, int guide_rows, int candidate_rows) {
  auto run = std::make_unique<Run>();
  if (perturbation) run->perturbed.emplace(source_.perturbed(*perturbation));
  const Source& source = perturbation ? *run->perturbed : source_;
  run->guides.emplace(make_guides(plan_.spec, source, {guide_rows, geometry_.tile_width, geometry_.tile_height}));
  const int pass_rows = exec::window_between(geometry_, passes_);
  const Divergence divergence = plan_.risk == Risk::kJoint ? Divergence::kJoint : Divergence::kPlain;
  run->filter = prepare(plan_.spec, {source, *run->guides, geometry_.tile_width, geometry_.tile_height, pass_rows,
                                     divergence, perturbation ? nullptr : &layers_, plan_.counts});
  entries_ = run->filter->candidates() + 1;
  if (entries_ > kMaxEntries) {
    throw Error(ErrorCode::kInvalidArgument, "the filter has " + std::to_string(entries_ - 1) +
                                                 " candidates; at most " + std::to_string(kMaxEntries - 1) +
                                                 " can be chosen from");
  }
  run->candidates =
      exec::RowRing((entries_ - 1) * CandidateRows::kPlanes, geometry_.width, candidate_rows, source.memory());
  runs_.push_back(std::move(run));
}

void FilterRuns::add_stages(const CutTile& wanted_rows, const TileStep& then, std::vector<exec::RowStage>& list) {
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    Run& run = *runs_[r];
    list.push_back({"guides", 0, 0.5, [this, &run](const Rect& tile, int slot) {
                      run.guides->prepare(tile, scratch_[static_cast<std::size_t>(slot)]);
                    }});
    for (std::size_t p = 0; p < passes_.size(); ++p) {
      const bool is_last = p + 1 == passes_.size();
      const bool has_layers = r == 0 && !wanted_rows;
      const auto run_pass = [this, &run, r, p, is_last, has_layers, then](const Rect& tile, int slot) {
        const auto s = static_cast<std::size_t>(slot);
        run.filter->run(static_cast<int>(p), tile, scratch_[s],
                        has_layers ? candidates() : CandidateRows(run.candidates));
        if (is_last && r > 0) add_draw(run, tile, directions_[s].data());
        if (is_last && r + 1 == runs_.size()) then(tile, slot);
      };
      exec::RowStage stage{r == 0 ? "filter" : "draws", passes_[p], 15.0 / static_cast<double>(passes_.size()),
                           run_pass};
      if (wanted_rows) {
        const int reach = std::accumulate(passes_.begin() + static_cast<std::ptrdiff_t>(p) + 1, passes_.end(), 0);
        stage.run = [run_pass, wanted_rows, reach](const Rect& tile, int slot) {
          for (const Rect& part : wanted_rows(tile, reach)) run_pass(part, slot);
        };
      }
      list.push_back(std::move(stage));
    }
  }
}

void FilterRuns::add_draw(const Run& draw, const Rect& tile, float* directions) const {
  const int n = tile.width();
  const float factor = 1.0F / (plan_.monte_carlo.step * static_cast<float>(plan_.monte_carlo.draws));
  const bool is_first = &draw == runs_[1].get();
  const CandidateRows base = candidates();
  const CandidateRows moved(draw.candidates);
  float* b[3];
  for (int c = 0; c < 3; ++c) b[c] = directions + std::ptrdiff_t{c} * geometry_.tile_width;
  for (int y = tile.y0; y < tile.y1; ++y) {
    draw.perturbed->direction_rows(y, tile.x0, n, b);
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k + 1 < entries_; ++k) {
        float* D = base.divergence(k, c, y) + tile.x0;
        if (is_first) std::fill_n(D, n, 0.0F);
        add_draw_row(b[c], moved.result(k, c, y) + tile.x0, base.result(k, c, y) + tile.x0, factor, n, D);
      }
    }
  }
}

}  // namespace stein
