// SPDX-License-Identifier: Apache-2.0
//
// For renderers: what `stein::denoise` needs to know of the samples, without keeping them. Nothing to link.
//
//   stein::Accumulator film(width, height, {.features = {{"albedo", 3}, {"normal", 3}, {"depth", 1}}});
//   film.add(x, y, sample);                      // R, G, B, then the features' channels, once per sample
//   const stein::Moments moments = film.moments();
//   stein::denoise(moments.frame());
//
// Moments are kept as means and sums of squared deviations (West 1979; merged after Chan, Golub, LeVeque 1979) in
// double, so that large values with small differences lose nothing. A pixel's record is contiguous:
//   observations K | samples W | rejected | repaired | means | sums of deviations: squares, then pairs | halves
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stein/error.hpp"
#include "stein/moments.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// Per-pixel moments of samples that come in any order. Memory: one allocation of 8 bytes times 4 + channels +
/// (channels + pairs) + 8 with halves, per pixel: 384 bytes for albedo, normal and depth.
///
/// Different pixels may be added to from different threads. Where several threads meet in one pixel, give each its own
/// accumulator and merge them.
///
/// A sample with a colour that is not finite is refused and counted. A feature that is not finite never costs a sample
/// its colour, which would bias the image towards what has features: the feature counts as missed, as 0 in all of its
/// channels, and the sample is counted in `repaired`. Tests of finiteness hold under -ffast-math as well.
class Accumulator {
 public:
  /// @throws Error kInvalidArgument: sides outside [1..2^20], a feature without a name of its own or 1..4 channels.
  Accumulator(int width, int height, SampleLayout layout);

  /// One sample of layout().channels() values. No bounds check. O(channels + pairs).
  /// @returns whether it was taken.
  bool add(int x, int y, const float* sample) noexcept;

  /// Many samples of one pixel, such as a whole render's. Refused where samples, colour, or a colour's variance or
  /// covariance cannot be used; a feature is repaired if anything of it cannot.
  bool add(int x, int y, const Estimate& estimate) noexcept;

  /// Takes over all samples of `other`. In which order accumulators are merged matters to rounding alone.
  /// @throws Error kInvalidArgument if size or layout differ.
  void merge(const Accumulator& other);

  /// All records: what another process needs in order to merge, given size and layout.
  [[nodiscard]] std::span<const double> state() const noexcept { return records_; }
  /// Takes over all samples of an accumulator of the same size and layout. A pixel whose record cannot be used is
  /// refused and counted as one sample.
  /// @throws Error kInvalidArgument if the number of values differs.
  void merge(std::span<const double> state);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] const SampleLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] std::int64_t rejected() const noexcept { return total(kRejected); }  ///< samples refused; O(pixels)
  [[nodiscard]] std::int64_t repaired() const noexcept { return total(kRepaired); }  ///< with a feature at 0; O(pixels)

  /// Of what was added so far. A variance that is not known yet, from one observation, is 0.
  [[nodiscard]] Moments moments() const;

 private:
  static constexpr std::size_t kObservations = 0, kSamples = 1, kRejected = 2, kRepaired = 3, kMeans = 4;
  static constexpr std::size_t kHalf = 4;  // values of a half: samples, mean R, G, B

  // What goes into a record: a sample, an estimate or another record.
  template <class Value>
  struct Input {
    double observations;
    double samples;
    const Value* mean;
    const Value* deviations;  // null: none within
    double scale;             // of `deviations`
  };

  // Where the deviations have the covariance of a colour channel with a channel after it.
  [[nodiscard]] std::size_t pair(std::size_t colour, std::size_t channel) const noexcept {
    if (channel < 3) return channels_ + colour + channel - 1;  // R.G, R.B, G.B
    return channels_ + 3 + colour * (channels_ - 3) + channel - 3;
  }
  [[nodiscard]] double* record(int x, int y) noexcept {
    return records_.data() +
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * stride_;
  }

  // Whether channels [first, first + count) and all moments of them can be used.
  template <class Value>
  [[nodiscard]] bool usable(const Input<Value>& in, std::size_t first, std::size_t count) const noexcept;
  template <class Value>
  [[nodiscard]] bool is_sound(const Input<Value>& in) const noexcept;
  template <class Value>
  bool take(double* to, const Input<Value>& in) const noexcept;
  template <class Value>
  bool combine(double* to, const Input<Value>& in) const noexcept;
  template <class Value>
  static void combine_half(double* half, double samples, const Value* mean) noexcept;
  void write_pixel(const double* from, float* to, std::size_t plane) const noexcept;
  [[nodiscard]] float degrees_of_freedom() const noexcept;
  [[nodiscard]] std::int64_t total(std::size_t field) const noexcept;

  SampleLayout layout_;
  std::size_t channels_ = 0;
  std::size_t pairs_ = 0;
  std::size_t stride_ = 0;  // values of a record
  std::vector<double> records_;
  int width_;
  int height_;
};

