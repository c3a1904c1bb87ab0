// SPDX-License-Identifier: Apache-2.0
//
// How soon a run can be stopped, as a count and not as a time: the callback is asked after each tile of each pass.
#include <algorithm>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kTilesAcross = 6;
constexpr int kTilesDown = 4;

struct Polls {
  int calls = 0;
  double largest_step = 0;
};

Polls count_polls(std::string_view filter) {
  constexpr int kTile = 16;
  OwnedFrame owned(kTilesAcross * kTile, kTilesDown * kTile, kUsualFeatures);
  fill_random(owned, 3);
  DenoiseParams params;
  params.filters = make_filters(filter);
  params.execution.tile_width = kTile;
  params.execution.tile_height = kTile;
  Polls polls;
  double last = 0;
  params.execution.progress = [&](double fraction) {
    ++polls.calls;
    polls.largest_step = std::max(polls.largest_step, fraction - last);
    last = fraction;
    return true;
  };
  static_cast<void>(denoise(owned.frame(), params));
  CHECK(last > 0.99);
  return polls;
}

}  // namespace

TEST_CASE("polls: every filter asks whether to go on after each tile of each of its stages") {
  constexpr int kTiles = kTilesAcross * kTilesDown;
  constexpr int kLeastStages = 6;  // guides, filter, smoothing, selection, mixture, density
  std::vector<std::string_view> filters = {"auto"};
  for (const std::string_view name : filter_names()) filters.push_back(name);
  for (const std::string_view filter : filters) {
    INFO(filter);
    const Polls polls = count_polls(filter);
    CHECK(polls.calls >= kLeastStages * kTiles);
    CHECK(polls.largest_step <= 1.0 / kTiles);
  }
}

}  // namespace stein::test
