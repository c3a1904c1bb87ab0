// SPDX-License-Identifier: Apache-2.0
//
// What moves of a perturbed source, and the colours that filters see of any.
#include <algorithm>
#include <array>

#include "core/hash.hpp"
#include "kernels/directions.hpp"
#include "kernels/guides.hpp"
#include "prefilter/feature_fill.hpp"
#include "prefilter/source.hpp"

namespace stein {
namespace {

constexpr int kChunk = FeatureHoles::kMostPixels;
static_assert(kChunk % kernels::kMaxLanes == 0);

std::uint64_t stream_of(const Perturbation& perturbation) {
  return mixed(perturbation.seed + kGoldenRatioBits * (static_cast<std::uint64_t>(perturbation.draw) + 1));
}

}  // namespace

// The directions of a perturbation at up to kChunk pixels of a row: what is the same for all channels is done once.
class Source::Directions {
 public:
  Directions(const Source& source, int y, int x, int count)
      : source_(source),
        y_(y),
        x_(x),
        count_(count),
        colour_(lines(count)),
        solved_(lines(count)),
        deviation_(lines(count)) {
    Lines variance = lines(count);
    Lines covariance = lines(count);
    Lines sign = lines(count);
    kernels::DirectionRows rows;
    rows.count = count;
    for (std::size_t c = 0; c < 3; ++c) {
      source.input_variance_row(c, y, x, count, variance[c].value);
      rows.variance[c] = variance[c].value;
      rows.covariance[c] = covariance[c].value;
      rows.sign[c] = sign[c].value;
      rows.colour[c] = colour_[c].value;
      rows.solved[c] = solved_[c].value;
      rows.deviation[c] = deviation_[c].value;
    }
    constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (std::size_t p = 0; p < 3; ++p) {
      const auto [a, b] = kPairs[p];
      source.input_covariance_row(a, b, y, x, count, rows.variance[a], rows.variance[b], covariance[p].value);
    }
    float* const signs[3] = {sign[0].value, sign[1].value, sign[2].value};
    kernels::random_sign_rows(stream_of(*source.perturbation_), x, y, count, signs);
    kernels::direction_rows(rows);
  }
  [[nodiscard]] const float* colour(std::size_t channel) const { return colour_[channel].value; }
  // Of channel k of a feature in normalised units, times `factor`. `out` has whole vectors.
  void feature(std::size_t feature, std::size_t k, float factor, float* out) const {
    const Feature& moved = source_.frame_.features[feature];
    std::fill_n(out, count_, 0.0F);
    if (moved.colour_covariance.empty() || moved.variance.empty()) return;
    Lines covariance = lines(count_);
    Line variance(count_);
    moved.variance[k].read_row(y_, x_, count_, variance.value);
    kernels::AlongRow row;
    row.count = count_;
    row.scale = source_.feature_scales_[feature] * factor;
    for (std::size_t c = 0; c < 3; ++c) {
      moved.colour_covariance[c * moved.mean.size() + k].read_row(y_, x_, count_, covariance[c].value);
      row.covariance[c] = covariance[c].value;
      row.solved[c] = solved_[c].value;
      row.deviation[c] = deviation_[c].value;
    }
    row.variance = variance.value;
    row.result = out;
    kernels::along_row(row);
    source_.clear_unusable_row(feature, y_, x_, count_, out);
  }

 private:
  // Kernels read whole vectors: the rest of the last one is 0.
  struct alignas(64) Line {
    explicit Line(int count) { std::fill(value + count, value + kernels::whole_vectors(count), 0.0F); }
    float value[kChunk];
  };
  using Lines = std::array<Line, 3>;
  [[nodiscard]] static Lines lines(int count) { return {Line(count), Line(count), Line(count)}; }

  const Source& source_;
  int y_;
  int x_;
  int count_;
  Lines colour_;
  Lines solved_;
  Lines deviation_;
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
  std::copy_n(directions.colour(channel), count, b);
  scale_responses(y, x, count, b);
  for (int i = 0; i < count; ++i) colour[i] += perturbation_->step * b[i];
}

void Source::direction_row(std::size_t channel, int y, int x, int count, float* out) const {
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int part) {
    std::copy_n(directions.colour(channel), part, out + start);
  });
}

void Source::direction_rows(int y, int x, int count, float* const* out) const {
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int part) {
    for (std::size_t c = 0; c < 3; ++c) std::copy_n(directions.colour(c), part, out[c] + start);
  });
}

void Source::feature_direction_row(std::size_t feature, std::size_t k, float factor, int y, int x, int count,
                                   float* out) const {
  for_each_direction(y, x, count, [&](const Directions& directions, int start, int part) {
    float b[kChunk];
    directions.feature(feature, k, factor, b);
    std::copy_n(b, part, out + start);
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
