// SPDX-License-Identifier: Apache-2.0
//
// Weighted sums of layers for the candidates of a bank, batch by batch of neighbours. Compiled once per instruction
// set.
#if defined(STEIN_KERNELS_LAYER_SUMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef STEIN_KERNELS_LAYER_SUMS_INL
#undef STEIN_KERNELS_LAYER_SUMS_INL
#else
#define STEIN_KERNELS_LAYER_SUMS_INL
#endif

#include <hwy/highway.h>

#include "kernels/guides.hpp"
#include "kernels/weights-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {

// Of one vector of pixels.
struct LayerSums {
  const LayerChannels* layers = nullptr;
  float* HWY_RESTRICT batch = nullptr;  // [channel][tap]: one copy for all candidates
  float* HWY_RESTRICT sums = nullptr;   // [candidate][channel]

  static std::ptrdiff_t lanes() { return static_cast<std::ptrdiff_t>(hn::Lanes(FloatTag())); }

  // Takes in the neighbours at[t]; with kDifferences less the value of the pixel x itself.
  template <bool kDifferences>
  HWY_INLINE void load(FloatTag d, std::ptrdiff_t x, const std::ptrdiff_t (&at)[kTapBatch]) const {
    for (int k = 0; k < layers->count; ++k) {
      const float* HWY_RESTRICT value = layers->value[k];
      const FloatVec own = kDifferences ? hn::LoadU(d, value + x) : hn::Zero(d);
      for (int t = 0; t < kTapBatch; ++t) {
        const FloatVec v = hn::LoadU(d, value + at[t]);
        hn::Store(kDifferences ? hn::Sub(v, own) : v, d, batch + (k * kTapBatch + t) * lanes());
      }
    }
  }

  HWY_INLINE void add(FloatTag d, int candidate, const FloatVec (&w)[kTapBatch]) const {
    for (int k = 0; k < layers->count; ++k) {
      const float* HWY_RESTRICT values = batch + k * kTapBatch * lanes();
      FloatVec total = hn::Mul(w[0], hn::Load(d, values));
      for (int t = 1; t < kTapBatch; ++t) total = hn::MulAdd(w[t], hn::Load(d, values + t * lanes()), total);
      hn::Store(hn::Add(hn::Load(d, sum(candidate, k)), total), d, sum(candidate, k));
    }
  }

  [[nodiscard]] float* sum(int candidate, int channel) const {
    return sums + (candidate * layers->count + channel) * lanes();
  }
};

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
