// SPDX-License-Identifier: Apache-2.0
//
// The whole of stein::denoise on frames in memory. items = pixels.
#include <benchmark/benchmark.h>

#include <cmath>
#include <thread>

#include "stein/denoise.hpp"
#include "synthetic_frame.hpp"

namespace stein::bench {
namespace {

void pipeline_denoise(benchmark::State& state) {
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(state.range(0)) * 1e3)));
  const BenchFrame frame(side, side);
  DenoiseParams params;
  params.execution.threads = static_cast<int>(state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(denoise(frame.frame(), params));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * side * side);
}

void sizes_and_threads(benchmark::internal::Benchmark* bench) {
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  for (const int kilopixels : {250, 1000, 4000}) {
    for (int threads = 1; threads <= cores; threads *= 2) bench->Args({kilopixels, threads});
  }
}
BENCHMARK(pipeline_denoise)
    ->Apply(sizes_and_threads)
    ->ArgNames({"kilopixels", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// One bank on 1 Mpixel with two threads: joint SURE, or the plain one.
void pipeline_filter(benchmark::State& state, const FilterSpec& filter, Risk risk) {
  constexpr int kSide = 1024;
  const BenchFrame frame(kSide, kSide, true);
  DenoiseParams params;
  params.filters = {filter};
  params.risk = risk;
  params.execution.threads = 2;
  for (auto _ : state) benchmark::DoNotOptimize(denoise(frame.frame(), params));
  state.SetItemsProcessed(state.iterations() * kSide * kSide);
}

CrossNlmParams nine_range_sigmas() {
  CrossNlmParams params;
  params.range_sigmas = {0.5F, 0.70710678F, 1.0F, 1.41421356F, 2.0F, 2.82842712F, 4.0F, 5.65685425F, 8.0F};
  return params;
}

void in_real_time(benchmark::internal::Benchmark* bench) { bench->UseRealTime()->Unit(benchmark::kMillisecond); }
BENCHMARK_CAPTURE(pipeline_filter, cross_bilateral, CrossBilateralParams{}, Risk::kJoint)->Apply(in_real_time);
BENCHMARK_CAPTURE(pipeline_filter, cross_bilateral_plain, CrossBilateralParams{}, Risk::kPlain)->Apply(in_real_time);
BENCHMARK_CAPTURE(pipeline_filter, cross_nlm_9, nine_range_sigmas(), Risk::kJoint)->Apply(in_real_time);
BENCHMARK_CAPTURE(pipeline_filter, cross_nlm_9_plain, nine_range_sigmas(), Risk::kPlain)->Apply(in_real_time);
BENCHMARK_CAPTURE(pipeline_filter, atrous_sure, AtrousSureParams{}, Risk::kAuto)->Apply(in_real_time);

// A filter with layers of three channels, and the covariances of a renderer that has them.
void pipeline_layers(benchmark::State& state, const char* filter) {
  constexpr int kSide = 512;
  BenchFrame frame(kSide, kSide, true);
  frame.add_layers(static_cast<int>(state.range(0)));
  DenoiseParams params;
  params.filters = make_filters(filter);
  params.execution.threads = 1;
  for (auto _ : state) benchmark::DoNotOptimize(denoise(frame.frame(), params));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kSide * kSide);
}

void numbers_of_layers(benchmark::internal::Benchmark* bench) {
  bench->Arg(0)->Arg(1)->Arg(4)->ArgName("layers")->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(pipeline_layers, cross_bilateral, "cross-bilateral")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(pipeline_layers, cross_nlm, "cross-nlm")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(pipeline_layers, gaussian, "gaussian")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(pipeline_layers, atrous, "atrous")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(pipeline_layers, atrous_sure, "atrous-sure")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(pipeline_layers, adaptive_order, "adaptive-order")->Apply(numbers_of_layers);
BENCHMARK_CAPTURE(pipeline_layers, by_default, "auto")->Apply(numbers_of_layers);

}  // namespace
}  // namespace stein::bench
