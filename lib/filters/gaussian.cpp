// SPDX-License-Identifier: Apache-2.0
//
// Isotropic Gaussian bank (SBF sec. 5.4): the cross-bilateral bank without any guide, and hence without guides for the
// smoothing of its risk.
#include "filters/filter.hpp"

namespace stein {
namespace {

CrossBilateralParams without_guides(const GaussianParams& params) {
  CrossBilateralParams same;
  same.spatial_sigmas = params.spatial_sigmas;
  same.guides.feature_sigmas.clear();
  same.guides.other_feature_sigma = 0.0F;
  return same;
}

}  // namespace

std::vector<int> halos(const GaussianParams& params) { return halos(without_guides(params)); }

GuideRows make_guides(const GaussianParams& params, const Source& source, const GuideWindow& window) {
  return make_guides(without_guides(params), source, window);
}

std::unique_ptr<PreparedFilter> prepare(const GaussianParams& params, const FilterContext& context) {
  return prepare(without_guides(params), context);
}

}  // namespace stein
