// SPDX-License-Identifier: Apache-2.0
//
// What an Accumulator (accumulate.hpp) takes and gives. Header-only as that.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stein/error.hpp"
#include "stein/frame.hpp"

#pragma GCC visibility push(default)
namespace stein {

namespace detail {

// The exponent's bits: under -ffast-math a compiler may take std::isfinite to be true.
inline bool finite(float v) noexcept { return (std::bit_cast<std::uint32_t>(v) & 0x7F800000U) != 0x7F800000U; }
inline bool finite(double v) noexcept { return ((std::bit_cast<std::uint64_t>(v) >> 52U) & 0x7FFU) != 0x7FFU; }
inline float to_float(double v) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(v, -kLargest, kLargest));
}

}  // namespace detail

/// A feature of the samples, as `Feature` of a frame.
struct FeatureLayout {
  std::string name;
  int channels = 1;  ///< [1..4]
  bool operator==(const FeatureLayout&) const = default;
};

/// What a sample consists of and what is kept of it.
struct SampleLayout {
  std::vector<FeatureLayout> features;
  bool covariances = true;  ///< of the colour channels, and of colour and features; without them the risk is too low
  bool halves = false;      ///< two more colour means, each of every other sample

  /// Values per sample: R, G, B, then the features' channels in their order.
  [[nodiscard]] int channels() const {
    return std::accumulate(features.begin(), features.end(), 3, [](int n, const auto& f) { return n + f.channels; });
  }
  /// Covariances kept: R.G, R.B, G.B, then R with all feature channels in their order, G with them, B with them.
  [[nodiscard]] int pairs() const { return covariances ? 3 + 3 * (channels() - 3) : 0; }
  bool operator==(const SampleLayout&) const = default;
};

/// @throws Error kInvalidArgument for a feature without a name of its own, or without 1 to 4 channels.
inline void check(const SampleLayout& layout) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::kInvalidArgument, "SampleLayout: " + what); };
  std::set<std::string> names;
  for (const FeatureLayout& feature : layout.features) {
    if (feature.name.empty()) fail("a feature has no name; give each feature a unique name");
    if (!names.insert(feature.name).second) fail("two features are named '" + feature.name + "'; names must be unique");
    if (feature.channels < 1 || feature.channels > 4) {
      fail("feature '" + feature.name + "' has " + std::to_string(feature.channels) + " channels; 1 to 4 are possible");
    }
  }
}

/// What many samples of one pixel, taken elsewhere, amount to.
struct Estimate {
  double samples = 1;           ///< > 0, what the mean is of; need not be a whole number
  const float* mean = nullptr;  ///< SampleLayout::channels() values
  /// Variances of the means, channels() values, then covariances of the means, pairs() values. Null: unknown. The
  /// estimate then is one observation, and the variance comes from how estimates differ.
  const float* moments = nullptr;
  double degrees_of_freedom = 0;  ///< of `moments`; 0: samples - 1
};

/// Planes of means, variances of the means, covariances of the means, and sample counts. Owns them; move-only.
class Moments {
 public:
  Moments(Moments&&) noexcept = default;
  Moments& operator=(Moments&&) noexcept = default;
  Moments(const Moments&) = delete;  // the views of a copy would look at the original's planes
  Moments& operator=(const Moments&) = delete;
  ~Moments() = default;

  /// Valid as long as this object lives, also after it was moved.
  [[nodiscard]] const Frame& frame() const noexcept { return frame_; }
  /// Mean colour of every other sample, `which` 0 or 1; absent views without SampleLayout::halves.
  [[nodiscard]] const std::array<ConstPlaneView, 3>& half(std::size_t which) const { return halves_.at(which); }

 private:
  friend class Accumulator;
  Moments(int width, int height, const SampleLayout& layout);

  std::vector<float> planes_;
  Frame frame_;
  std::array<std::array<ConstPlaneView, 3>, 2> halves_;
};

inline Moments::Moments(int width, int height, const SampleLayout& layout) {
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const auto channels = static_cast<std::size_t>(layout.channels());
  const auto pairs = static_cast<std::size_t>(layout.pairs());
  planes_.resize(pixels * (1 + 2 * channels + pairs + (layout.halves ? 6 : 0)));
  const auto view = [&](std::size_t plane) { return ConstPlaneView(planes_.data() + plane * pixels, width, height); };
  frame_.width = width;
  frame_.height = height;
  frame_.sample_count = view(0);
  for (std::size_t c = 0; c < 3; ++c) {
    frame_.colour[c] = view(1 + c);
    frame_.colour_variance[c] = view(1 + channels + c);
    if (layout.covariances) frame_.colour_covariance[c] = view(1 + 2 * channels + c);
    for (std::size_t h = 0; layout.halves && h < 2; ++h) halves_[h][c] = view(1 + 2 * channels + pairs + 3 * h + c);
  }
  std::size_t channel = 3;
  for (const FeatureLayout& from : layout.features) {
    Feature feature{from.name, {}, {}, {}};
    const auto count = static_cast<std::size_t>(from.channels);
    for (std::size_t k = channel; k < channel + count; ++k) {
      feature.mean.push_back(view(1 + k));
      feature.variance.push_back(view(1 + channels + k));
    }
    for (std::size_t i = 0; layout.covariances && i < 3 * count; ++i) {
      const std::size_t pair = 3 + i / count * (channels - 3) + channel - 3 + i % count;
      feature.colour_covariance.push_back(view(1 + 2 * channels + pair));
    }
    channel += count;
    frame_.features.push_back(std::move(feature));
  }
}

}  // namespace stein
#pragma GCC visibility pop
