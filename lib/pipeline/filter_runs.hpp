// SPDX-License-Identifier: Apache-2.0
//
// The filter on the frame and, for a Monte Carlo risk, on perturbed ones.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "exec/row_pipeline.hpp"
#include "filters/filter.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// A filter, and how its risk is estimated.
struct FilterPlan {
  const FilterSpec& spec;
  Risk risk = Risk::kPlain;  ///< never kAuto
  const MonteCarloParams& monte_carlo;
  bool counts = false;  ///< see FilterContext
  /// Runs of the filter: on the frame itself, and on perturbed ones.
  [[nodiscard]] int runs() const noexcept { return risk == Risk::kMonteCarlo ? 1 + monte_carlo.draws : 1; }
};

/// The halos of all passes of all runs.
[[nodiscard]] std::vector<int> run_halos(const FilterPlan& plan);

class FilterRuns {
 public:
  /// Everything referred to must outlive this. `readers`: halos of the stages that follow up to the last one that reads
  /// candidates(), and `guided` of those from there to the last one that reads guides().
  FilterRuns(const Source& source, const LayerSource& layers, const FilterPlan& plan,
             const exec::RowPipelineGeometry& geometry, const std::vector<int>& readers, const std::vector<int>& guided,
             int slots);

  [[nodiscard]] int entries() const noexcept { return entries_; }  ///< candidates and the unfiltered input
  [[nodiscard]] int common_candidate() const noexcept { return runs_.front()->filter->common_candidate(); }
  [[nodiscard]] float risk_limit() const noexcept { return runs_.front()->filter->risk_limit(); }
  [[nodiscard]] int passes() const noexcept { return static_cast<int>(passes_.size()); }
  [[nodiscard]] const GuideRows& guides() const noexcept { return *runs_.front()->guides; }
  [[nodiscard]] const LayerSource& layers() const noexcept { return layers_; }
  /// F and D of the frame's own run, and its layers.
  [[nodiscard]] CandidateRows candidates() const noexcept {
    return CandidateRows(runs_.front()->candidates).with_layers(layer_rows_, layers_.channels());
  }

  using TileStep = std::function<void(const Rect& tile, int slot)>;
  /// Appends the stages that fill candidates(); `then` is called for each tile that is done. With `wanted_rows`, which
  /// may cut a tile to the rows that are needed or no more than `reach` rows away from those, passes leave out others,
  /// and the layers.
  using CutTile = std::function<std::vector<Rect>(const Rect& tile, int reach)>;
  void add_stages(const CutTile& wanted_rows, const TileStep& then, std::vector<exec::RowStage>& list);

 private:
  struct Run {
    std::optional<Source> perturbed;
    std::optional<GuideRows> guides;
    std::unique_ptr<PreparedFilter> filter;
    exec::RowRing candidates;
  };

  void add_run(const std::optional<Perturbation>& perturbation, int guide_rows, int candidate_rows);
  void add_draw(const Run& draw, const Rect& tile, float* directions) const;

  const Source& source_;
  const LayerSource& layers_;
  FilterPlan plan_;
  exec::RowPipelineGeometry geometry_;
  std::vector<int> passes_;
  std::vector<std::unique_ptr<Run>> runs_;  // the frame's own first, then the draws
  int entries_ = 0;
  exec::RowRing layer_rows_;                    // of the frame's own run
  std::vector<FilterScratch> scratch_;          // per slot
  std::vector<std::vector<float>> directions_;  // per slot: three rows as wide as a tile
};

}  // namespace stein
