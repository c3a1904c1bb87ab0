// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "filters/guide_rows.hpp"

#include <cmath>
#include <numbers>

#include "stein/error.hpp"

namespace stein {
namespace {

// The narrowest patches: wider ones take the rims of small things for what is around them.
NlmWindow smoothing_window(const FeatureGuides& guides) { return {guides.smoothing_radius, 1}; }

}  // namespace

int GuideRows::halo(const FeatureGuides& guides) {
  return guides.smoothing_radius > 0 ? FeatureSmoother::halo(smoothing_window(guides)) : 0;
}

GuideRows::GuideRows(const Source& source, const FeatureGuides& guides, float range_sigma, const GuideWindow& window)
    : source_(source), min_variance_(guides.min_feature_variance) {
  const std::vector<Feature>& features = source.frame().features;
  for (std::size_t f = 0; f < features.size(); ++f) {
    const float sigma = guides.sigma_of(features[f].name);
    if (sigma > 0) add(static_cast<int>(f), static_cast<int>(features[f].mean.size()), sigma);
  }
  feature_groups_ = groups_.size();
  if (range_sigma > 0) add(-1, 3, range_sigma);
  if (guides.smoothing_radius > 0)
    smoother_.emplace(source, smoothing_window(guides), window.tile_width, window.tile_height);
  ring_ = exec::RowRing(planes(), source.frame().width, window.rows, source.memory());
}

void GuideRows::add(int feature, int channels, float sigma) {
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

void GuideRows::prepare(const Rect& tile, exec::TileScratch& scratch) const {
  for (int y = tile.y0; y < tile.y1; ++y)
    source_.mask_row(y, tile.x0, tile.width(), ring_.row(mask_plane(), y) + tile.x0);
  int channel = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (g < feature_groups_) {
      prepare_feature(static_cast<int>(g), channel, tile, scratch);
    } else {
      prepare_colour(groups_[g], channel, tile);
    }
    channel += groups_[g].channels;
  }
}

// The variance stays that of the feature as it is: what smoothing has left of its noise must not stop a filter either.
void GuideRows::prepare_feature(int g, int first_channel, const Rect& tile, exec::TileScratch& scratch) const {
  const Group& group = groups_[static_cast<std::size_t>(g)];
  const auto feature = static_cast<std::size_t>(group.feature);
  const int n = tile.width();
  const auto row = [&](int plane, int y) { return ring_.row(plane, y) + tile.x0; };
  if (smoother_) smoother_->run(feature, tile, scratch, ring_, first_channel);
  for (int y = tile.y0; y < tile.y1; ++y) {
    float* means[4];
    for (int k = 0; k < group.channels; ++k) means[k] = row(first_channel + k, y);
    if (!smoother_) {
      source_.feature_row(feature, group.factor, y, tile.x0, n, means, row(channels_ + g, y));
      continue;
    }
    source_.feature_sample_variance_row(feature, y, tile.x0, n, row(channels_ + g, y));
    for (int k = 0; k < group.channels; ++k) {
      for (int i = 0; i < n; ++i)
        means[k][i] = std::clamp(means[k][i] * group.factor, -Source::kLargestMean, Source::kLargestMean);
    }
  }
}

void GuideRows::prepare_colour(const Group& group, int first_channel, const Rect& tile) const {
  const int n = tile.width();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int c = 0; c < 3; ++c) {
      float* mean = ring_.row(first_channel + c, y) + tile.x0;
      source_.colour_row(static_cast<std::size_t>(c), y, tile.x0, n, mean);
      for (int i = 0; i < n; ++i) mean[i] *= group.factor;
    }
    // The range term of Eq. 4 is not normalised: the two variances sum to 1.
    std::fill_n(ring_.row(mask_plane() - 1, y) + tile.x0, n, 0.5F);
  }
}

void GuideRows::load(const Rect& tile, exec::TilePlanes& planes) const {
  const Frame& frame = source_.frame();
  load_tile(tile, frame.width, frame.height, planes, 0, this->planes(), [&](int y, int x, int n, float* const* rows) {
    for (int p = 0; p < this->planes(); ++p) std::copy_n(ring_.row(p, y) + x, n, rows[p]);
  });
}

double GuideRows::variance_of_mean(int g, double variance, double samples) const noexcept {
  const Group& group = groups_[static_cast<std::size_t>(g)];
  if (group.feature < 0 || !(samples > 0.0)) return 0.0;
  return variance * group.channels * group.factor * group.factor / samples;
}

bool GuideRows::has_covariance(Divergence divergence) const noexcept {
  return std::any_of(groups_.begin(), groups_.end(), [&](const Group& group) {
    if (group.feature < 0) return true;
    const Feature& feature = source_.frame().features[static_cast<std::size_t>(group.feature)];
    return divergence == Divergence::kJoint && !feature.colour_covariance.empty();
  });
}

void GuideRows::covariance_rows(Divergence divergence, float factor, int y, int x, int count,
                                float* const* rows) const {
  for (std::size_t c = 0; c < 3; ++c) {
    std::size_t row = c * static_cast<std::size_t>(channels_);
    for (const Group& group : groups_) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(group.channels); ++k, ++row) {
        if (group.feature < 0 && (k == c || divergence == Divergence::kJoint)) {
          source_.colour_covariance_row(c, k, y, x, count, rows[row]);
          for (int i = 0; i < count; ++i) rows[row][i] *= factor * group.factor;
        } else if (group.feature >= 0 && divergence == Divergence::kJoint) {
          const auto feature = static_cast<std::size_t>(group.feature);
          source_.feature_covariance_row(c, feature, k, factor * group.factor, y, x, count, rows[row]);
        } else {
          std::fill_n(rows[row], count, 0.0F);
        }
      }
    }
  }
}

template <class Row>
kernels::Guides GuideRows::arguments(std::size_t groups, Row row) const {
  kernels::Guides guides;
  int channel = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    for (int k = 0; k < groups_[g].channels; ++k, ++channel) guides.channel[channel] = row(channel);
    guides.group_end[g] = channel;
    guides.variance[g] = row(channels_ + static_cast<int>(g));
  }
  guides.groups = static_cast<int>(groups);
  guides.min_variance = min_variance_;
  guides.mask = row(mask_plane());
  return guides;
}

kernels::Guides GuideRows::tile_row(const exec::TilePlanes& planes, int y) const {
  return arguments(groups_.size(), [&](int plane) { return planes.row(plane, y); });
}

kernels::Guides GuideRows::feature_row(int x, int y) const {
  return arguments(feature_groups_, [&](int plane) { return ring_.row(plane, y) + x; });
}

}  // namespace stein
