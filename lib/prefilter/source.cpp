// SPDX-License-Identifier: Apache-2.0
#include "prefilter/source.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/directions.hpp"
#include "prefilter/feature_fill.hpp"

namespace stein {
namespace {

constexpr int kChunk = FeatureHoles::kMostPixels;
// What the neighbours' mean weighs next to a feature's variance of few degrees of freedom, in degrees of freedom, and
// how far they are away; measured (docs/inputs.md).
constexpr float kNeighbourDegrees = 3.0F;
constexpr int kNeighbourRadius = 2;

// Values at some 2^16 pixels spread evenly over the plane, finite ones only. The step has no factor in common with the
// width, so that all columns take part.
std::vector<float> sample_plane(const ConstPlaneView& plane, const Memory* memory) {
  const std::int64_t pixels = static_cast<std::int64_t>(plane.width()) * plane.height();
  std::int64_t step = pixels / 65536 + 1;
  while (std::gcd(step, static_cast<std::int64_t>(plane.width())) != 1) ++step;
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(pixels / step + 1));
  for (std::int64_t i = 0; i < pixels; i += step) {
    const float v = plane.at(static_cast<int>(i % plane.width()), static_cast<int>(i / plane.width()));
    if (std::isfinite(v)) values.push_back(v);
    if (memory != nullptr && values.size() % 256 == 0) memory->trim();  // each look brings pages around it
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

float feature_range(const Feature& feature, const Memory* memory) {
  if (feature.name == "normal" || feature.name == "albedo" || feature.name == "visibility") return 1.0F;
  float range = 0.0F;
  for (const ConstPlaneView& plane : feature.mean) {
    std::vector<float> values = sample_plane(plane, memory);
    const float high = quantile(values, 0.999);
    const float low = feature.name == "depth" ? 0.0F : quantile(values, 0.001);
    range = std::max(range, high - low);
  }
  return range > 0.0F && std::isfinite(range) ? range : 1.0F;
}

Source::Source(const Frame& frame, const FrameReport& report, Memory* memory) : frame_(frame), memory_(memory) {
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    feature_scales_.push_back(1.0F / feature_range(frame.features[f], memory));
    feature_has_bad_.push_back(report.bad_feature_pixels[f] > 0 ? 1 : 0);
  }
  if (report.invalid_pixels > 0) replace(fill_invalid(frame, memory));
}

void Source::replace(const std::vector<ReplacedPixel>& pixels) { replaced_.add(pixels, frame_.height); }

Source Source::perturbed(const Perturbation& perturbation) const {
  Source moved = *this;
  moved.perturbation_ = perturbation;
  return moved;
}

void Source::variance_row(std::size_t channel, int y, int x, int count, float* out) const {
  frame_.colour_variance[channel].read_row(y, x, count, out);
  replaced_.for_each(y, x, count, [&](const ReplacedPixel&, int i) { out[i] = 0.0F; });
}

// Of the frame's colours, which are what was measured at outliers, too; 0 at invalid pixels.
void Source::input_variance_row(std::size_t channel, int y, int x, int count, float* out) const {
  frame_.colour_variance[channel].read_row(y, x, count, out);
  replaced_.for_each(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.is_source ? out[i] : 0.0F; });
}

// The same of two channels with the variances va, vb, at up to kChunk pixels.
void Source::input_covariance_row(std::size_t a, std::size_t b, int y, int x, int count, const float* va,
                                  const float* vb, float* out) const {
  const ConstPlaneView& plane = frame_.colour_covariance[a + b - 1];  // R.G, R.B, G.B
  if (!plane) {
    std::fill_n(out, count, 0.0F);
    return;
  }
  plane.read_row(y, x, count, out);
  kernels::bounded_covariance_row(out, va, vb, 1.0F, count, out);
}

void Source::scale_responses(int y, int x, int count, float* values) const {
  replaced_.for_each(y, x, count, [&](const ReplacedPixel& p, int i) { values[i] *= p.response; });
}

void Source::colour_covariance_row(std::size_t a, std::size_t b, int y, int x, int count, float* out) const {
  float va[kChunk];
  float vb[kChunk];
  for (int start = 0; start < count; start += kChunk) {
    const int part = std::min(kChunk, count - start);
    input_variance_row(a, y, x + start, part, a == b ? out + start : va);
    if (a == b) continue;
    input_variance_row(b, y, x + start, part, vb);
    input_covariance_row(a, b, y, x + start, part, va, vb, out + start);
  }
  scale_responses(y, x, count, out);
}

void Source::feature_covariance_row(std::size_t channel, std::size_t feature, std::size_t k, float factor, int y, int x,
                                    int count, float* out) const {
  const Feature& source = frame_.features[feature];
  std::fill_n(out, count, 0.0F);
  if (source.colour_covariance.empty() || source.variance.empty()) return;
  const ConstPlaneView& plane = source.colour_covariance[channel * source.mean.size() + k];
  float va[kChunk];
  float vb[kChunk];
  for (int start = 0; start < count; start += kChunk) {
    const int part = std::min(kChunk, count - start);
    input_variance_row(channel, y, x + start, part, va);
    source.variance[k].read_row(y, x + start, part, vb);
    plane.read_row(y, x + start, part, out + start);
    kernels::bounded_covariance_row(out + start, va, vb, feature_scales_[feature] * factor, part, out + start);
    clear_unusable_row(feature, y, x + start, part, out + start);
  }
}

void Source::clear_unusable_row(std::size_t feature, int y, int x, int count, float* values) const {
  if (feature_has_bad_[feature] == 0) return;
  float usable[kChunk];
  feature_validity_row(frame_.features[feature], y, x, count, usable);
  for (int i = 0; i < count; ++i) values[i] = usable[i] != 0.0F ? values[i] : 0.0F;
}

void Source::input_row(std::size_t channel, int y, int x, int count, float* mean, float* variance) const {
  frame_.colour[channel].read_row(y, x, count, mean);
  replaced_.for_each(y, x, count, [&](const ReplacedPixel& p, int i) {
    if (!p.is_source) mean[i] = p.colour[channel];
  });
  input_variance_row(channel, y, x, count, variance);
}

void Source::mask_row(int y, int x, int count, float* out) const {
  std::fill_n(out, count, 1.0F);
  replaced_.for_each(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.is_source ? 1.0F : 0.0F; });
}

