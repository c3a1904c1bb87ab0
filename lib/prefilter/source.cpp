// SPDX-License-Identifier: Apache-2.0
#include "prefilter/source.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace stein {
namespace {

constexpr int kChunk = 512;
// Variance of a feature that is to count nothing: large against any scaled distance, small enough not to overflow with
// it.
constexpr float kNoInformation = 1e10F;
// Scaled features are clipped to this: the square of their difference stays finite, and far below kNoInformation.
constexpr float kLargest = 1e4F;
constexpr float kMostSamples = 1e9F;

// Values at some 2^16 pixels spread evenly over the plane, finite ones only. The step has no factor in common with the
// width, so that all columns take part.
std::vector<float> sample_plane(const ConstPlaneView& plane) {
  const std::int64_t pixels = static_cast<std::int64_t>(plane.width()) * plane.height();
  std::int64_t step = pixels / 65536 + 1;
  while (std::gcd(step, static_cast<std::int64_t>(plane.width())) != 1) ++step;
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(pixels / step + 1));
  for (std::int64_t i = 0; i < pixels; i += step) {
    const float v = plane.at(static_cast<int>(i % plane.width()), static_cast<int>(i / plane.width()));
    if (std::isfinite(v)) values.push_back(v);
  }
  return values;
}

float quantile(std::vector<float>& values, double fraction) {
  if (values.empty()) return 0.0F;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace

float feature_range(const Feature& feature) {
  if (feature.name == "normal" || feature.name == "albedo" || feature.name == "visibility") return 1.0F;
  float range = 0.0F;
  for (const ConstPlaneView& plane : feature.mean) {
    std::vector<float> values = sample_plane(plane);
    const float high = quantile(values, 0.999);
    const float low = feature.name == "depth" ? 0.0F : quantile(values, 0.001);
    range = std::max(range, high - low);
  }
  return range > 0.0F && std::isfinite(range) ? range : 1.0F;
}

Source::Source(const Frame& frame, const FrameReport& report) : frame_(frame) {
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    feature_scales_.push_back(1.0F / feature_range(frame.features[f]));
    feature_has_bad_.push_back(report.bad_feature_pixels[f] > 0 ? 1 : 0);
  }
  if (report.invalid_pixels > 0) replace(fill_invalid(frame));
}

void Source::replace(const std::vector<ReplacedPixel>& pixels) {
  if (pixels.empty()) return;
  const auto before = [](const ReplacedPixel& a, const ReplacedPixel& b) {
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
  };
  std::vector<ReplacedPixel> merged(replaced_.size() + pixels.size());
  std::merge(replaced_.begin(), replaced_.end(), pixels.begin(), pixels.end(), merged.begin(), before);
  replaced_ = std::move(merged);
  first_in_row_.assign(static_cast<std::size_t>(frame_.height) + 1, 0);
  for (const ReplacedPixel& p : replaced_) ++first_in_row_[static_cast<std::size_t>(p.y) + 1];
  std::partial_sum(first_in_row_.begin(), first_in_row_.end(), first_in_row_.begin());
}

template <class Visit>
void Source::for_each_replaced(int y, int x, int count, Visit visit) const {
  if (replaced_.empty()) return;
  const auto row = static_cast<std::size_t>(y);
  for (std::size_t i = first_in_row_[row]; i < first_in_row_[row + 1]; ++i) {
    const ReplacedPixel& p = replaced_[i];
    if (p.x >= x && p.x < x + count) visit(p, p.x - x);
  }
}

void Source::colour_row(std::size_t channel, int y, int x, int count, float* out) const {
  frame_.colour[channel].read_row(y, x, count, out);
  for_each_replaced(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.colour[channel]; });
}

void Source::variance_row(std::size_t channel, int y, int x, int count, float* out) const {
  frame_.colour_variance[channel].read_row(y, x, count, out);
  for_each_replaced(y, x, count, [&](const ReplacedPixel&, int i) { out[i] = 0.0F; });
}

void Source::input_row(std::size_t channel, int y, int x, int count, float* mean, float* variance) const {
  frame_.colour[channel].read_row(y, x, count, mean);
  frame_.colour_variance[channel].read_row(y, x, count, variance);
  for_each_replaced(y, x, count, [&](const ReplacedPixel& p, int i) {
    if (p.is_source) return;
    mean[i] = p.colour[channel];
    variance[i] = 0.0F;
  });
}

void Source::mask_row(int y, int x, int count, float* out) const {
  std::fill_n(out, count, 1.0F);
  for_each_replaced(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.is_source ? 1.0F : 0.0F; });
}

void Source::feature_row(std::size_t feature, float factor, int y, int x, int count, float* const* means,
                         float* variance) const {
  const Feature& source = frame_.features[feature];
  const std::size_t channels = source.mean.size();
  const float scale = feature_scales_[feature];
  for (std::size_t k = 0; k < channels; ++k) {
    source.mean[k].read_row(y, x, count, means[k]);
    for (int i = 0; i < count; ++i) means[k][i] = std::clamp(means[k][i] * (scale * factor), -kLargest, kLargest);
  }
  std::fill_n(variance, count, 0.0F);
  float n[kChunk];
  float v[kChunk];
  const float variance_scale = scale * scale / static_cast<float>(channels);
  for (int start = 0; start < count && !source.variance.empty(); start += kChunk) {
    const int part = std::min(kChunk, count - start);
    sample_count_row(frame_, y, x + start, part, n);
    for (int i = 0; i < part; ++i) n[i] = n[i] > 0.0F ? std::min(n[i], kMostSamples) : 0.0F;  // 0 where it is no number
    for (const ConstPlaneView& plane : source.variance) {
      plane.read_row(y, x + start, part, v);
      // Eq. 6 of SBF speaks of the samples' variance, the frame holds that of the mean.
      for (int i = 0; i < part; ++i) variance[start + i] += std::min(v[i] * n[i] * variance_scale, kNoInformation);
    }
  }
  if (feature_has_bad_[feature] == 0) return;
  for (int start = 0; start < count; start += kChunk) {
    const int part = std::min(kChunk, count - start);
    feature_validity_row(source, y, x + start, part, v);
    for (int i = 0; i < part; ++i) {
      if (v[i] != 0.0F) continue;
      for (std::size_t k = 0; k < channels; ++k) means[k][start + i] = 0.0F;
      variance[start + i] = kNoInformation;
    }
  }
}

}  // namespace stein
