// SPDX-License-Identifier: Apache-2.0
#include "filters/count_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stein {
namespace {

constexpr int kBlock = kernels::kMaxLanes;
constexpr double kMostEvents = 16.0;  // of more, one is a small step
// Least distance from itself, as an exponent of 2, that an event less must take a pixel: below, the derivative will do.
constexpr double kLeastMove = 0.3;
constexpr int kSingleLines = 12;  // of Lines, beside guides and results

}  // namespace

// Rows of floats, from the first target pixel on.
struct CountNoise::Lines {
  float* channel[kernels::kMaxGuideChannels];  // guides of the pixel with an event less
  float* variance[kernels::kMaxGuideGroups];
  float* colour[3];
  float* likeness;   // its weight as a neighbour of what it is
  float* factor[3];  // to the difference of F; 0 where there is no count
  float* pair[3];    // covariances of two colour channels: RG, RB, GB
  float* samples;
  float* one;
  float* result[kernels::kMaxScales][3];
  float* inverse[kernels::kMaxScales][3];  // one over the sum of weights
};

// A pixel's noise, as far as it goes with the brightness.
struct CountNoise::Count {
  double events = 0;
  double variance = 0;  // of the brightness
  double step = 0;      // what an event less takes off: this times the covariance with the brightness
  double colour[3] = {};
  double guide[kernels::kMaxGuideChannels] = {};  // covariances with the brightness
};

CountNoise::CountNoise(const Source& source, const GuideRows& guides, int width, int scales)
    : source_(source),
      guides_(guides),
      scales_(scales),
      pitch_((width + kBlock - 1) / kBlock * kBlock + kBlock),  // lines do not share cache sets
      lines_(guides.planes() + kSingleLines + std::ptrdiff_t{6} * scales) {}

CountNoise::Lines CountNoise::lines(float* scratch) const {
  Lines all{};
  const auto next = [&] { return std::exchange(scratch, scratch + pitch_); };
  for (int k = 0; k < guides_.channels(); ++k) all.channel[k] = next();
  for (int g = 0; g < guides_.groups(); ++g) all.variance[g] = next();
  for (int c = 0; c < 3; ++c) {
    all.colour[c] = next();
    all.factor[c] = next();
    all.pair[c] = next();
  }
  all.likeness = next();
  all.samples = next();
  all.one = next();
  for (int s = 0; s < scales_; ++s) {
    for (int c = 0; c < 3; ++c) {
      all.result[s][c] = next();
      all.inverse[s][c] = next();
    }
  }
  return all;
}

bool CountNoise::split(const Pixels& pixels, float* scratch) const {
  const Lines to = lines(scratch);
  const int count = pixels.row.count;
  constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int p = 0; p < 3; ++p)
    source_.colour_covariance_row(kPairs[p][0], kPairs[p][1], pixels.y, pixels.x, count, to.pair[p]);
  sample_count_row(source_.frame(), pixels.y, pixels.x, count, to.samples);
  for (float* factor : to.factor) std::fill_n(factor, pitch_, 0.0F);
  bool is_any = false;
  for (int i = 0; i < count; ++i) {
    std::optional<Count> found = count_at(pixels, to, i);
    if (!found) continue;
    const double distance = move_guides(pixels, i, *found, to);
    if (!(distance >= kLeastMove)) continue;
    is_any = true;
    to.likeness[i] = static_cast<float>(std::exp2(-distance));
    for (int c = 0; c < 3; ++c) {
      to.colour[c][i] = static_cast<float>(pixels.row.colour[c][i] - found->colour[c] * found->step);
      to.factor[c][i] = static_cast<float>(found->colour[c] / (found->variance * found->step));
    }
    take_out(pixels, i, *found);
  }
  return is_any;
}