// Per-sample variance of the group as the frame has it, in normalised units.
void Source::group_variance_row(std::size_t feature, int y, int x, int count, float* out) const {
  const Feature& source = frame_.features[feature];
  const float scale = feature_scales_[feature];
  const float variance_scale = scale * scale / static_cast<float>(source.mean.size());
  float n[kChunk];
  float v[kChunk];
  std::fill_n(out, count, 0.0F);
  for (int start = 0; start < count && !source.variance.empty(); start += kChunk) {
    const int part = std::min(kChunk, count - start);
    sample_count_row(frame_, y, x + start, part, n);
    for (int i = 0; i < part; ++i) n[i] = n[i] > 0.0F ? std::min(n[i], kMostSamples) : 0.0F;  // 0 where it is no number
    for (const ConstPlaneView& plane : source.variance) {
      plane.read_row(y, x + start, part, v);
      // Eq. 6 of SBF speaks of the samples' variance, the frame holds that of the mean.
      for (int i = 0; i < part; ++i) out[start + i] += std::min(v[i] * n[i] * variance_scale, kNoInformation);
    }
  }
}

// A variance of few degrees of freedom is often far too small, and a feature that seems exact keeps its pixel alone:
// where the neighbours know of more, it is raised towards their mean. Lowering those that are too large as well does
// harm, because at edges they are right.
void Source::raise_variance_row(std::size_t feature, int y, int x, int count, float* variance) const {
  constexpr int kMargin = 2 * kNeighbourRadius;
  const float degrees = frame_.degrees_of_freedom;
  for (int start = 0; start < count; start += kChunk) {
    const int part = std::min(kChunk, count - start);
    float sum[kChunk] = {};
    float found[kChunk] = {};
    float row[kChunk + kMargin];
    const int first = std::max(x + start - kNeighbourRadius, 0);
    const int end = std::min(x + start + part + kNeighbourRadius, frame_.width);
    for (int v = std::max(y - kNeighbourRadius, 0); v <= std::min(y + kNeighbourRadius, frame_.height - 1); ++v) {
      group_variance_row(feature, v, first, end - first, row);
      for (int i = 0; i < part; ++i) {
        const int at = x + start + i;
        for (int u = std::max(at - kNeighbourRadius, first); u < std::min(at + kNeighbourRadius + 1, end); ++u) {
          const float neighbour = row[u - first];
          if (!(neighbour >= 0.0F && neighbour < kNoInformation)) continue;
          sum[i] += neighbour;
          found[i] += 1.0F;
        }
      }
    }
    for (int i = 0; i < part; ++i) {
      const float mean = sum[i] / std::max(found[i], 1.0F);
      const float own = variance[start + i];
      const float weighted = (degrees * own + kNeighbourDegrees * mean) / (degrees + kNeighbourDegrees);
      variance[start + i] = own < weighted ? weighted : own;
    }
  }
}

