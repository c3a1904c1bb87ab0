// SPDX-License-Identifier: Apache-2.0
//
// From a filter's candidates to one picture: the stages that compare their risks, choose and mix. Each works on tiles
// and reads what earlier ones left in windows of rows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exec/row_pipeline.hpp"
#include "pipeline/filter_runs.hpp"
#include "pipeline/mixture.hpp"
#include "pipeline/survey.hpp"
#include "select/guided_pass.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// The halos of the stages.
[[nodiscard]] std::vector<int> choice_halos(Selection selection);

/// Entry 0 is the unfiltered input, entry k the filter's candidate k - 1.
class ChoiceStages {
 public:
  /// Everything referred to must outlive this. `prior`: what is known of the image as a whole; where there is none, the
  /// stages show their candidates to `surveyor`.
  ChoiceStages(const Source& source, Selection selection, FilterRuns& runs, const Survey* prior, Surveyor& surveyor,
               const exec::RowPipelineGeometry& geometry, int slots, const Mixture& out);

  /// In the order in which they run. The stages refer to this object.
  [[nodiscard]] const std::vector<exec::RowStage>& list() const noexcept { return list_; }

 private:
  using TileStep = void (ChoiceStages::*)(const Rect& tile, int slot);

  void plan();
  /// Appends a smoothing pass from maps to maps; `then` handles each finished tile.
  void add_pass(const std::string& name, const GuidedPass& pass, MapRows in, MapRows out, TileStep then);
  /// Appends a chain of passes over `maps`. Returns where it leaves them.
  MapRows add_passes(const std::string& name, MapRows maps, const std::vector<int>& steps, TileStep then);
  void add_risk_passes();
  MapRows add_ring(int planes);

  void compare(const Rect& tile, int slot);
  void square(const Rect& tile, int slot);
  void pick(const Rect& tile, int slot);
  void weigh(const Rect& tile, int y, float* const* maps, float* lines);
  void mix(const Rect& tile, int slot);

  [[nodiscard]] float* lines_of(int slot) { return lines_[static_cast<std::size_t>(slot)].data(); }

  const Source& source_;
  Selection selection_;
  FilterRuns& runs_;
  exec::RowPipelineGeometry geometry_;
  Mixture out_;
  int ring_rows_;
  int entries_;
  Surveyor* surveyor_;  // null where the image was surveyed before
  bool weighs_evidence_;
  int baseline_;              // the entry that others are compared with
  std::vector<float> prior_;  // per entry: mean relative risk of the image minus that of the baseline
  std::vector<std::unique_ptr<exec::RowRing>> rings_;
  MapRows differences_;                    // relative risk of the entries but the baseline, minus its own
  MapRows squares_;                        // the same after some passes, with the squares of what came in
  MapRows evidence_;                       // both smoothed
  MapRows choices_;                        // one map per entry: 1 for what was picked; and the optimism of picking
  MapRows weights_;                        // the same, smoothed
  std::vector<std::vector<float>> lines_;  // per slot: rows as wide as a tile
  std::vector<exec::RowStage> list_;
};

}  // namespace stein
