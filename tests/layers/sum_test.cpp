// SPDX-License-Identifier: Apache-2.0
//
// Layers that sum up to the colour sum up to the filtered colour, whatever the filter.
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "layers/split.hpp"
#include "support/same_bits.hpp"

namespace stein::test {
namespace {

bool same_layers(const DenoiseResult& a, const DenoiseResult& b) {
  for (std::size_t l = 0; l < a.layers.size(); ++l) {
    for (std::size_t c = 0; c < a.layers[l].mean.size(); ++c) {
      if (!same_bits(a.layers[l].mean[c], b.layers.at(l).mean.at(c))) return false;
    }
  }
  return a.layers.size() == b.layers.size();
}

double largest_difference(const FilteredLayer& layer, const std::array<Plane, 3>& colour) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < colour[c].height(); ++y) {
      for (int x = 0; x < colour[c].width(); ++x) {
        const double whole = colour[c].row(y)[x];
        const double error = std::abs(layer.mean[c].row(y)[x] - whole) / std::max(std::abs(whole), 1e-3);
        largest = std::max(largest, std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
      }
    }
  }
  return largest;
}

// An outlier, holes and a hole at the border.
void add_trouble(OwnedFrame& frame) {
  frame.at("R", 20, 20) = 500.0F;
  frame.at("variance.R", 20, 20) = 250000.0F;
  frame.at("sampleCount", 30, 30) = 0.0F;
  frame.at("sampleCount", 31, 30) = 0.0F;
  frame.at("sampleCount", 0, 5) = 0.0F;
}

DenoiseParams params_of(const std::vector<FilterSpec>& filters) {
  DenoiseParams params;
  params.filters = filters;
  return params;
}

}  // namespace

TEST_CASE("layers: parts of the colour sum up to the filtered colour") {
  SplitFrame split(53, 41, 41);
  add_trouble(split.owned());
  split.add_parts(1);
  for (const std::vector<FilterSpec>& filters : layer_filters()) {
    INFO(filter_name(filters.front()) << " and " << filters.size() - 1);
    const DenoiseResult result = denoise(split.frame(), params_of(filters));
    CHECK(result.report.outlier_pixels > 0);
    CHECK(result.report.frame.invalid_pixels == 3);
    CHECK(error_of_sum(result) < 1e-5);
  }
}

TEST_CASE("layers: the sum holds for every way to choose, to estimate and to blend") {
  SplitFrame split(53, 41, 42);
  add_trouble(split.owned());
  split.add_parts(2);
  DenoiseParams params;
  SECTION("argmin") { params.selection = Selection::kArgmin; }
  SECTION("strength") { params.strength = 0.4F; }
  SECTION("the input alone") { params.strength = 0.0F; }
  SECTION("outliers left alone") { params.outliers.enabled = false; }
  SECTION("a second pass") { params.second_pass = true; }
  SECTION("Monte Carlo risk") {
    params.risk = Risk::kMonteCarlo;
    params.monte_carlo.draws = 2;
  }
  CHECK(error_of_sum(denoise(split.frame(), params)) < 1e-5);
}

TEST_CASE("layers: the sum holds with each instruction set of this machine") {
  SplitFrame split(23, 17, 47);
  split.add_parts(4);
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    for (const std::vector<FilterSpec>& filters : layer_filters()) {
      hwy::SetSupportedTargetsForTest(targets & -targets);
      const double error = error_of_sum(denoise(split.frame(), params_of(filters)));
      hwy::SetSupportedTargetsForTest(0);
      INFO(hwy::TargetName(targets & -targets) << ": " << filter_name(filters.front()));
      CHECK(error < 1e-5);
    }
  }
}

TEST_CASE("layers: parts are what the filter makes of them, not shares of the colour") {
  SplitFrame split(53, 41, 43);
  split.add_parts(3);
  const DenoiseResult result = denoise(split.frame());
  const Plane& key = result.layers.at(0).mean.at(1);
  double raw = 0;
  double filtered = 0;
  for (int y = 1; y < key.height(); ++y) {
    for (int x = 0; x < key.width(); ++x) {
      raw += std::abs(split.plane("key", 1).row(y)[x] - split.plane("key", 1).row(y - 1)[x]);
      filtered += std::abs(key.row(y)[x] - key.row(y - 1)[x]);
    }
  }
  CHECK(filtered < 0.3 * raw);
}

