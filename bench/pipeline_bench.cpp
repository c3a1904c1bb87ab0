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

}  // namespace
}  // namespace stein::bench
