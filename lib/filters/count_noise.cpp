// SPDX-License-Identifier: Apache-2.0
#include "filters/count_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stein {
namespace {

constexpr double kMostEvents = 16.0;  // of more, one is a small step
// Least distance from itself, as an exponent of 2, that an event less must take a pixel: below, the derivative will do.
constexpr double kLeastMove = 0.1;
constexpr int kSingleLines = 8;  // of Less, beside guides
constexpr int kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};

}  // namespace

// A pixel's noise, as far as it goes with the brightness.
struct CountNoise::Count {
  double events = 0;
  double variance = 0;  // of the brightness
  double step = 0;      // what an event less takes off: this times the covariance with the brightness
  double colour[3] = {};
  double guide[kernels::kMaxGuideChannels] = {};  // covariances with the brightness
};

CountNoise::CountNoise(const Source& source, const GuideRows& guides, int width)
    : source_(source),
      guides_(guides),
      pitch_(kernels::whole_vectors(width) + kernels::kMaxLanes),  // lines do not share cache sets
      lines_(guides.planes() + kSingleLines) {}

CountNoise::Less CountNoise::less(float* scratch) const {
  Less all{};
  const auto next = [&] { return std::exchange(scratch, scratch + pitch_); };
  for (int k = 0; k < guides_.channels(); ++k) all.channel[k] = next();
  for (int g = 0; g < guides_.groups(); ++g) all.variance[g] = next();
  for (int c = 0; c < 3; ++c) {
    all.colour[c] = next();
    all.factor[c] = next();
  }
  all.likeness = next();
  all.samples = next();
  return all;
}

bool CountNoise::split(const Pixels& pixels, float* scratch) const {
  const Less to = less(scratch);
  sample_count_row(source_.frame(), pixels.y, pixels.x, pixels.count, to.samples);
  // What an outlier was scaled down to is no sum of events.
  source_.replaced().for_each(pixels.y, pixels.x, pixels.count,
                              [&](const ReplacedPixel&, int i) { to.samples[i] = 0; });
  for (float* factor : to.factor) std::fill_n(factor, pitch_, 0.0F);
  bool is_any = false;
  for (int i = 0; i < pixels.count; ++i) {
    std::optional<Count> found = to.samples[i] > 0.0F ? count_at(pixels, i) : std::nullopt;
    if (!found) continue;
    const double distance = move_guides(pixels, i, *found, to);
    if (!(distance >= kLeastMove)) continue;
    is_any = true;
    to.likeness[i] = static_cast<float>(std::exp2(-distance));
    for (int c = 0; c < 3; ++c) {
      to.colour[c][i] = static_cast<float>(pixels.colour[c][i] - found->colour[c] * found->step);
      to.factor[c][i] = static_cast<float>(found->colour[c] / (found->variance * found->step));
    }
    take_out(pixels, i, *found);
  }
  return is_any;
}

std::optional<CountNoise::Count> CountNoise::count_at(const Pixels& pixels, int i) {
  Count count;
  for (int c = 0; c < 3; ++c) count.colour[c] = pixels.colour_covariance[c][i];
  for (int p = 0; p < 3; ++p) {
    for (const int c : kPairs[p]) count.colour[c] += pixels.colour_covariance[3 + p][i];
  }
  double brightness = 0;
  for (int c = 0; c < 3; ++c) {
    count.colour[c] /= 3;
    count.variance += count.colour[c] / 3;
    brightness += static_cast<double>(pixels.colour[c][i]) / 3;
  }
  if (!(count.variance > 0.0 && brightness > 0.0)) return std::nullopt;
  if (!(brightness * brightness < kMostEvents * count.variance)) return std::nullopt;
  count.events = std::max(1.0, brightness * brightness / count.variance);
  count.step = brightness / count.events / count.variance;
  return count;
}

// Fills guides and their variances with an event less; returns how far that is.
double CountNoise::move_guides(const Pixels& pixels, int i, Count& count, const Less& to) const {
  const kernels::Guides& guides = pixels.guides;
  const int channels = guides_.channels();
  double distance = 0;
  for (int g = 0, k = 0; g < guides.groups; ++g) {
    double square = 0;
    for (; k < guides.group_end[g]; ++k) {
      double sum = 0;
      for (int c = 0; c < 3; ++c) sum += pixels.guide_covariance[c * channels + k][i];
      count.guide[k] = sum / (3 * kGuideSlope);
      to.channel[k][i] = static_cast<float>(guides.channel[k][i] - count.guide[k] * count.step);
      square += count.guide[k] * count.guide[k];
    }
    // The part of the group's variance that goes with the brightness is as many times an event's as there are events.
    const double own = guides.variance[g][i];
    const double all = count.variance * guides_.variance_of_mean(g, own, to.samples[i]);
    const double left = own * (1.0 - (all > 0.0 ? std::min(1.0, square / all) : 0.0) / count.events);
    to.variance[g][i] = static_cast<float>(left);
    distance += square * count.step * count.step / std::max(own + left, static_cast<double>(guides.min_variance));
  }
  return distance;
}

void CountNoise::take_out(const Pixels& pixels, int i, const Count& count) const {
  const int channels = guides_.channels();
  for (int c = 0; c < 3; ++c) {
    const double share = count.colour[c] / count.variance;
    float& variance = pixels.colour_covariance[c][i];
    variance = static_cast<float>(std::max(0.0, variance - share * count.colour[c]));
    for (int k = 0; k < channels; ++k) {
      float& covariance = pixels.guide_covariance[c * channels + k][i];
      covariance = static_cast<float>(covariance - kGuideSlope * share * count.guide[k]);
    }
  }
  for (int p = 0; p < 3; ++p) {
    const double both = count.colour[kPairs[p][0]] * count.colour[kPairs[p][1]] / count.variance;
    float& covariance = pixels.colour_covariance[3 + p][i];
    covariance = static_cast<float>(covariance - both);
  }
}

}  // namespace stein
