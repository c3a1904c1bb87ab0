// SPDX-License-Identifier: Apache-2.0
#include "machine.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "machine.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stein::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kRounds = 4096;
constexpr int kChains = 12;  // enough to hide the latency of two units, few enough for 16 registers

float FmaBurstTarget() {
  const hn::ScalableTag<float> d;
  const auto b = hn::Set(d, 0.999999F);
  const auto c = hn::Set(d, 1e-7F);
  auto a0 = hn::Iota(d, 0.0F), a1 = hn::Iota(d, 1.0F), a2 = hn::Iota(d, 2.0F), a3 = hn::Iota(d, 3.0F);
  auto a4 = hn::Iota(d, 4.0F), a5 = hn::Iota(d, 5.0F), a6 = hn::Iota(d, 6.0F), a7 = hn::Iota(d, 7.0F);
  auto a8 = hn::Iota(d, 8.0F), a9 = hn::Iota(d, 9.0F), a10 = hn::Iota(d, 10.0F), a11 = hn::Iota(d, 11.0F);
  for (int i = 0; i < kRounds; ++i) {
    a0 = hn::MulAdd(a0, b, c);
    a1 = hn::MulAdd(a1, b, c);
    a2 = hn::MulAdd(a2, b, c);
    a3 = hn::MulAdd(a3, b, c);
    a4 = hn::MulAdd(a4, b, c);
    a5 = hn::MulAdd(a5, b, c);
    a6 = hn::MulAdd(a6, b, c);
    a7 = hn::MulAdd(a7, b, c);
    a8 = hn::MulAdd(a8, b, c);
    a9 = hn::MulAdd(a9, b, c);
    a10 = hn::MulAdd(a10, b, c);
    a11 = hn::MulAdd(a11, b, c);
  }
  const auto sum = hn::Add(hn::Add(hn::Add(a0, a1), hn::Add(a2, a3)), hn::Add(hn::Add(a4, a5), hn::Add(a6, a7)));
  return hn::GetLane(hn::SumOfLanes(d, hn::Add(sum, hn::Add(hn::Add(a8, a9), hn::Add(a10, a11)))));
}

double FmaBurstFlopsTarget() {
  const hn::ScalableTag<float> d;
  return 2.0 * kRounds * kChains * static_cast<double>(hn::Lanes(d));
}

void TriadTarget(float* a, const float* b, const float* c, float s, std::size_t n) {
  const hn::ScalableTag<float> d;
  const auto factor = hn::Set(d, s);
  for (std::size_t i = 0; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    hn::StoreU(hn::MulAdd(factor, hn::LoadU(d, c + i), hn::LoadU(d, b + i)), d, a + i);
  }
}

}  // namespace stein::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::bench {

HWY_EXPORT(FmaBurstTarget);
HWY_EXPORT(FmaBurstFlopsTarget);
HWY_EXPORT(TriadTarget);

double fma_burst_flops() { return HWY_DYNAMIC_DISPATCH(FmaBurstFlopsTarget)(); }
float fma_burst() { return HWY_DYNAMIC_DISPATCH(FmaBurstTarget)(); }
void triad(float* a, const float* b, const float* c, float s, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(TriadTarget)(a, b, c, s, n);
}

}  // namespace stein::bench
#endif  // HWY_ONCE