template <class Visit>
void Source::for_each_hole(std::size_t feature, int y, int x, int count, Visit visit) const {
  if (feature_has_bad_[feature] == 0) return;
  for (int start = 0; start < count; start += kChunk) {
    const int part = std::min(kChunk, count - start);
    const FeatureHoles holes(frame_, frame_.features[feature], y, x + start, part);
    for (int i = 0; i < part; ++i) {
      if (holes.is_hole(i)) visit(start + i, holes.fill(i));
    }
  }
}

void Source::feature_mean_rows(std::size_t feature, float factor, int y, int x, int count, float* const* means) const {
  const Feature& source = frame_.features[feature];
  const std::size_t channels = source.mean.size();
  const float scale = feature_scales_[feature];
  for (std::size_t k = 0; k < channels; ++k) {
    source.mean[k].read_row(y, x, count, means[k]);
    for (int i = 0; i < count; ++i)
      means[k][i] = std::clamp(means[k][i] * (scale * factor), -kLargestMean, kLargestMean);
  }
  if (perturbation_) add_steps(feature, factor, y, x, count, means);
  for_each_hole(feature, y, x, count, [&](int i, const std::optional<FeatureFill>& fill) {
    for (std::size_t k = 0; k < channels; ++k)
      means[k][i] = fill ? std::clamp(fill->mean[k] * (scale * factor), -kLargestMean, kLargestMean) : 0.0F;
  });
}

void Source::feature_row(std::size_t feature, float factor, int y, int x, int count, float* const* means,
                         float* variance) const {
  feature_mean_rows(feature, factor, y, x, count, means);
  feature_sample_variance_row(feature, y, x, count, variance);
}

void Source::feature_sample_variance_row(std::size_t feature, int y, int x, int count, float* variance) const {
  const float scale = feature_scales_[feature];
  group_variance_row(feature, y, x, count, variance);
  if (frame_.degrees_of_freedom > 0) raise_variance_row(feature, y, x, count, variance);
  for_each_hole(feature, y, x, count, [&](int i, const std::optional<FeatureFill>& fill) {
    variance[i] = fill ? std::min(fill->sample_variance * scale * scale, kNoInformation) : kNoInformation;
  });
}

void Source::feature_variance_row(std::size_t feature, std::size_t k, int y, int x, int count, float* out) const {
  const Feature& source = frame_.features[feature];
  const float scale = feature_scales_[feature];
  std::fill_n(out, count, 0.0F);
  if (!source.variance.empty()) {
    source.variance[k].read_row(y, x, count, out);
    for (int i = 0; i < count; ++i) out[i] = std::min(out[i] * (scale * scale), kNoInformation);
  }
  for_each_hole(feature, y, x, count, [&](int i, const std::optional<FeatureFill>& fill) {
    float n = 0;
    sample_count_row(frame_, y, x + i, 1, &n);
    n = n > 1.0F ? std::min(n, kMostSamples) : 1.0F;  // 1 where it is no number
    out[i] = fill ? std::min(fill->sample_variance * (scale * scale) / n, kNoInformation) : kNoInformation;
  });
}

}  // namespace stein
