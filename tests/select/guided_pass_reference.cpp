// SPDX-License-Identifier: Apache-2.0
#include "select/guided_pass_reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace stein::test {
namespace {

double feature_sigma(const FeatureGuides& guides, const std::string& name) {
  for (const FeatureSigma& entry : guides.feature_sigmas) {
    if (entry.name == name) return entry.sigma;
  }
  return guides.other_feature_sigma;
}

struct GuidePixel {
  float means[4] = {};
  float variance = 0;
};

// exp(-sum of D^2 / (2 sigma^2)) between two pixels, from what the source says of them.
double feature_weight(const Setting& setting, double sigma_scale, int xi, int yi, int xj, int yj) {
  double exponent = 0;
  const std::vector<Feature>& features = setting.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    const double sigma = sigma_scale * feature_sigma(setting.params.guides, features[f].name);
    if (sigma == 0) continue;
    GuidePixel i;
    GuidePixel j;
    for (auto* p : {&i, &j}) {
      float* means[] = {&p->means[0], &p->means[1], &p->means[2], &p->means[3]};
      setting.source.feature_row(f, 1.0F, p == &i ? yi : yj, p == &i ? xi : xj, 1, means, &p->variance);
    }
    double squared = 0;
    for (std::size_t k = 0; k < features[f].mean.size(); ++k) {
      squared += std::pow(static_cast<double>(i.means[k]) - j.means[k], 2);
    }
    const double variance = static_cast<double>(i.variance) + j.variance;
    exponent += squared / std::max<double>(variance, setting.params.guides.min_feature_variance) / (2 * sigma * sigma);
  }
  return exponent < 59.5 * std::numbers::ln2 ? std::exp(-exponent) : 0.0;  // the kernels count less as nothing
}

}  // namespace

std::array<double, kMaps> guided_pass_reference(const GuidedPass& pass, const Setting& setting, const Maps& in, int x,
                                                int y) {
  const double box[] = {1, 1, 1, 1, 1};
  const double spline[] = {1, 4, 6, 4, 1};
  const double* taps = pass.kernel == PassKernel::kBox ? box : spline;
  double total = 0;
  std::array<double, kMaps> sum{};
  for (int i = 0; i < 25; ++i) {
    const int px = x + (i % 5 - 2) * pass.step;
    const int py = y + (i / 5 - 2) * pass.step;
    if (px < 0 || py < 0 || px >= setting.frame().width || py >= setting.frame().height) continue;
    float mask = 0;
    colour_validity_row(setting.frame(), py, px, 1, &mask);
    if (mask == 0) continue;
    const double w = taps[i % 5] * taps[i / 5] * feature_weight(setting, pass.sigma_scale, x, y, px, py);
    total += w;
    for (int m = 0; m < kMaps; ++m) sum[static_cast<std::size_t>(m)] += w * in.ring.row(m, py)[px];
  }
  for (int m = 0; m < kMaps; ++m) {
    double& mean = sum[static_cast<std::size_t>(m)];
    mean = total > 0 ? mean / total : in.ring.row(m, y)[x];
  }
  return sum;
}

}  // namespace stein::test
