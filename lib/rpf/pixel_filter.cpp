// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "rpf/pixel_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stein::rpf {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Adds the samples of a row's pixel, as they were before a pass, to sums of three.
int add_pixel(const SampleRow& row, const RecordLayout& layout, int pass, int x, float* sum) {
  const std::size_t end = row.first[at(x) + 1];
  for (std::size_t i = row.first[at(x)]; i < end; ++i) {
    const float* colour = colour_before(row, layout, pass, i);
    for (int c = 0; c < 3; ++c) sum[c] += colour[c];
  }
  return static_cast<int>(end - row.first[at(x)]);
}

}  // namespace

PixelFilter::PixelFilter(const RecordLayout& layout, const RpfParams& params, const std::vector<OffsetTable>& tables)
    : layout_(layout), params_(params), tables_(tables), meter_(layout, params.information_floor) {
  constexpr int kLanes = 16;
  const std::size_t bounds = at((layout.features + kLanes - 1) / kLanes * kLanes);
  low_.assign(bounds, -kInfinity);
  high_.assign(bounds, kInfinity);
  moments_.resize(at(layout.columns()));
}

void PixelFilter::list_own_samples(int pass, int x, const SampleRow& row) {
  list_.clear();
  for (std::size_t i = row.first[at(x)]; i < row.first[at(x) + 1]; ++i) {
    list_.records.push_back(row.records + i * at(layout_.stride));
    list_.colours.push_back(colour_before(row, layout_, pass, i));
  }
  own_ = list_.size();
}

void PixelFilter::list_neighbours(int pass, int x, int y, const SampleRows& rows,
                                  const std::vector<const SampleRows*>& adjacent) {
  frames_.assign(1, {&rows, 0, 0});
  const SampleRow& row = rows.row(y);
  for (std::size_t a = 0; a < adjacent.size(); ++a) {
    const PixelShift shift = row.shifts[at(x) * adjacent.size() + a];
    frames_.push_back({adjacent[a], shift.dx, shift.dy});
  }
  const int box = params_.boxes[at(pass)];
  const auto all = static_cast<float>(box) * static_cast<float>(box) * static_cast<float>(own_);
  const auto wanted = static_cast<int>(params_.shares[at(pass)] * all) - own_;
  draw_neighbours({params_.seed, pass, x, y}, tables_[at(pass)], frames_, std::max(wanted, 0), list_);
}

// Sec. 4.3.1
void PixelFilter::find_bounds() {
  for (int k = 0; k < layout_.features; ++k) {
    low_[at(k)] = -kInfinity;
    high_[at(k)] = kInfinity;
    // Of one sample nobody knows how much the pixel's features vary.
    if (own_ < 2 || !layout_.is_clustered[at(k)]) continue;
    float sum = 0;
    for (int i = 0; i < own_; ++i) sum += list_.records[at(i)][k];
    const float mean = sum / static_cast<float>(own_);
    float squares = 0;
    for (int i = 0; i < own_; ++i) {
      const float e = list_.records[at(i)][k] - mean;
      squares += e * e;
    }
    const float deviation = std::sqrt(squares / static_cast<float>(own_));
    const float most = layout_.is_location[at(k)]
                           ? params_.location_deviations * deviation
                           : std::max(params_.cluster_deviations * deviation, params_.least_deviation);
    low_[at(k)] = mean - most;
    high_[at(k)] = mean + most;
  }
}

// Planes of the pixel's own samples and of those neighbours that are like them.
void PixelFilter::gather() {
  kept_.resize(at(list_.size()) + 1);
  for (int i = 0; i < own_; ++i) kept_[at(i)] = i;
  const int similar = kernels::keep_similar_samples(list_.records.data() + own_, list_.size() - own_, low_.data(),
                                                    high_.data(), static_cast<int>(low_.size()), kept_.data() + own_);
  for (int i = own_; i < own_ + similar; ++i) kept_[at(i)] += own_;
  count_ = own_ + similar;
  constexpr int kBlock = kernels::kSampleBlock;
  constexpr int kStagger = 16;  // planes that do not start at equal addresses modulo 4096
  pitch_ = (count_ + kBlock - 1) / kBlock * kBlock + kStagger;
  planes_.reserve(static_cast<std::size_t>(pitch_) * at(2 * layout_.stride + 2 * kColourStride));
  kernels::gather_samples(list_.records.data(), kept_.data(), count_, layout_.stride, planes_.data(), pitch_);
  kernels::gather_samples(list_.colours.data(), kept_.data(), count_, kColourStride,
                          planes_.data() + layout_.stride * pitch_, pitch_);
}

// Sec. 4.3.2 and 4.4: alpha, beta and W_c^r from the samples as they were rendered.
void PixelFilter::weigh_columns(int pass) {
  const SamplePlanes planes{planes_.data(), pitch_, count_};
  for (int k = 0; k < layout_.columns(); ++k) moments_[at(k)] = kernels::sample_moments(planes.column(k), count_);
  weigh(meter_.measure(planes, moments_.data()), params_.pass_growth * static_cast<float>(pass), weights_);
}

