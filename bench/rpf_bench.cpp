// SPDX-License-Identifier: Apache-2.0
//
// Random parameter filtering of samples in memory: two materials under noisy light, 8 samples per pixel. items =
// pixels.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "stein/rpf.hpp"

namespace stein::bench {
namespace {

using Kind = SampleGroup::Kind;

class Noise {
 public:
  float operator()() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<float>(state_ >> 40U) * 0x1p-24F;
  }

 private:
  std::uint64_t state_ = 1;
};

/// One row, which all rows are.
std::vector<float> make_row(int width, int samples) {
  Noise noise;
  std::vector<float> row;
  for (int x = 0; x < width; ++x) {
    for (int i = 0; i < samples; ++i) {
      const float albedo = x % 64 < 32 ? 0.2F : 0.7F;
      const float light = noise();
      row.insert(row.end(), {albedo * light, albedo * light, albedo * light});           // colour
      row.insert(row.end(), {albedo, albedo, albedo, 0.1F * noise(), 0.0F, 1.0F});       // albedo, normal
      row.insert(row.end(), {static_cast<float>(x) + noise(), noise(), noise(), 3.0F});  // position, depth
      row.insert(row.end(), {light, noise(), noise(), noise(), noise(), noise()});       // light, lens, pixel
    }
  }
  return row;
}

void rpf(benchmark::State& state) {
  constexpr int kSide = 160;
  constexpr int kSamples = 8;
  const std::vector<float> row = make_row(kSide, kSamples);
  SampleSource source{kSide,
                      kSide,
                      {{Kind::kFeature, "albedo", 3},
                       {Kind::kFeature, "normal", 3},
                       {Kind::kFeature, "position", 3},
                       {Kind::kFeature, "depth", 1},
                       {Kind::kRandom, "random.light", 2},
                       {Kind::kRandom, "random.lens", 2},
                       {Kind::kRandom, "random.pixel", 2}},
                      [&row](std::vector<std::uint32_t>& counts, std::vector<float>& samples) {
                        counts.assign(kSide, kSamples);
                        samples = row;
                      }};
  Execution execution;
  execution.threads = static_cast<int>(state.range(0));
  RpfParams params;
  params.draws = static_cast<int>(state.range(1));
  for (auto _ : state) {
    filter_samples(source, params, execution,
                   [](const RpfBand& band) { benchmark::DoNotOptimize(band.colour[0].data()); });
  }
  state.SetItemsProcessed(state.iterations() * kSide * kSide);
}
BENCHMARK(rpf)
    ->ArgNames({"threads", "draws"})
    ->Args({1, 0})
    ->Args({2, 0})
    ->Args({2, 1})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stein::bench
