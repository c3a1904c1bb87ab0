// SPDX-License-Identifier: Apache-2.0
//
// Runs stages down the image in bands, so that what lies between two stages is a window of rows and not an image.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "exec/rect.hpp"
#include "exec/runner.hpp"

namespace stein::exec {

struct RowStage {
  std::string name;
  int halo = 0;       ///< rows above and below that it reads of earlier stages' results
  double weight = 1;  ///< expected share of the work, for the progress
  std::function<void(const Rect& tile, int slot)> run;
};

struct RowPipelineGeometry {
  int width = 0;
  int height = 0;
  int tile_width = 0;
  int tile_height = 0;
  int band_height = 0;
};

/// Default band: enough tiles to keep all threads busy, few enough rows to stay near the caches. `is_limited`: as few
/// as will do, where memory is short.
[[nodiscard]] int band_height(const RowPipelineGeometry& geometry, int threads, bool is_limited = false);

/// Rows of a ring that a stage fills and that is read up to a later one: `halos` are those of the stages between, and
/// of the last reader. Of all stages: a ring that every stage can read what it needs of any earlier one from.
[[nodiscard]] int ring_capacity(const RowPipelineGeometry& geometry, const std::vector<int>& halos);

/// Rows of rings that one stage fills and the next one reads, whichever of them: the same for all.
[[nodiscard]] int window_between(const RowPipelineGeometry& geometry, const std::vector<int>& halos);

/// Runs every stage over the whole image; stage s reaches row y only when its predecessors have passed y + halo.
/// Adds `progress_weight` to the progress in all. Returns the seconds of each stage.
std::vector<double> run_row_pipeline(const RowPipelineGeometry& geometry, const std::vector<RowStage>& stages,
                                     Runner& runner, double progress_weight);

}  // namespace stein::exec
