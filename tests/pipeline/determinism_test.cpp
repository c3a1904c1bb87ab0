// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <tuple>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/same_bits.hpp"
#include "support/sanitizers.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

using stein::test::same_bits;  // of planes, beside that of results

bool same_bits(const DenoiseResult& a, const DenoiseResult& b) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (!same_bits(a.colour[c], b.colour[c]) || !same_bits(a.error[c], b.error[c])) return false;
  }
  return same_bits(a.choice, b.choice) && same_bits(a.density, b.density) && same_errors(a.report, b.report) &&
         a.report.choice_share == b.report.choice_share;
}

}  // namespace

TEST_CASE("denoise: 1, 2 and 5 threads and three tile sizes give identical bits") {
#if STEIN_HAS_TSAN  // ten times slower, and as good at finding races in a smaller image
  constexpr bool kIsSlow = true;
  OwnedFrame frame(71, 50, kUsualFeatures);
  const std::vector<std::tuple<int, int, int>> all_filters_runs = {{5, 16, 7}};
#else
  constexpr bool kIsSlow = false;
  OwnedFrame frame(131, 97, kUsualFeatures);
  const std::vector<std::tuple<int, int, int>> all_filters_runs = {{5, 16, 7}, {2, 512, 40}};
#endif
  fill_random(frame, 31);
  const int right = frame.frame().width;
  const int bottom = frame.frame().height;
  frame.at("R", right - 71, bottom - 7) = 500.0F;  // an outlier, and pixels to fill
  frame.at("variance.R", right - 71, bottom - 7) = 250000.0F;
  frame.at("G", right - 31, bottom - 33) = std::numeric_limits<float>::quiet_NaN();
  frame.at("B", right - 30, bottom - 33) = std::numeric_limits<float>::quiet_NaN();
  DenoiseParams argmin;
  argmin.filters = {CrossBilateralParams{}};
  argmin.selection = Selection::kArgmin;
  DenoiseParams monte_carlo;
  monte_carlo.filters = {CrossBilateralParams{}};
  monte_carlo.risk = Risk::kMonteCarlo;
  monte_carlo.monte_carlo.draws = 2;
  DenoiseParams mixed;
  mixed.filters = {CrossBilateralParams{}, AtrousSureParams{}};
  std::vector<DenoiseParams> all = {argmin, monte_carlo, mixed};
  for (const std::string_view name : filter_names()) all.emplace_back().filters = {make_filter(name)};
  for (DenoiseParams& params : all) {
    if (auto* nlm = std::get_if<CrossNlmParams>(&params.filters.front())) nlm->window_radius = 4;  // time
    if (auto* regression = std::get_if<AdaptiveOrderParams>(&params.filters.front())) regression->window_radius = 4;
    const DenoiseResult reference = denoise(frame.frame(), params);
    std::vector<std::tuple<int, int, int>> runs = all_filters_runs;
    const bool has_more_runs = params.filters.front().index() == 0 && !(kIsSlow && params.risk == Risk::kMonteCarlo);
    if (has_more_runs) runs.insert(runs.end(), {{1, 16, 7}, {2, 64, 64}, {5, 64, 64}});
    for (const auto& [threads, width, height] : runs) {
      params.execution.threads = threads;
      params.execution.tile_width = width;
      params.execution.tile_height = height;
      INFO(filter_name(params.filters.front()) << ", " << threads << " threads, tiles of " << width << "x" << height);
      CHECK(same_bits(reference, denoise(frame.frame(), params)));
    }
  }
}

TEST_CASE("denoise: windows of rows give the bits of whole images, for every filter") {
#if STEIN_HAS_TSAN || STEIN_HAS_ASAN
  OwnedFrame frame(20, 400, kUsualFeatures);
#else
  OwnedFrame frame(37, 700, kUsualFeatures);  // far higher than the windows of one thread with small tiles
#endif
  fill_random(frame, 32);
  frame.at("G", 10, 301) = std::numeric_limits<float>::quiet_NaN();
  std::vector<DenoiseParams> all(3);
  all[0].filters = {AtrousSureParams{}};
  all[0].monte_carlo.draws = 2;
  all[1].filters = {CrossBilateralParams{}};
  all[1].selection = Selection::kArgmin;
  all[2].filters = {CrossBilateralParams{}, AtrousParams{}};
  for (const std::string_view name : filter_names()) all.emplace_back().filters = {make_filter(name)};
  for (DenoiseParams& params : all) {
    if (auto* nlm = std::get_if<CrossNlmParams>(&params.filters.front())) nlm->window_radius = 4;  // time
    if (auto* regression = std::get_if<AdaptiveOrderParams>(&params.filters.front())) regression->window_radius = 4;
    params.execution.tile_width = 512;
    params.execution.tile_height = 700;
    const DenoiseResult reference = denoise(frame.frame(), params);
    for (const int threads : {1, 3}) {
      params.execution.threads = threads;
      params.execution.tile_width = 16;
      params.execution.tile_height = 3;
      INFO(filter_name(params.filters.front()) << ", " << threads << " threads");
      CHECK(same_bits(reference, denoise(frame.frame(), params)));
    }
  }
}

}  // namespace stein::test
