// SPDX-License-Identifier: Apache-2.0
#include "exec/row_pipeline.hpp"

#include <algorithm>
#include <atomic>
#include <vector>

#include "catch.hpp"
#include "exec/buffers.hpp"

namespace stein::exec {
namespace {

const std::vector<std::vector<int>> kHalos = {{0},          {0, 0, 0},       {0, 3},         {0, 16, 2, 4, 8},
                                              {0, 1, 0, 5}, {0, 2, 2, 2, 9}, {4, 40, 1, 13}, {0, 100, 3}};

// Stages that stamp each row of their plane of a ring with its number, and look whether the rows that they may read
// carry theirs. A row that is not ready yet, or already overwritten, carries another number.
class Stamps {
 public:
  Stamps(const RowPipelineGeometry& geometry, const std::vector<int>& halos, int capacity)
      : geometry_(geometry),
        halos_(halos),
        ring_(static_cast<int>(halos.size()), geometry.width, capacity),
        runs_(halos.size() * static_cast<std::size_t>(geometry.width * geometry.height)) {
    for (int s = 0; s < static_cast<int>(halos.size()); ++s) {
      for (int y = 0; y < capacity; ++y) std::fill_n(ring_.row(s, y), geometry.width, -1.0F);
    }
  }

  std::vector<RowStage> stages() {
    std::vector<RowStage> stages;
    for (std::size_t s = 0; s < halos_.size(); ++s) {
      stages.push_back({"stage " + std::to_string(s), halos_[s], 1.0 + static_cast<double>(s),
                        [this, s](const Rect& tile, int) { run(static_cast<int>(s), tile); }});
    }
    return stages;
  }

  [[nodiscard]] bool each_pixel_ran_once() const {
    return std::all_of(runs_.begin(), runs_.end(), [](const std::atomic<int>& n) { return n == 1; });
  }
  [[nodiscard]] int wrong_rows() const { return wrong_rows_; }
  [[nodiscard]] int bad_tiles() const { return bad_tiles_; }

 private:
  void run(int stage, const Rect& tile) {
    const bool fits = tile.x0 % geometry_.tile_width == 0 && tile.width() > 0 && tile.width() <= geometry_.tile_width &&
                      tile.height() > 0 && tile.height() <= geometry_.tile_height && tile.x1 <= geometry_.width &&
                      tile.y1 <= geometry_.height;
    if (!fits) ++bad_tiles_;
    const int halo = halos_[static_cast<std::size_t>(stage)];
    const int first = std::max(tile.y0 - halo, 0);
    const int last = std::min(tile.y1 + halo, geometry_.height) - 1;
    for (int earlier = 0; earlier < stage; ++earlier) {
      for (int y = first; y <= last; ++y) {
        for (int x = 0; x < geometry_.width; ++x) {
          if (ring_.row(earlier, y)[x] != static_cast<float>(y)) ++wrong_rows_;
        }
      }
    }
    for (int y = tile.y0; y < tile.y1; ++y) {
      std::fill_n(ring_.row(stage, y) + tile.x0, tile.width(), static_cast<float>(y));
      for (int x = tile.x0; x < tile.x1; ++x) {
        const int row = stage * geometry_.height + y;
        const int pixel = row * geometry_.width + x;
        ++runs_[static_cast<std::size_t>(pixel)];
      }
    }
  }