inline Accumulator::Accumulator(int width, int height, SampleLayout layout)
    : layout_(std::move(layout)), width_(width), height_(height) {
  check(layout_);
  constexpr int kMaxSide = 1 << 20;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    throw Error(ErrorCode::kInvalidArgument, "Accumulator: the size is " + std::to_string(width) + "x" +
                                                 std::to_string(height) + "; each side must be 1 to " +
                                                 std::to_string(kMaxSide));
  }
  channels_ = static_cast<std::size_t>(layout_.channels());
  pairs_ = static_cast<std::size_t>(layout_.pairs());
  stride_ = kMeans + 2 * channels_ + pairs_ + (layout_.halves ? 2 * kHalf : 0);
  records_.resize(stride_ * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

inline bool Accumulator::add(int x, int y, const float* sample) noexcept {
  return take(record(x, y), Input<float>{1, 1, sample, nullptr, 0});
}

inline bool Accumulator::add(int x, int y, const Estimate& e) noexcept {
  const double degrees = e.moments == nullptr       ? 0
                         : e.degrees_of_freedom > 0 ? e.degrees_of_freedom
                                                    : std::max(e.samples - 1, 0.0);
  // Of n samples with a variance v of their mean, the squared deviations sum to v n (n - 1).
  return take(record(x, y), Input<float>{degrees + 1, e.samples, e.mean, e.moments, degrees * e.samples});
}

inline void Accumulator::merge(const Accumulator& other) {
  const auto shape = [](const Accumulator& a) {
    return std::to_string(a.width_) + "x" + std::to_string(a.height_) + "x" + std::to_string(a.channels_);
  };
  if (other.width_ != width_ || other.height_ != height_ || !(other.layout_ == layout_)) {
    throw Error(ErrorCode::kInvalidArgument, "Accumulator::merge: " + shape(other) + " values do not fit " +
                                                 shape(*this) +
                                                 "; size, features, covariances and halves must be the same");
  }
  merge(other.state());
}

inline void Accumulator::merge(std::span<const double> state) {
  if (state.size() != records_.size()) {
    throw Error(ErrorCode::kInvalidArgument, "Accumulator::merge: the state has " + std::to_string(state.size()) +
                                                 " values instead of " + std::to_string(records_.size()) +
                                                 "; size and layout must be the same");
  }
  for (std::size_t i = 0; i < records_.size(); i += stride_) {
    const double* from = state.data() + i;
    double* to = records_.data() + i;
    to[kRejected] += from[kRejected];
    to[kRepaired] += from[kRepaired];
    if (from[kSamples] == 0) continue;
    const Input<double> in{from[kObservations], from[kSamples], from + kMeans, from + kMeans + channels_, 1};
    if (!is_sound(in)) {  // of another process: it may be anything
      to[kRejected] += 1;
      continue;
    }
    combine(to, in);
    for (std::size_t h = stride_ - (layout_.halves ? 2 * kHalf : 0); h < stride_; h += kHalf) {
      if (from[h] > 0) combine_half(to + h, from[h], from + h + 1);
    }
  }
}

template <class Value>
bool Accumulator::usable(const Input<Value>& in, std::size_t first, std::size_t count) const noexcept {
  bool good = true;
  for (std::size_t i = first; i < first + count; ++i) {
    good &= detail::finite(in.mean[i]);
    if (in.deviations == nullptr) continue;
    good &= detail::finite(in.deviations[i]) && in.deviations[i] >= 0;
    for (std::size_t c = 0; layout_.covariances && c < std::min<std::size_t>(i, 3); ++c)
      good &= detail::finite(in.deviations[pair(c, i)]);
  }
  return good;
}

template <class Value>
bool Accumulator::is_sound(const Input<Value>& in) const noexcept {
  return detail::finite(in.samples) && in.samples > 0 && detail::finite(in.observations) && in.observations >= 1 &&
         usable(in, 0, 3);
}

template <class Value>
bool Accumulator::take(double* to, const Input<Value>& in) const noexcept {
  if (!is_sound(in)) {
    to[kRejected] += 1;
    return false;
  }
  if (layout_.halves) {  // to the half that has less: in turns where all samples weigh the same
    double* half = to + stride_ - 2 * kHalf;
    combine_half(half[0] <= half[kHalf] ? half : half + kHalf, in.samples, in.mean);
  }
  if (!combine(to, in)) to[kRepaired] += 1;
  return true;
}

// Both parts' deviations from their own means, and the means' distance. Returns whether all features were usable.
template <class Value>
bool Accumulator::combine(double* to, const Input<Value>& in) const noexcept {
  const double share = in.samples / (to[kSamples] + in.samples);
  const double factor = to[kSamples] * share;
  to[kObservations] += in.observations;
  to[kSamples] += in.samples;
  double* mean = to + kMeans;
  double* deviations = mean + channels_;
  std::array<double, 3> of_colour{};
  const auto add_channel = [&](std::size_t i, bool good) {
    const double distance = (good ? static_cast<double>(in.mean[i]) : 0.0) - mean[i];
    const double scale = good ? in.scale : 0;  // 0 as well where there are no deviations within
    const auto within = [&](std::size_t moment) { return scale > 0 ? scale * in.deviations[moment] : 0.0; };
    if (i < 3) of_colour[i] = distance;
    mean[i] += share * distance;
    deviations[i] += factor * distance * distance + within(i);
    for (std::size_t c = 0; layout_.covariances && c < std::min<std::size_t>(i, 3); ++c)
      deviations[pair(c, i)] += factor * of_colour[c] * distance + within(pair(c, i));
  };
  for (std::size_t c = 0; c < 3; ++c) add_channel(c, true);
  bool all_good = true;
  std::size_t first = 3;
  for (const FeatureLayout& feature : layout_.features) {
    const auto count = static_cast<std::size_t>(feature.channels);
    const bool good = usable(in, first, count);
    for (std::size_t k = first; k < first + count; ++k) add_channel(k, good);
    all_good &= good;
    first += count;
  }
  return all_good;
}

template <class Value>
void Accumulator::combine_half(double* half, double samples, const Value* mean) noexcept {
  half[0] += samples;
  for (std::size_t c = 0; c < 3; ++c) half[1 + c] += samples / half[0] * (mean[c] - half[1 + c]);
}

inline std::int64_t Accumulator::total(std::size_t field) const noexcept {
  double sum = 0;
  for (std::size_t i = field; i < records_.size(); i += stride_) sum += records_[i];
  return static_cast<std::int64_t>(sum);
}

// 0 where every sample was an observation of its own; else the mean over the pixels that have a variance.
inline float Accumulator::degrees_of_freedom() const noexcept {
  double sum = 0;
  double pixels = 0;
  bool differs = false;
  for (std::size_t i = 0; i < records_.size(); i += stride_) {
    const double observations = records_[i + kObservations];
    differs |= observations != records_[i + kSamples];
    if (!(observations > 1)) continue;
    sum += observations - 1;
    pixels += 1;
  }
  return differs && pixels > 0 ? static_cast<float>(sum / pixels) : 0.0F;
}

// Planes come in the order of the record.
inline void Accumulator::write_pixel(const double* from, float* to, std::size_t plane) const noexcept {
  const double weight = (from[kObservations] - 1) * from[kSamples];
  const double scale = weight > 0 ? 1 / weight : 0;
  const double* values = from + kMeans;
  *to = detail::to_float(from[kSamples]);
  for (std::size_t i = 0; i < channels_; ++i) *(to += plane) = detail::to_float(values[i]);
  for (std::size_t i = channels_; i < 2 * channels_ + pairs_; ++i) *(to += plane) = detail::to_float(values[i] * scale);
  for (std::size_t h = stride_ - (layout_.halves ? 2 * kHalf : 0); h < stride_; h += kHalf) {
    for (std::size_t c = 0; c < 3; ++c) *(to += plane) = detail::to_float(from[h + 1 + c]);
  }
}

inline Moments Accumulator::moments() const {
  Moments moments(width_, height_, layout_);
  const std::size_t pixels = records_.size() / stride_;
  for (std::size_t i = 0; i < pixels; ++i)
    write_pixel(records_.data() + i * stride_, moments.planes_.data() + i, pixels);
  moments.frame_.degrees_of_freedom = degrees_of_freedom();
  return moments;
}

}  // namespace stein
#pragma GCC visibility pop
