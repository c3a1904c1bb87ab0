// SPDX-License-Identifier: Apache-2.0
//
// The header alone: no library, and compiler options under which std::isfinite is always true.
#include <bit>
#include <cstdint>
#include <cstdio>

#include "stein/accumulate.hpp"

namespace {

float value(const stein::ConstPlaneView& plane) { return *static_cast<const float*>(plane.data()); }

bool is(const char* what, float found, float expected) {
  if (found == expected) return true;
  std::printf("%s is %g instead of %g\n", what, static_cast<double>(found), static_cast<double>(expected));
  return false;
}

}  // namespace

int main(int count, char** /*arguments*/) {
  const auto not_finite =
      std::bit_cast<float>(static_cast<std::uint32_t>(count) + 0x7F800000U);  // not known beforehand
  stein::Accumulator film(1, 1, {.features = {{"depth", 1}}});
  for (const float first : {1.0F, 3.0F}) {
    const float sample[] = {first, 2, 4, 2 * first};
    film.add(0, 0, sample);
  }
  const float bad[] = {1, not_finite, 2, 3};
  film.add(0, 0, bad);
  stein::Accumulator other(1, 1, film.layout());
  const float without_depth[] = {2, 2, 4, not_finite};
  other.add(0, 0, without_depth);
  film.merge(other);

  const stein::Moments moments = film.moments();
  const stein::Feature& depth = moments.frame().features[0];
  bool good = is("rejected", static_cast<float>(film.rejected()), 1);
  good &= is("repaired", static_cast<float>(film.repaired()), 1);
  good &= is("n", value(moments.frame().sample_count), 3);
  good &= is("R", value(moments.frame().colour[0]), 2);
  good &= is("variance.R", value(moments.frame().colour_variance[0]), 2.0F / 6.0F);
  good &= is("depth.Z", value(depth.mean[0]), 8.0F / 3.0F);
  good &= is("covariance.R.depth.Z", value(depth.colour_covariance[0]), 4.0F / 6.0F);
  return good ? 0 : 1;
}
