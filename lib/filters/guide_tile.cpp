// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "filters/guide_tile.hpp"

#include <cmath>
#include <numbers>

#include "stein/error.hpp"

namespace stein {
namespace {

float feature_sigma(const CrossBilateralParams& params, const std::string& name) {
  for (const FeatureSigma& entry : params.feature_sigmas) {
    if (entry.name == name) return entry.sigma;
  }
  return params.other_feature_sigma;
}

}  // namespace

GuideSet::GuideSet(const Source& source, const CrossBilateralParams& params, bool with_range_term)
    : source_(source), min_variance_(params.min_feature_variance) {
  const std::vector<Feature>& features = source.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    const float sigma = feature_sigma(params, features[f].name);
    if (sigma > 0) add(static_cast<int>(f), static_cast<int>(features[f].mean.size()), sigma);
  }
  if (with_range_term && params.range_sigma > 0) add(-1, 3, params.range_sigma);
}

void GuideSet::add(int feature, int channels, float sigma) {
  if (channels_ + channels > kernels::kMaxGuideChannels || groups_.size() == kernels::kMaxGuideGroups) {
    throw Error(ErrorCode::kInvalidArgument, "the frame has more guiding features than the filter takes (" +
                                                 std::to_string(kernels::kMaxGuideGroups) + " features, " +
                                                 std::to_string(kernels::kMaxGuideChannels) +
                                                 " channels); give those that matter less the sigma 0");
  }
  const double log2_e = std::numbers::log2e;
  groups_.push_back({feature, channels, static_cast<float>(std::sqrt(log2_e / 2.0) / sigma)});
  channels_ += channels;
}

void GuideSet::load(const Rect& tile, exec::TilePlanes& planes) const {
  const Frame& frame = source_.frame();
  load_tile(tile, frame.width, frame.height, planes, mask_plane(), 1,
            [&](int y, int x, int n, float* const* rows) { source_.mask_row(y, x, n, rows[0]); });
  int channel = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    const int variance_plane = channels_ + static_cast<int>(g);
    load_tile(tile, frame.width, frame.height, planes, variance_plane, 1,
              [](int, int, int, float* const*) {});  // clears
    load_tile(
        tile, frame.width, frame.height, planes, channel, group.channels, [&](int y, int x, int n, float* const* rows) {
          float* variance = planes.row(variance_plane, y - tile.y0) + (x - tile.x0);
          if (group.feature >= 0) {
            source_.feature_row(static_cast<std::size_t>(group.feature), group.factor, y, x, n, rows, variance);
            return;
          }
          for (std::size_t c = 0; c < 3; ++c) {
            source_.colour_row(c, y, x, n, rows[c]);
            for (int i = 0; i < n; ++i) rows[c][i] *= group.factor;
          }
          std::fill_n(variance, n, 0.5F);  // the range term of Eq. 4 is not normalised: the two variances sum to 1
        });
    channel += group.channels;
  }
}

kernels::Guides GuideSet::row(const exec::TilePlanes& planes, int y) const {
  kernels::Guides guides;
  int channel = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (int k = 0; k < groups_[g].channels; ++k, ++channel) guides.channel[channel] = planes.row(channel, y);
    guides.group_end[g] = channel;
    guides.variance[g] = planes.row(channels_ + static_cast<int>(g), y);
  }
  guides.groups = static_cast<int>(groups_.size());
  guides.min_variance = min_variance_;
  guides.mask = planes.row(mask_plane(), y);
  return guides;
}

}  // namespace stein