TEST_CASE("layers: one that is the colour becomes the filtered colour") {
  SplitFrame split(53, 41, 44);
  add_trouble(split.owned());
  split.add_copy("copy");
  for (const std::vector<FilterSpec>& filters : layer_filters()) {
    INFO(filter_name(filters.front()) << " and " << filters.size() - 1);
    const DenoiseResult result = denoise(split.frame(), params_of(filters));
    const bool is_regression = std::holds_alternative<AdaptiveOrderParams>(filters.front());
    CHECK(largest_difference(result.layers.at(0), result.colour) <= (is_regression ? 1e-5 : 0.0));
  }
}

TEST_CASE("layers: alpha that is 1 everywhere stays 1, also at outliers and holes") {
  SplitFrame split(53, 41, 45);
  add_trouble(split.owned());
  split.add_constant("A", 1.0F);
  for (const std::vector<FilterSpec>& filters : layer_filters()) {
    INFO(filter_name(filters.front()) << " and " << filters.size() - 1);
    const DenoiseResult result = denoise(split.frame(), params_of(filters));
    REQUIRE(result.layers.at(0).name == "A");
    for (int y = 0; y < 41; ++y) {
      for (int x = 0; x < 53; ++x) CHECK(result.layers[0].mean.at(0).row(y)[x] == Approx(1).epsilon(2e-6));
    }
  }
}

TEST_CASE("layers: they change nothing else, and are the same for any threads and tiles") {
  SplitFrame split(53, 37, 46);
  add_trouble(split.owned());
  SplitFrame with_layers(53, 37, 46);
  add_trouble(with_layers.owned());
  with_layers.add_parts(4);
  with_layers.add_constant("A", 0.25F);
  with_layers.plane("fill", 1).row(25)[40] = std::numeric_limits<float>::quiet_NaN();
  for (const std::vector<FilterSpec>& filters : layer_filters()) {
    INFO(filter_name(filters.front()) << " and " << filters.size() - 1);
    DenoiseParams params = params_of(filters);
    const DenoiseResult plain = denoise(split.frame(), params);
    const DenoiseResult reference = denoise(with_layers.frame(), params);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(same_bits(plain.colour[c], reference.colour[c]));
      CHECK(same_bits(plain.error[c], reference.error[c]));
    }
    params.execution.threads = 3;
    params.execution.tile_width = 16;
    params.execution.tile_height = 7;
    CHECK(same_layers(reference, denoise(with_layers.frame(), params)));
  }
}

TEST_CASE("layers: high images, in a window of rows") {
  SplitFrame split(20, 300, 47);
  split.add_parts(5);
  for (const std::string_view name : {"atrous-sure", "cross-bilateral", "cross-bilateral,atrous"}) {
    DenoiseParams params = params_of(make_filters(name));
    params.execution.tile_height = 300;
    const DenoiseResult whole = denoise(split.frame(), params);
    params.execution.threads = 1;
    params.execution.tile_width = 16;
    params.execution.tile_height = 3;
    const DenoiseResult result = denoise(split.frame(), params);
    CHECK(same_layers(whole, result));
    CHECK(error_of_sum(result) < 1e-5);
  }
}

TEST_CASE("layers: as many as one likes") {
  SplitFrame split(33, 20, 48);
  for (int i = 0; i < 40; ++i) split.add_copy("copy" + std::to_string(i));
  for (const std::vector<FilterSpec>& filters : layer_filters()) {
    INFO(filter_name(filters.front()) << " and " << filters.size() - 1);
    const DenoiseResult result = denoise(split.frame(), params_of(filters));
    REQUIRE(result.layers.size() == 40);
    for (std::size_t l = 1; l < 40; ++l) {
      for (std::size_t c = 0; c < 3; ++c) CHECK(same_bits(result.layers[0].mean.at(c), result.layers[l].mean.at(c)));
    }
  }
}

}  // namespace stein::test
