// SPDX-License-Identifier: Apache-2.0
//
// What moves of a perturbed source, and the colours that filters see of any.
#include <algorithm>
#include <array>

#include "prefilter/direction.hpp"
#include "prefilter/feature_fill.hpp"
#include "prefilter/source.hpp"

namespace stein {
namespace {

constexpr int kChunk = FeatureHoles::kMostPixels;

}  // namespace

// The directions of a perturbation at up to kChunk pixels of a row: what is the same for all channels is done once.
class Source::Directions {
 public:
  Directions(const Source& source, int y, int x, int count) : source_(source), y_(y), x_(x), count_(count) {
    float v[3][kChunk];
    float covariance[3][kChunk];
    for (std::size_t c = 0; c < 3; ++c) source.input_variance_row(c, y, x, count, v[c]);
    source.input_covariance_row(0, 1, y, x, count, v[0], v[1], covariance[0]);
    source.input_covariance_row(0, 2, y, x, count, v[0], v[2], covariance[1]);
    source.input_covariance_row(1, 2, y, x, count, v[1], v[2], covariance[2]);
    for (int i = 0; i < count; ++i) {
      factors_[i] = {v[0][i], v[1][i], v[2][i], covariance[0][i], covariance[1][i], covariance[2][i]};
      signs_[i] = random_signs(source.perturbation_->seed, source.perturbation_->draw, x + i, y);
    }
  }
  void colour(std::size_t channel, float* out) const {
    for (int i = 0; i < count_; ++i) out[i] = factors_[i].colour(channel, signs_[i]);
  }
  // Of channel k of a feature in normalised units, times `factor`.
  void feature(std::size_t feature, std::size_t k, float factor, float* out) const {
    float covariance[3][kChunk];
    for (std::size_t c = 0; c < 3; ++c)
      source_.feature_covariance_row(c, feature, k, factor, y_, x_, count_, covariance[c]);
    for (int i = 0; i < count_; ++i)
      out[i] = factors_[i].feature(covariance[0][i], covariance[1][i], covariance[2][i], signs_[i]);
  }

 private:
  const Source& source_;
  int y_;
  int x_;
  int count_;
  ColourFactor factors_[kChunk];
  std::array<float, 3> signs_[kChunk];
};

template <class Visit>
void Source::for_each_direction(int y, int x, int count, Visit visit) const {
  for (int start = 0; start < count; start += kChunk) {
    const int part = std::min(kChunk, count - start);
    visit(Directions(*this, y, x + start, part), start, part);
  }
}

void Source::colour_row(std::size_t channel, int y, int x, int count, float* out) const {
  frame_.colour[channel].read_row(y, x, count, out);
  replaced_.for_each(y, x, count, [&](const ReplacedPixel& p, int i) { out[i] = p.colour[channel]; });
  if (!perturbation_) return;
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int part) {
    add_colour_step(directions, channel, y, x + start, part, out + start);
  });
}

void Source::colour_rows(int y, int x, int count, float* const* out) const {
  for (std::size_t c = 0; c < 3; ++c) {
    frame_.colour[c].read_row(y, x, count, out[c]);
    replaced_.for_each(y, x, count, [&](const ReplacedPixel& p, int i) { out[c][i] = p.colour[c]; });
  }
  if (!perturbation_) return;
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int part) {
    for (std::size_t c = 0; c < 3; ++c) add_colour_step(directions, c, y, x + start, part, out[c] + start);
  });
}

// Moves colours as filters see them along the perturbation's direction.
void Source::add_colour_step(const Directions& directions, std::size_t channel, int y, int x, int count,
                             float* colour) const {
  float b[kChunk];
  directions.colour(channel, b);
  scale_responses(y, x, count, b);
  for (int i = 0; i < count; ++i) colour[i] += perturbation_->step * b[i];
}

void Source::direction_row(std::size_t channel, int y, int x, int count, float* out) const {
  for_each_direction(y, x, count,
                     [&](const Directions& directions, int start, int) { directions.colour(channel, out + start); });
}

void Source::direction_rows(int y, int x, int count, float* const* out) const {
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int) {
    for (std::size_t c = 0; c < 3; ++c) directions.colour(c, out[c] + start);
  });
}

void Source::feature_direction_row(std::size_t feature, std::size_t k, float factor, int y, int x, int count,
                                   float* out) const {
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int) {
    directions.feature(feature, k, factor, out + start);
  });
}

// Moves the channels of a feature, in units of `factor` times normalised ones, along the perturbation's direction.
void Source::add_steps(std::size_t feature, float factor, int y, int x, int count, float* const* means) const {
  if (frame_.features[feature].colour_covariance.empty()) return;  // does not move
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int part) {
    float b[kChunk];
    for (std::size_t k = 0; k < frame_.features[feature].mean.size(); ++k) {
      directions.feature(feature, k, factor, b);
      for (int i = 0; i < part; ++i) means[k][start + i] += perturbation_->step * b[i];
    }
  });
}

}  // namespace stein
