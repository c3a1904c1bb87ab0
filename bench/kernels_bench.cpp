// SPDX-License-Identifier: Apache-2.0
//
// Kernels over one tile, filters of several passes over a frame; one thread. items = pixels; flops as counted in
// docs/performance.md.
#include <benchmark/benchmark.h>

#include <type_traits>
#include <variant>
#include <vector>

#include "exec/runner.hpp"
#include "filters/filter.hpp"
#include "filters/taps.hpp"
#include "kernels/guides.hpp"
#include "kernels/local_polynomial.hpp"
#include "synthetic_frame.hpp"

namespace stein::bench {
namespace {

// Flops of the bank per pixel: per tap 21 for seven channels, 17 for three groups, 16 for the exponential, 8 for mask
// and sums; per batch and scale 8.
double bank_flops(const CrossBilateralParams& params, const exec::TileLayout& layout) {
  const ScaleTaps taps(params.spatial_sigmas, layout);
  double flops = 62.0 * static_cast<double>(taps.offsets.size());
  for (const int first : taps.first_scale) {
    flops += 8.0 * static_cast<double>(params.spatial_sigmas.size() - static_cast<std::size_t>(first));
  }
  return flops;
}

// Flops of the fits per pixel with SURE, seven features and all four directions that they can have,
// docs/performance.md; without the smoothing of the features.
double regression_flops(const AdaptiveOrderParams& params) {
  constexpr double kFeatures = 7;
  constexpr double kDirections = kernels::kMaxFeatureDimensions;
  constexpr double kDimensions = kernels::kMaxDimensions;
  const double side = 2.0 * params.window_radius + 1.0;
  // Sums along y of a block's columns and those beside it, then along x.
  const double window_sums = 1.0 + 2.0 * kFeatures + kFeatures * (kFeatures + 1.0) / 2.0;
  const double covariance = window_sums * (side - 1.0) * (2.0 + 2.0 * params.window_radius / kernels::kNlmBlockWidth);
  const double eigenvectors = 6.0 * kFeatures * (kFeatures - 1.0) / 2.0 * (18.0 * kFeatures + 15.0);
  const double distances = 29.0 + 54.0;
  const double order = params.orders.back();
  const double powers = 3.0 + kFeatures * (1.0 + 2.0 * kDirections) + 2.0 * (order - 1.0) * kDimensions;
  const double columns = 1.0 + order * kDimensions;
  double sigma = 2.0 * 18.0 + columns * (columns + 8.0);  // weights, normal equations
  for (const int each : params.orders) sigma += 8.0 * each * kDimensions + 13.0;
  const auto sigmas = static_cast<double>(params.range_sigmas.size());
  return covariance + eigenvectors + side * side * (distances + 2.0 * powers + 15.0 + sigmas * sigma);
}

void run_filter(benchmark::State& state, const FilterSpec& spec, Divergence divergence) {
  constexpr int kWidth = 128;
  constexpr int kHeight = 32;
  const BenchFrame frame(kWidth * 3, kHeight * 3, divergence == Divergence::kJoint);
  const Source source(frame.frame(), inspect(frame.frame()));
  const GuideRows guides = make_guides(spec, source, {kHeight * 3, kWidth * 3, kHeight * 3});
  FilterScratch scratch;
  guides.prepare({0, 0, kWidth * 3, kHeight * 3}, scratch);
  const auto filter = prepare(spec, {source, guides, kWidth, kHeight, kHeight * 3, divergence});
  const exec::RowRing ring(filter->candidates() * CandidateRows::kPlanes, kWidth * 3, kHeight * 3);
  for (auto _ : state) filter->run(0, {kWidth, kHeight, 2 * kWidth, 2 * kHeight}, scratch, CandidateRows(ring));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kWidth * kHeight);
  if (const auto* params = std::get_if<CrossBilateralParams>(&spec)) {
    const exec::TileLayout layout(kWidth, kHeight, reach(spec));
    state.counters["flops"] = benchmark::Counter(kWidth * kHeight * bank_flops(*params, layout),
                                                 benchmark::Counter::kIsIterationInvariantRate);
  }
  state.SetLabel(kernels::instruction_set());
}

void run_bank(benchmark::State& state, const FilterSpec& spec) { run_filter(state, spec, Divergence::kPlain); }

void kernel_cross_bilateral_final(benchmark::State& state) { run_bank(state, CrossBilateralParams{}); }
BENCHMARK(kernel_cross_bilateral_final);

void kernel_cross_bilateral_intermediate(benchmark::State& state) { run_bank(state, intermediate_cross_bilateral()); }
BENCHMARK(kernel_cross_bilateral_intermediate);

void kernel_cross_bilateral_range_term(benchmark::State& state) {
  CrossBilateralParams params;
  params.range_sigma = 1.0F;
  run_bank(state, params);
}
BENCHMARK(kernel_cross_bilateral_range_term);

// All passes of a filter over a square frame, tile by tile.
template <class Params>
void run_passes(benchmark::State& state, const Params& params, int size = 512, int threads = 1) {
  constexpr int kWidth = 128;
  constexpr int kHeight = 32;
  const BenchFrame frame(size, size);
  const Source source(frame.frame(), inspect(frame.frame()));
  const GuideRows guides = make_guides(params, source, {size, size, size});
  FilterScratch guide_scratch;
  guides.prepare({0, 0, size, size}, guide_scratch);
  const auto filter = prepare(params, {source, guides, kWidth, kHeight, size, Divergence::kPlain});
  const exec::RowRing ring(filter->candidates() * CandidateRows::kPlanes, size, size);
  const int passes = static_cast<int>(halos(params).size());
  const int columns = size / kWidth;
  Execution execution;
  execution.threads = threads;
  exec::Runner runner(execution);
  std::vector<FilterScratch> scratch(static_cast<std::size_t>(runner.slots()));
  for (auto _ : state) {
    for (int pass = 0; pass < passes; ++pass) {
      runner.for_each(columns * size / kHeight, 0.0, [&](int tile, int slot) {
        const int x = tile % columns * kWidth;
        const int y = tile / columns * kHeight;
        filter->run(pass, {x, y, x + kWidth, y + kHeight}, scratch[static_cast<std::size_t>(slot)],
                    CandidateRows(ring));
      });
    }
  }
  const double pixels = static_cast<double>(size) * size;
  state.SetItemsProcessed(state.iterations() * size * size);
  if constexpr (std::is_same_v<Params, AdaptiveOrderParams>) {
    if (params.error == OrderError::kRisk) {
      state.counters["flops"] =
          benchmark::Counter(pixels * regression_flops(params), benchmark::Counter::kIsIterationInvariantRate);
    }
  }
  state.SetLabel(kernels::instruction_set());
}

void filter_atrous(benchmark::State& state) { run_passes(state, AtrousParams{}); }
BENCHMARK(filter_atrous);

void filter_atrous_sure(benchmark::State& state) { run_passes(state, AtrousSureParams{}); }
BENCHMARK(filter_atrous_sure);

// 1 Mpixel and two threads, as other denoisers are timed.
void filter_atrous_sure_mpixel(benchmark::State& state) { run_passes(state, AtrousSureParams{}, 1024, 2); }
BENCHMARK(filter_atrous_sure_mpixel)->UseRealTime()->Unit(benchmark::kMillisecond);

// 19x19 pixels, ten dimensions, orders 1 and 3 with the error of both.
void filter_adaptive_order_one_sigma(benchmark::State& state) {
  AdaptiveOrderParams params;
  params.orders = {1, 3};
  params.range_sigmas = {1.0F};
  run_passes(state, params);
}
BENCHMARK(filter_adaptive_order_one_sigma);

void filter_adaptive_order(benchmark::State& state) { run_passes(state, AdaptiveOrderParams{}); }
BENCHMARK(filter_adaptive_order);

void filter_adaptive_order_taylor(benchmark::State& state) {
  AdaptiveOrderParams params;
  params.error = OrderError::kTaylor;
  run_passes(state, params);
}
BENCHMARK(filter_adaptive_order_taylor);

void kernel_cross_bilateral_joint(benchmark::State& state) {
  run_filter(state, CrossBilateralParams{}, Divergence::kJoint);
}
BENCHMARK(kernel_cross_bilateral_joint);

void kernel_cross_nlm_final(benchmark::State& state) { run_bank(state, CrossNlmParams{}); }
BENCHMARK(kernel_cross_nlm_final);

void kernel_cross_nlm_intermediate(benchmark::State& state) { run_bank(state, intermediate_cross_nlm()); }
BENCHMARK(kernel_cross_nlm_intermediate);

void kernel_cross_nlm_absolute(benchmark::State& state) {
  CrossNlmParams params;
  params.distance = PatchDistance::kAbsolute;
  run_bank(state, params);
}
BENCHMARK(kernel_cross_nlm_absolute);

void kernel_cross_nlm_joint(benchmark::State& state) { run_filter(state, CrossNlmParams{}, Divergence::kJoint); }
BENCHMARK(kernel_cross_nlm_joint);

// All passes over a frame, with layers of three channels.
void filter_layers(benchmark::State& state, const char* name) {
  constexpr int kSize = 256;
  constexpr int kWidth = 128;
  constexpr int kHeight = 32;
  const bool is_joint = state.range(1) != 0;
  BenchFrame frame(kSize, kSize, is_joint);
  frame.add_layers(static_cast<int>(state.range(0)));
  const FrameReport report = inspect(frame.frame());
  const Source source(frame.frame(), report);
  const LayerSource layers(frame.frame(), report, source);
  const FilterSpec spec = make_filter(name);
  const GuideRows guides = make_guides(spec, source, {kSize, kSize, kSize});
  FilterScratch scratch;
  guides.prepare({0, 0, kSize, kSize}, scratch);
  const Divergence divergence = is_joint ? Divergence::kJoint : Divergence::kPlain;
  const auto filter = prepare(spec, {source, guides, kWidth, kHeight, kSize, divergence, &layers});
  const exec::RowRing ring(filter->candidates() * CandidateRows::kPlanes, kSize, kSize);
  const exec::RowRing layer_ring(filter->candidates() * layers.channels(), kSize, kSize);
  const CandidateRows out = CandidateRows(ring).with_layers(layer_ring, layers.channels());
  const int passes = static_cast<int>(halos(spec).size());
  for (auto _ : state) {
    for (int pass = 0; pass < passes; ++pass) {
      for (int y = 0; y < kSize; y += kHeight) {
        for (int x = 0; x < kSize; x += kWidth) filter->run(pass, {x, y, x + kWidth, y + kHeight}, scratch, out);
      }
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kSize * kSize);
  state.SetLabel(kernels::instruction_set());
}

void numbers_of_layers(benchmark::internal::Benchmark* bench) {
  for (const int is_joint : {0, 1}) {
    for (const int layers : {0, 1, 4}) bench->Args({layers, is_joint});
  }
  bench->ArgNames({"layers", "joint"})->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(filter_layers, cross_bilateral, "cross-bilateral")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(filter_layers, cross_nlm, "cross-nlm")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(filter_layers, gaussian, "gaussian")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(filter_layers, atrous, "atrous")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(filter_layers, atrous_sure, "atrous-sure")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(filter_layers, adaptive_order, "adaptive-order")->Apply(numbers_of_layers);

}  // namespace
}  // namespace stein::bench
