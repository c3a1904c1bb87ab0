// SPDX-License-Identifier: Apache-2.0
//
// Variances of the mean of R, G and B, from what renderers write instead.
#pragma once

#include <vector>

#include "exr/colour_space.hpp"
#include "exr/schema.hpp"
#include "stein/frame.hpp"

namespace stein::exr {

/// Whether planes of this kind need the number of samples to become variances of the mean.
[[nodiscard]] inline bool needs_samples(VarianceOf variance_of) {
  return variance_of == VarianceOf::kSample || variance_of == VarianceOf::kSecondMoment;
}

/// Replaces the colour's variances where they are not of the mean of R, G, B. The new planes, from `memory` where
/// there is one, go to `planes_made`.
void convert_colour_variance(Frame& frame, const Schema& schema, VarianceOf variance_of, const ColourSpace& space,
                             Memory* memory, std::vector<Plane>& planes_made);

void convert_feature_variance(const Frame& frame, Feature& feature, VarianceOf variance_of, Memory* memory,
                              std::vector<Plane>& planes_made);

}  // namespace stein::exr
