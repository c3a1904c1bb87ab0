// SPDX-License-Identifier: Apache-2.0
#include "core/validity.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace stein {
namespace {

constexpr int kChunk = 512;

bool is_finite(float v) noexcept { return (std::bit_cast<std::uint32_t>(v) & 0x7F800000U) != 0x7F800000U; }

// Clears mask where accept(value) is false.
template <class Accept>
void restrict_row(const ConstPlaneView& plane, int y, int x, int count, float* mask, Accept accept) {
  float values[kChunk];
  for (int i = 0; i < count; i += kChunk) {
    const int n = std::min(kChunk, count - i);
    plane.read_row(y, x + i, n, values);
    for (int k = 0; k < n; ++k) mask[i + k] = accept(values[k]) ? mask[i + k] : 0.0F;
  }
}

int count_zeros(const float* mask, int count) {
  int zeros = 0;
  for (int i = 0; i < count; ++i) zeros += mask[i] == 0.0F ? 1 : 0;
  return zeros;
}

constexpr auto kAnyFinite = [](float v) { return is_finite(v); };
// Squares of colours and products with weights must stay finite in float; no radiance is as large as that.
constexpr float kLargestColour = 1e15F;
constexpr float kLargestVariance = 1e30F;
constexpr auto kColour = [](float v) { return std::abs(v) <= kLargestColour; };
constexpr auto kColourVariance = [](float v) { return v >= 0.0F && v <= kLargestVariance; };
constexpr auto kNonNegative = [](float v) { return is_finite(v) && v >= 0.0F; };
constexpr auto kPositive = [](float v) { return is_finite(v) && v > 0.0F; };

// For messages: the first plane of pixel (x, y) that makes it invalid.
BadValue explain_colour(const Frame& frame, int x, int y) {
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const float mean = frame.colour[c].at(x, y);
    if (!kColour(mean)) return {kRgb[c], x, y, mean};
    const float variance = frame.colour_variance[c].at(x, y);
    if (!kColourVariance(variance)) return {std::string("variance.") + kRgb[c], x, y, variance};
  }
  return {"sampleCount", x, y, frame.sample_count.at(x, y)};
}

BadValue explain_feature(const Feature& feature, int x, int y) {
  for (std::size_t k = 0; k < feature.mean.size(); ++k) {
    const float mean = feature.mean[k].at(x, y);
    if (!kAnyFinite(mean)) return {plane_name(feature, k, false), x, y, mean};
    if (feature.variance.empty()) continue;
    const float variance = feature.variance[k].at(x, y);
    if (!kNonNegative(variance)) return {plane_name(feature, k, true), x, y, variance};
  }
  return {};
}

BadValue explain_layer(const Layer& layer, int x, int y) {
  for (std::size_t c = 0; c < layer.mean.size(); ++c) {
    const float mean = layer.mean[c].at(x, y);
    if (!kColour(mean)) return {plane_name(layer, c), x, y, mean};
  }
  return {};
}

BadValue explain_covariance(const Frame& frame, int x, int y) {
  constexpr std::array<const char*, 3> kPairs = {"R.G", "R.B", "G.B"};
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  for (std::size_t p = 0; p < 3 && frame.colour_covariance[p]; ++p) {
    const float value = frame.colour_covariance[p].at(x, y);
    if (!kAnyFinite(value)) return {std::string("covariance.") + kPairs[p], x, y, value};
  }
  for (const Feature& feature : frame.features) {
    const std::size_t channels = feature.mean.size();
    for (std::size_t i = 0; i < feature.colour_covariance.size(); ++i) {
      const float value = feature.colour_covariance[i].at(x, y);
      if (kAnyFinite(value)) continue;
      return {std::string("covariance.") + kRgb[i / channels] + "." + plane_name(feature, i % channels, false), x, y,
              value};
    }
  }
  return {};
}

// mask[i] = 0 where a covariance is no number though what it is of is usable, else 1. Returns the number of such
// pixels.
int covariance_validity_row(const Frame& frame, int y, int count, float* mask) {
  std::vector<float> usable(static_cast<std::size_t>(count));
  std::vector<float> finite(static_cast<std::size_t>(count));
  std::fill_n(mask, count, 1.0F);
  const auto restrict_to = [&](const auto& planes) {
    std::fill(finite.begin(), finite.end(), 1.0F);
    for (const ConstPlaneView& plane : planes) {
      if (plane) restrict_row(plane, y, 0, count, finite.data(), kAnyFinite);
    }
    for (std::size_t i = 0; i < finite.size(); ++i) mask[i] = usable[i] != 0.0F && finite[i] == 0.0F ? 0.0F : mask[i];
  };
  colour_validity_row(frame, y, 0, count, usable.data());
  restrict_to(frame.colour_covariance);
  std::vector<float> feature_usable(usable.size());
  for (const Feature& feature : frame.features) {
    if (feature.colour_covariance.empty()) continue;
    colour_validity_row(frame, y, 0, count, usable.data());
    feature_validity_row(feature, y, 0, count, feature_usable.data());
    for (std::size_t i = 0; i < usable.size(); ++i) usable[i] *= feature_usable[i];
    restrict_to(feature.colour_covariance);
  }
  return count_zeros(mask, count);
}

struct RowReport {
  int invalid = 0;
  int first_invalid_x = 0;
  int single_sample = 0;
  int bad_covariance = 0;
  int first_bad_covariance_x = 0;
  std::vector<int> bad_feature;
  std::vector<int> first_bad_x;
  std::vector<int> bad_layer;
  std::vector<int> first_bad_layer_x;
};