// Eq. 2 and 14; the variances are those of sec. 4.5.1, the weight is a power of 2. A factor too small to matter even to
// the farthest of neighbours leaves the plane out.
void PixelFilter::filter() {
  constexpr float kLog2e = 1.44269504F;
  constexpr float kSamples = 8;
  constexpr float kLeast = 1e-6F;
  const float rest = 1.0F - weights_.colour_random;
  const float half = kLog2e * static_cast<float>(own_) / (2.0F * kSamples);
  const float colour_factor = half * rest * rest / params_.colour_variance;
  const float* colour = planes_.data() + layout_.stride * pitch_;
  float* out = planes_.data() + (layout_.stride + kColourStride) * pitch_;
  scaled_.clear();
  const auto add = [&](const float* plane, const kernels::PlaneMoments& moments, float factor) {
    if (factor <= kLeast || moments.inverse_deviation <= 0) return;
    kernels::scale_samples(plane, moments.mean, std::sqrt(factor) * moments.inverse_deviation, count_, out);
    scaled_.push_back(out);
    out += pitch_;
  };
  for (int k = 0; k < layout_.features; ++k) {
    const float own_rest = layout_.is_clustered[at(k)] ? std::max(rest, params_.least_feature_share) : rest;
    const float factor = half * own_rest * own_rest / params_.feature_variance;
    add(planes_.data() + k * pitch_, moments_[at(k)], factor * weights_.beta[at(k)]);
  }
  for (int c = 0; c < 3; ++c) {
    const float* plane = colour + c * pitch_;
    const bool as_rendered = params_.colour_unit == RpfColourUnit::kRendered;
    add(plane, as_rendered ? moments_[at(layout_.colour() + c)] : kernels::sample_moments(plane, count_),
        colour_factor * weights_.alpha[at(c)]);
  }
  result_.resize(at(own_) * 3);
  kernels::weighted_samples(
      {scaled_.data(), static_cast<int>(scaled_.size()), {colour, colour + pitch_, colour + 2 * pitch_}, count_, own_},
      result_.data());
}

// Sec. 4.5.2
void PixelFilter::settle_spikes() {
  if (params_.spikes == RpfSpikes::kKeep) return;
  const auto n = static_cast<float>(own_);
  const float threshold = params_.spike_deviations * params_.spike_deviations;
  std::array<float, 3> mean{};
  std::array<float, 3> squares{};
  std::array<float, 3> removed{};
  for (std::size_t i = 0; i < result_.size(); ++i) mean[i % 3] += result_[i] / n;
  for (std::size_t i = 0; i < result_.size(); ++i) {
    const float e = result_[i] - mean[i % 3];
    squares[i % 3] += e * e / n;
  }
  for (std::size_t i = 0; i < result_.size(); i += 3) {
    const auto is_far = [&](std::size_t c) {
      const float e = result_[i + c] - mean[c];
      return e * e > threshold * squares[c];
    };
    if (!is_far(0) && !is_far(1) && !is_far(2)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      removed[c] += result_[i + c] - mean[c];
      result_[i + c] = mean[c];
    }
  }
  if (params_.spikes == RpfSpikes::kShare) {
    for (std::size_t i = 0; i < result_.size(); ++i) result_[i] += removed[i % 3] / n;
  }
}

// A pixel without samples: the mean of the nearest square with any; where the box has none, what an earlier, larger one
// found.
void PixelFilter::fill_empty(int pass, int x, int y, const SampleRows& rows, float* pixel) const {
  if (pass > 0) {
    const float* before = rows.row(y).pixels[at(pass) - 1] + static_cast<std::ptrdiff_t>(3) * x;
    std::copy(before, before + 3, pixel);
  }
  for (int radius = 1; radius <= params_.boxes[at(pass)] / 2; ++radius) {
    std::array<float, 3> sum{};
    int count = 0;
    for (int ny = std::max(y - radius, 0); ny <= std::min(y + radius, rows.height() - 1); ++ny) {
      for (int nx = std::max(x - radius, 0); nx <= std::min(x + radius, rows.width() - 1); ++nx) {
        count += add_pixel(rows.row(ny), layout_, pass, nx, sum.data());
      }
    }
    if (count == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = sum[c] / static_cast<float>(count);
    return;
  }
}

void PixelFilter::run(int pass, int x, int y, SampleRows& rows, const std::vector<const SampleRows*>& adjacent) {
  SampleRow& row = rows.row(y);
  float* pixel = row.pixels[at(pass)] + static_cast<std::ptrdiff_t>(3) * x;
  list_own_samples(pass, x, row);
  if (own_ == 0) {
    fill_empty(pass, x, y, rows, pixel);
    return;
  }
  if (pass == 0) {
    for (std::size_t a = 0; a < adjacent.size(); ++a) {
      row.shifts[at(x) * adjacent.size() + a] = matcher_.find(rows, *adjacent[a], x, y, params_.search_radius);
    }
  }
  list_neighbours(pass, x, y, rows, adjacent);
  find_bounds();
  gather();
  weigh_columns(pass);
  filter();
  settle_spikes();
  float* out = row.colours[at(pass)] + static_cast<std::size_t>(row.first[at(x)]) * kColourStride;
  for (std::size_t i = 0; i < result_.size(); ++i) {
    out[i / 3 * kColourStride + i % 3] = result_[i];
    pixel[i % 3] += result_[i] / static_cast<float>(own_);
  }
}

}  // namespace stein::rpf
