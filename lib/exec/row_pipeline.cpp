// SPDX-License-Identifier: Apache-2.0
#include "exec/row_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>

namespace stein::exec {
namespace {

int tiles_across(const RowPipelineGeometry& g) { return (g.width + g.tile_width - 1) / g.tile_width; }

void run_rows(const RowPipelineGeometry& g, const RowStage& stage, int y0, int y1, double weight, Runner& runner) {
  const int across = tiles_across(g);
  const int down = (y1 - y0 + g.tile_height - 1) / g.tile_height;
  runner.for_each(across * down, weight, [&](int item, int slot) {
    Rect tile;
    tile.x0 = item % across * g.tile_width;
    tile.y0 = y0 + item / across * g.tile_height;
    tile.x1 = std::min(tile.x0 + g.tile_width, g.width);
    tile.y1 = std::min(tile.y0 + g.tile_height, y1);
    stage.run(tile, slot);
  });
}

}  // namespace

int band_height(const RowPipelineGeometry& geometry, int threads, bool is_limited) {
  const int tiles_per_thread = is_limited ? 4 : 32;
  const int rows_of_tiles = (tiles_per_thread * threads + tiles_across(geometry) - 1) / tiles_across(geometry);
  return std::min(rows_of_tiles * geometry.tile_height, geometry.height);
}

int ring_capacity(const RowPipelineGeometry& geometry, const std::vector<int>& halos) {
  // Below a stage's band lie the rows that it and those before it are ahead, above it those that it still reads.
  const int ahead = std::accumulate(halos.begin(), halos.end(), 0);
  const int widest = halos.empty() ? 0 : *std::max_element(halos.begin(), halos.end());
  return std::min(geometry.band_height + ahead + widest, geometry.height);
}

int window_between(const RowPipelineGeometry& geometry, const std::vector<int>& halos) {
  return ring_capacity(geometry, {*std::max_element(halos.begin(), halos.end())});
}

std::vector<double> run_row_pipeline(const RowPipelineGeometry& geometry, const std::vector<RowStage>& stages,
                                     Runner& runner, double progress_weight) {
  double total_weight = 0;
  for (const RowStage& stage : stages) total_weight += stage.weight;
  std::vector<double> seconds(stages.size(), 0.0);
  std::vector<int> done(stages.size(), 0);
  // The front goes on beyond the image, so that no stage ever takes on more than a band.
  for (int front = geometry.band_height; done.back() < geometry.height; front += geometry.band_height) {
    int behind = 0;
    for (std::size_t s = 0; s < stages.size(); ++s) {
      if (s > 0) behind += stages[s].halo;
      const int ready = std::clamp(front - behind, 0, geometry.height);
      const auto start = std::chrono::steady_clock::now();
      const double weight = progress_weight * stages[s].weight / total_weight * (ready - done[s]) / geometry.height;
      if (ready > done[s]) run_rows(geometry, stages[s], done[s], ready, weight, runner);
      seconds[s] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      done[s] = ready;
    }
  }
  return seconds;
}

}  // namespace stein::exec