int first_zero(const std::vector<float>& mask) {
  return static_cast<int>(std::find(mask.begin(), mask.end(), 0.0F) - mask.begin());
}

void restrict_to_layer(const Layer& layer, int y, int x, int count, float* mask) {
  for (const ConstPlaneView& plane : layer.mean) restrict_row(plane, y, x, count, mask, kColour);
}

// `colour`: the mask of usable colour.
void inspect_layers(const Frame& frame, int y, const std::vector<float>& colour, RowReport& row) {
  std::vector<float> both(colour.size());
  for (const Layer& layer : frame.layers) {
    both = colour;
    restrict_to_layer(layer, y, 0, frame.width, both.data());
    row.bad_layer.push_back(count_zeros(both.data(), frame.width) - row.invalid);
    const auto first = std::mismatch(both.begin(), both.end(), colour.begin()).first;
    row.first_bad_layer_x.push_back(static_cast<int>(first - both.begin()));
  }
}

RowReport inspect_row(const Frame& frame, int y) {
  RowReport row;
  std::vector<float> values(static_cast<std::size_t>(frame.width));
  row.invalid = colour_validity_row(frame, y, 0, frame.width, values.data());
  if (row.invalid > 0) row.first_invalid_x = first_zero(values);
  if (!frame.layers.empty()) inspect_layers(frame, y, values, row);
  for (const Feature& feature : frame.features) {
    row.bad_feature.push_back(feature_validity_row(feature, y, 0, frame.width, values.data()));
    row.first_bad_x.push_back(row.bad_feature.back() > 0 ? first_zero(values) : 0);
  }
  if (has_covariances(frame)) {
    row.bad_covariance = covariance_validity_row(frame, y, frame.width, values.data());
    if (row.bad_covariance > 0) row.first_bad_covariance_x = first_zero(values);
  }
  sample_count_row(frame, y, 0, frame.width, values.data());
  row.single_sample = static_cast<int>(std::count(values.begin(), values.end(), 1.0F));
  return row;
}

}  // namespace

bool has_covariances(const Frame& frame) {
  return frame.colour_covariance[0] || std::any_of(frame.features.begin(), frame.features.end(),
                                                   [](const Feature& f) { return !f.colour_covariance.empty(); });
}

int colour_validity_row(const Frame& frame, int y, int x, int count, float* mask) {
  std::fill_n(mask, count, 1.0F);
  for (const ConstPlaneView& plane : frame.colour) restrict_row(plane, y, x, count, mask, kColour);
  for (const ConstPlaneView& plane : frame.colour_variance) restrict_row(plane, y, x, count, mask, kColourVariance);
  if (frame.sample_count) restrict_row(frame.sample_count, y, x, count, mask, kPositive);
  return count_zeros(mask, count);
}

int feature_validity_row(const Feature& feature, int y, int x, int count, float* mask) {
  std::fill_n(mask, count, 1.0F);
  for (const ConstPlaneView& plane : feature.mean) restrict_row(plane, y, x, count, mask, kAnyFinite);
  for (const ConstPlaneView& plane : feature.variance) restrict_row(plane, y, x, count, mask, kNonNegative);
  return count_zeros(mask, count);
}

int layer_validity_row(const Frame& frame, const Layer& layer, int y, int x, int count, float* mask) {
  colour_validity_row(frame, y, x, count, mask);
  restrict_to_layer(layer, y, x, count, mask);
  return count_zeros(mask, count);
}

void sample_count_row(const Frame& frame, int y, int x, int count, float* n) {
  if (frame.sample_count) {
    frame.sample_count.read_row(y, x, count, n);
  } else {
    std::fill_n(n, count, frame.uniform_sample_count);
  }
}

FrameReport inspect(const Frame& frame, exec::Runner& runner, double progress_weight) {
  check(frame);
  std::vector<RowReport> rows(static_cast<std::size_t>(frame.height));
  runner.for_each(frame.height, progress_weight,
                  [&](int y, int) { rows[static_cast<std::size_t>(y)] = inspect_row(frame, y); });

  FrameReport report;
  report.bad_feature_pixels.resize(frame.features.size());
  report.first_bad_feature.resize(frame.features.size());
  report.bad_layer_pixels.resize(frame.layers.size());
  report.first_bad_layer.resize(frame.layers.size());
  for (int y = 0; y < frame.height; ++y) {
    const RowReport& row = rows[static_cast<std::size_t>(y)];
    if (row.invalid > 0 && report.invalid_pixels == 0)
      report.first_invalid = explain_colour(frame, row.first_invalid_x, y);
    report.invalid_pixels += row.invalid;
    report.single_sample_pixels += row.single_sample;
    if (row.bad_covariance > 0 && report.bad_covariance_pixels == 0)
      report.first_bad_covariance = explain_covariance(frame, row.first_bad_covariance_x, y);
    report.bad_covariance_pixels += row.bad_covariance;
    for (std::size_t f = 0; f < frame.features.size(); ++f) {
      if (row.bad_feature[f] > 0 && report.bad_feature_pixels[f] == 0) {
        report.first_bad_feature[f] = explain_feature(frame.features[f], row.first_bad_x[f], y);
      }
      report.bad_feature_pixels[f] += row.bad_feature[f];
    }
    for (std::size_t l = 0; l < frame.layers.size(); ++l) {
      if (row.bad_layer[l] > 0 && report.bad_layer_pixels[l] == 0)
        report.first_bad_layer[l] = explain_layer(frame.layers[l], row.first_bad_layer_x[l], y);
      report.bad_layer_pixels[l] += row.bad_layer[l];
    }
  }
  return report;
}

}  // namespace stein
