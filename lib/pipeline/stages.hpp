// SPDX-License-Identifier: Apache-2.0
//
// The stages of the method. Each works on tiles and reads what earlier ones left in windows of rows;
// pipeline/denoise.cpp runs them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exec/row_pipeline.hpp"
#include "filters/filter.hpp"
#include "select/guided_pass.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// Entry 0 is the unfiltered input, entry k the filter's candidate k - 1.
class Stages {
 public:
  /// Everything referred to must outlive this.
  Stages(const Source& source, const DenoiseParams& params, Risk risk, const exec::RowPipelineGeometry& geometry,
         int slots, DenoiseResult& result);

  /// In the order in which they run. The stages refer to this object.
  [[nodiscard]] const std::vector<exec::RowStage>& list() const noexcept { return list_; }

 private:
  using TileStep = void (Stages::*)(const Rect& tile, int slot);

  /// The filter on the frame, or on a perturbed one.
  struct Run {
    std::optional<Source> perturbed;
    std::optional<GuideRows> guides;
    std::unique_ptr<PreparedFilter> filter;
    MapRows candidates;  ///< F and D
  };

  void add_run(Risk risk, const std::optional<Perturbation>& perturbation);
  void plan(int slots);
  void plan_run(std::size_t index);
  /// Appends a chain of smoothing passes over `maps`; `then` handles each tile of the last one. Returns where that
  /// leaves them.
  MapRows add_passes(const std::string& name, MapRows maps, PassKernel kernel, const std::vector<int>& steps,
                     TileStep then);
  MapRows add_ring(int planes);

  void add_draw(const Run& draw, const Rect& tile, float* lines);
  void estimate_risk(const Rect& tile, int slot);
  void pick(const Rect& tile, int slot);
  void mix(const Rect& tile, int slot);
  void finish(const Rect& tile, int slot);

  void risk_row(const Rect& tile, int y, float* lines);
  void mix_row(const Rect& tile, int y, float* lines);
  void density_row(const Rect& tile, int y, float* lines);

  const Source& source_;
  const DenoiseParams& params_;
  exec::RowPipelineGeometry geometry_;
  DenoiseResult& result_;
  int ring_rows_;
  std::vector<std::unique_ptr<exec::RowRing>> rings_;
  std::vector<std::unique_ptr<Run>> runs_;  // the frame's own first, then the draws of a Monte Carlo risk
  int entries_ = 0;
  MapRows raw_risks_;  // relative risk of the entries
  MapRows risks_;      // the same, smoothed, then the choice
  MapRows weights_;
  MapRows raw_errors_;                     // risk of the mixture per channel
  MapRows errors_;                         // the same, smoothed
  std::vector<FilterScratch> scratch_;     // per slot
  std::vector<std::vector<float>> lines_;  // per slot: rows as wide as a tile
  std::vector<exec::RowStage> list_;
};

}  // namespace stein
