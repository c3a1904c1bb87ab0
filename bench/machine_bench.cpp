// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <vector>

#include "machine.hpp"

namespace stein::bench {
namespace {

void machine_peak_fma(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(fma_burst());
  // The library adds the counters of all threads and multiplies the sum by the iterations of all threads.
  state.counters["flops"] =
      benchmark::Counter(fma_burst_flops() / state.threads(), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(machine_peak_fma)->ThreadRange(1, 2)->UseRealTime();

void machine_bandwidth_triad(benchmark::State& state) {
  constexpr std::size_t kFloats = std::size_t{1} << 24;  // 3 x 64 MiB: larger than the caches a core has to itself
  std::vector<float> a(kFloats, 0.0F);
  const std::vector<float> b(kFloats, 1.0F);
  const std::vector<float> c(kFloats, 2.0F);
  for (auto _ : state) {
    triad(a.data(), b.data(), c.data(), 0.5F, kFloats);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * 3 *
                          static_cast<std::int64_t>(kFloats * sizeof(float)));
}
BENCHMARK(machine_bandwidth_triad)->ThreadRange(1, 2)->UseRealTime();

}  // namespace
}  // namespace stein::bench