  RowPipelineGeometry geometry_;
  std::vector<int> halos_;
  RowRing ring_;
  std::vector<std::atomic<int>> runs_;  // [stage][y][x]
  std::atomic<int> wrong_rows_{0};
  std::atomic<int> bad_tiles_{0};
};

// Returns false at the first thing that is wrong.
bool is_right(const RowPipelineGeometry& geometry, const std::vector<int>& halos, int capacity, Runner& runner) {
  Stamps stamps(geometry, halos, capacity);
  const std::vector<double> seconds = run_row_pipeline(geometry, stamps.stages(), runner, 1.0);
  return stamps.wrong_rows() == 0 && stamps.bad_tiles() == 0 && stamps.each_pixel_ran_once() &&
         seconds.size() == halos.size();
}

Runner& single() {
  static Runner runner([] {
    Execution execution;
    execution.threads = 1;
    return execution;
  }());
  return runner;
}

}  // namespace

TEST_CASE("row pipeline: stages read finished rows only and run every row once, for all heights from 1 to 70") {
  for (int height = 1; height <= 70; ++height) {
    for (const std::vector<int>& halos : kHalos) {
      for (const int band : {1, 4, 13, height}) {
        const RowPipelineGeometry geometry{3, height, 16, 4, std::min(band, height)};
        INFO(height << " rows, bands of " << band << ", " << halos.size() << " stages");
        CHECK(is_right(geometry, halos, height, single()));  // the whole image fits: only the order is at stake
      }
    }
  }
}

TEST_CASE("row pipeline: a ring of ring_capacity() rows loses none that a stage may still read") {
  int smaller_than_image = 0;
  for (int height = 1; height <= 70; ++height) {
    for (const std::vector<int>& halos : kHalos) {
      for (const int band : {1, 4, 13, height}) {
        const RowPipelineGeometry geometry{3, height, 16, 4, std::min(band, height)};
        const int capacity = ring_capacity(geometry, halos);
        INFO(height << " rows, bands of " << band << ", " << halos.size() << " stages, " << capacity << " rows held");
        CHECK(capacity <= height);
        CHECK(is_right(geometry, halos, capacity, single()));
        smaller_than_image += capacity < height ? 1 : 0;
      }
    }
  }
  CHECK(smaller_than_image > 500);
}

TEST_CASE("row pipeline: no stage takes on more rows at a time than a band") {
  for (const std::vector<int>& halos : kHalos) {
    const RowPipelineGeometry geometry{3, 61, 16, 64, 7};
    int most = 0;
    std::vector<RowStage> stages;
    for (const int halo : halos) {
      stages.push_back({"stage", halo, 1.0, [&](const Rect& tile, int) { most = std::max(most, tile.height()); }});
    }
    run_row_pipeline(geometry, stages, single(), 1.0);
    CHECK(most == 7);
  }
}

TEST_CASE("row pipeline: several threads and tiles across, in rings") {
  Execution execution;
  execution.threads = 3;
  Runner runner(execution);
  for (const int height : {1, 9, 40, 70}) {
    for (const std::vector<int>& halos : kHalos) {
      const RowPipelineGeometry geometry{75, height, 16, 3, std::min(7, height)};
      CHECK(is_right(geometry, halos, ring_capacity(geometry, halos), runner));
    }
  }
}

TEST_CASE("row pipeline: progress of all threads and stages sums to the weight it was given") {
  for (const int threads : {1, 3}) {
    std::vector<double> told;
    Execution execution;
    execution.threads = threads;
    execution.progress = [&](double done) {
      told.push_back(done);
      return true;
    };
    Runner runner(execution);
    const RowPipelineGeometry geometry{40, 53, 16, 4, 12};
    CHECK(is_right(geometry, {0, 3, 8, 0}, 53, runner));
    REQUIRE_FALSE(told.empty());
    CHECK(told.back() == Approx(1.0).epsilon(1e-12));
    CHECK(std::is_sorted(told.begin(), told.end()));
  }
}

TEST_CASE("row pipeline: bands hold whole rows of tiles, enough for all threads, and no more than the image") {
  for (const int threads : {1, 2, 16}) {
    for (const int width : {1, 128, 1000, 3840}) {
      for (const int height : {1, 50, 5000}) {
        const RowPipelineGeometry geometry{width, height, 128, 32, 0};
        const int band = band_height(geometry, threads);
        CHECK(band >= 1);
        CHECK(band <= height);
        if (band == height) continue;
        CHECK(band % 32 == 0);
        CHECK((width + 127) / 128 * (band / 32) >= 4 * threads);
      }
    }
  }
}

}  // namespace stein::exec
