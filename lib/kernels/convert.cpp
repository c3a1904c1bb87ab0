// SPDX-License-Identifier: Apache-2.0
#include "kernels/convert.hpp"

#include <cstring>

#include "kernels/guides.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/convert.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stein::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void HalfToFloatRowTarget(const std::byte* half, int count, float* out) {
  const hn::CappedTag<float, kMaxLanes> d;
  const hn::Rebind<hwy::float16_t, decltype(d)> dh;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN hwy::float16_t in[kMaxLanes] = {};
  HWY_ALIGN float converted[kMaxLanes];
  for (int i = 0; i < count; i += lanes) {
    const int n = HWY_MIN(lanes, count - i);
    std::memcpy(in, half + 2 * static_cast<std::ptrdiff_t>(i), 2 * static_cast<std::size_t>(n));
    if (n == lanes) {
      hn::StoreU(hn::PromoteTo(d, hn::Load(dh, in)), d, out + i);
    } else {
      hn::Store(hn::PromoteTo(d, hn::Load(dh, in)), d, converted);
      std::memcpy(out + i, converted, sizeof(float) * static_cast<std::size_t>(n));
    }
  }
}

}  // namespace stein::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stein::kernels {

HWY_EXPORT(HalfToFloatRowTarget);

void half_to_float_row(const std::byte* half, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(HalfToFloatRowTarget)(half, count, out);
}

}  // namespace stein::kernels
#endif  // HWY_ONCE