std::optional<CountNoise::Count> CountNoise::count_at(const Pixels& pixels, const Lines& lines, int i) {
  const double rg = lines.pair[0][i];
  const double rb = lines.pair[1][i];
  const double gb = lines.pair[2][i];
  Count count;
  count.colour[0] = (pixels.variance[0][i] + rg + rb) / 3;
  count.colour[1] = (rg + pixels.variance[1][i] + gb) / 3;
  count.colour[2] = (rb + gb + pixels.variance[2][i]) / 3;
  double brightness = 0;
  for (int c = 0; c < 3; ++c) {
    count.variance += count.colour[c] / 3;
    brightness += static_cast<double>(pixels.row.colour[c][i]) / 3;
  }
  if (!(count.variance > 0.0 && brightness > 0.0)) return std::nullopt;
  if (!(brightness * brightness < kMostEvents * count.variance)) return std::nullopt;
  count.events = std::max(1.0, brightness * brightness / count.variance);
  count.step = brightness / count.events / count.variance;
  return count;
}

// Fills guides and their variances with an event less; returns how far that is.
double CountNoise::move_guides(const Pixels& pixels, int i, Count& count, const Lines& to) const {
  const kernels::Guides& guides = pixels.row.guides;
  const int channels = guides_.channels();
  double distance = 0;
  for (int g = 0, k = 0; g < guides.groups; ++g) {
    double square = 0;
    for (; k < guides.group_end[g]; ++k) {
      double sum = 0;
      for (int c = 0; c < 3; ++c) sum += pixels.covariance[c * channels + k][i];
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
    pixels.variance[c][i] = static_cast<float>(std::max(0.0, pixels.variance[c][i] - share * count.colour[c]));
    for (int k = 0; k < channels; ++k) {
      float& covariance = pixels.covariance[c * channels + k][i];
      covariance = static_cast<float>(covariance - kGuideSlope * share * count.guide[k]);
    }
  }
}

void CountNoise::add(const kernels::CrossBilateralRow& row, float* scratch) const {
  const Lines with = lines(scratch);
  std::fill_n(with.one, pitch_, 1.0F);
  for (int begin = 0; begin < row.count; begin += kBlock) {
    const auto has_count = [&](const float* factor) {
      return std::any_of(factor + begin, factor + begin + kBlock, [](float f) { return f != 0.0F; });
    };
    if (std::any_of(with.factor, with.factor + 3, has_count)) add_block(row, with, begin);
  }
}

// The bank as the pixels with an event less see their neighbours. Among these is what they are now: it is taken out
// again, and what they would be put in its place.
void CountNoise::add_block(const kernels::CrossBilateralRow& row, const Lines& with, int begin) const {
  kernels::CrossBilateralRow less = row;
  less.count = std::min(kBlock, row.count - begin);
  less.has_covariance = false;
  less.layers = {};
  const auto shift = [&](kernels::Guides& guides) {
    for (int k = 0; k < guides_.channels(); ++k) guides.channel[k] += begin;
    for (int g = 0; g < guides.groups; ++g) guides.variance[g] += begin;
    guides.mask += begin;
  };
  shift(less.guides);
  less.centre = less.guides;
  for (int k = 0; k < guides_.channels(); ++k) less.centre.channel[k] = with.channel[k] + begin;
  for (int g = 0; g < guides_.groups(); ++g) less.centre.variance[g] = with.variance[g] + begin;
  for (int c = 0; c < 3; ++c) {
    less.colour[c] += begin;
    less.variance[c] = with.one;
    for (int s = 0; s < scales_; ++s) {
      less.result[s][c] = with.result[s][c] + begin;
      less.divergence[s][c] = with.inverse[s][c] + begin;
    }
  }
  kernels::cross_bilateral_row(less);
  for (int i = begin; i < begin + less.count; ++i) {
    for (int c = 0; c < 3; ++c) {
      const double factor = with.factor[c][i];
      if (factor == 0.0) continue;
      for (int s = 0; s < scales_; ++s) {
        const double weight = with.inverse[s][c][i] > 0.0F ? 1.0 / with.inverse[s][c][i] : 0.0;
        const double sum = with.result[s][c][i] * weight - static_cast<double>(with.likeness[i]) * row.colour[c][i];
        const double F = (sum + with.colour[c][i]) / (weight - with.likeness[i] + 1.0);
        row.divergence[s][c][i] += static_cast<float>(factor * (row.result[s][c][i] - F));
      }
    }
  }
}

}  // namespace stein
