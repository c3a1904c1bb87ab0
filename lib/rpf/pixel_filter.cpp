// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "rpf/pixel_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <cstdlib>
#include <cstdio>

namespace stein::rpf {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
float env(const char* n, float d) { const char* s = std::getenv(n); return s ? std::strtof(s, nullptr) : d; }

}  // namespace

PixelFilter::PixelFilter(const RecordLayout& layout, const RpfParams& params, const std::vector<OffsetTable>& tables)
    : layout_(layout), params_(params), tables_(tables), meter_(layout) {
  constexpr int kLanes = 16;
  const std::size_t bounds = at((layout.features + kLanes - 1) / kLanes * kLanes);
  low_.assign(bounds, -std::numeric_limits<float>::infinity());
  high_.assign(bounds, std::numeric_limits<float>::infinity());
  moments_.resize(at(layout.columns() + 3));
}

void PixelFilter::add_own_samples(int pass, int x, const SampleRow& row) {
  list_.clear();
  for (std::size_t i = row.first[at(x)]; i < row.first[at(x) + 1]; ++i) {
    list_.records.push_back(row.records.data() + i * at(layout_.stride));
    list_.colours.push_back(colour_before(row, layout_, pass, i));
  }
  own_ = list_.size();
}

// Sec. 4.3.1
void PixelFilter::find_bounds() {
  for (int k = 0; k < layout_.features; ++k) {
    if (own_ < 2) {  // nobody knows how much the pixel's features vary
      low_[at(k)] = -std::numeric_limits<float>::infinity();
      high_[at(k)] = std::numeric_limits<float>::infinity();
      continue;
    }
    float sum = 0;
    for (int i = 0; i < own_; ++i) sum += list_.records[at(i)][k];
    const float mean = sum / static_cast<float>(own_);
    float squares = 0;
    for (int i = 0; i < own_; ++i) {
      const float e = list_.records[at(i)][k] - mean;
      squares += e * e;
    }
    const float deviation = std::sqrt(squares / static_cast<float>(own_));
    const bool is_location = layout_.is_location[at(k)];
    float most = (is_location ? params_.location_deviations : params_.cluster_deviations) * deviation;
    static const float locfloor = env("LOCFLOOR", 0.0F);
    most = std::max(most, is_location ? locfloor : params_.least_deviation);
    low_[at(k)] = mean - most;
    high_[at(k)] = mean + most;
  }
}

// Planes of the pixel's own samples and of those neighbours that are like them.
int PixelFilter::gather() {
  const int drawn = list_.size() - own_;
  kept_.resize(at(list_.size()) + 1);
  for (int i = 0; i < own_; ++i) kept_[at(i)] = i;
  const int similar = kernels::keep_similar_samples(list_.records.data() + own_, drawn, low_.data(), high_.data(),
                                                    static_cast<int>(low_.size()), kept_.data() + own_);
  for (int i = own_; i < own_ + similar; ++i) kept_[at(i)] += own_;
  const int count = own_ + similar;
  constexpr int kBlock = kernels::kSampleBlock;
  // Planes that do not start at equal addresses modulo 4096.
  pitch_ = (count + kBlock - 1) / kBlock * kBlock + 16;
  if (pitch_ % 1024 == 0) pitch_ += 16;
  const auto planes = static_cast<std::ptrdiff_t>(2) * layout_.stride + 2 * kColourStride;
  planes_.reserve(static_cast<std::size_t>(pitch_ * planes));
  kernels::gather_samples(list_.records.data(), kept_.data(), count, layout_.stride, planes_.data(), pitch_);
  kernels::gather_samples(list_.colours.data(), kept_.data(), count, kColourStride,
                          planes_.data() + layout_.stride * pitch_, pitch_);
  return count;
}

// Sec. 4.3.2 and 4.4: alpha, beta and W_c^r from the samples as they were rendered.
void PixelFilter::measure(int pass) {
  const SamplePlanes planes{planes_.data(), pitch_, count_};
  for (int k = 0; k < layout_.columns(); ++k) moments_[at(k)] = kernels::sample_moments(planes.column(k), count_);
  weigh(meter_.measure(planes, moments_.data()), params_.pass_growth * static_cast<float>(pass), weights_);
}

// Eq. 2 and 14. The sum over the features and colours is in units that make the weight a power of 2.
void PixelFilter::filter(int /*pass*/) {
  constexpr float kLog2e = 1.44269504F;
  constexpr float kSamples = 8;
  const float sigma2 = kSamples * params_.variance / static_cast<float>(own_);
  const float rest = 1.0F - weights_.colour_random;
  const float factor = kLog2e * rest * rest / (2.0F * sigma2);  // of both variances of sec. 4.5.1
  scaled_.clear();
  float* out = planes_.data() + (layout_.stride + kColourStride) * pitch_;
  const auto add = [&](const float* plane, const kernels::PlaneMoments& moments, float importance) {
    const float scale = std::sqrt(factor * importance) * moments.inverse_deviation;
    if (!(scale > 0)) return;
    kernels::scale_samples(plane, moments.mean, scale, count_, out);
    scaled_.push_back(out);
    out += pitch_;
  };
  for (int k = 0; k < layout_.features; ++k) add(planes_.data() + k * pitch_, moments_[at(k)], weights_.beta[at(k)]);
  const float* colour = planes_.data() + layout_.stride * pitch_;
  for (int c = 0; c < 3; ++c) {
    add(colour + c * pitch_, kernels::sample_moments(colour + c * pitch_, count_), weights_.alpha[at(c)]);
  }
  result_.resize(at(own_) * 3);
  kernels::weighted_samples(
      {scaled_.data(), static_cast<int>(scaled_.size()), {colour, colour + pitch_, colour + 2 * pitch_}, count_, own_},
      result_.data());
}

// Sec. 4.5.2
void PixelFilter::reset_spikes(float* pixel) const {
  std::array<float, 3> mean{};
  std::array<float, 3> square{};
  for (int i = 0; i < own_; ++i) {
    for (std::size_t c = 0; c < 3; ++c) mean[c] += result_[at(i) * 3 + c] / static_cast<float>(own_);
  }
  for (int i = 0; i < own_; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float e = result_[at(i) * 3 + c] - mean[c];
      square[c] += e * e / static_cast<float>(own_);
    }
  }
  static const int mode = static_cast<int>(env("SPIKE", 1));
  static const float dev = env("SPIKEDEV", 1);
  auto& result = const_cast<std::vector<float>&>(result_);
  std::array<float, 3> lost{};
  for (int i = 0; i < own_ && mode > 0; ++i) {
    bool spike = false;
    for (std::size_t c = 0; c < 3; ++c) spike = spike || std::abs(result[at(i) * 3 + c] - mean[c]) > dev * std::sqrt(square[c]);
    for (std::size_t c = 0; c < 3 && spike; ++c) {
      lost[c] += result[at(i) * 3 + c] - mean[c];
      result[at(i) * 3 + c] = mean[c];
    }
  }
  for (int i = 0; i < own_ && mode == 2; ++i) {
    for (std::size_t c = 0; c < 3; ++c) result[at(i) * 3 + c] += lost[c] / static_cast<float>(own_);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = 0;
    for (int i = 0; i < own_; ++i) pixel[c] += result_[at(i) * 3 + c] / static_cast<float>(own_);
  }
}

void PixelFilter::fill_empty(int /*pass*/, int /*x*/, int /*y*/, SampleRows& /*rows*/) const {}

void PixelFilter::run(int pass, int x, int y, const std::vector<NeighbourFrame>& frames, SampleRows& rows) {
  SampleRow& row = rows.row(y);
  add_own_samples(pass, x, row);
  float* pixel = row.pixels[at(pass)].data() + static_cast<std::ptrdiff_t>(3) * x;
  if (own_ == 0) {
    fill_empty(pass, x, y, rows);
    return;
  }
  const int box = params_.boxes[at(pass)];
  const auto most = static_cast<int>(params_.shares[at(pass)] * static_cast<float>(box * box * own_));
  draw_neighbours({params_.seed, pass, x, y}, tables_[at(pass)], frames, std::max(most - own_, 0), list_);
  find_bounds();
  count_ = gather();
  measure(pass);
  filter(pass);
  if (getenv("DBG") && x % 40 == 20 && y % 40 == 20) {
    fprintf(stderr, "p%d (%d,%d) draws %d kept %d Wcr %.2f alpha %.2f %.2f %.2f beta", pass, x, y, list_.size(), count_, weights_.colour_random, weights_.alpha[0], weights_.alpha[1], weights_.alpha[2]);
    for (float b : weights_.beta) fprintf(stderr, " %.3f", b);
    fprintf(stderr, "\n   col");
    for (int i=0;i<own_;++i) fprintf(stderr, " %.3f>%.3f", list_.colours[i][1], result_[3*i+1]);
    fprintf(stderr, "\n");
  }
  reset_spikes(pixel);
  float* out = row.colours[at(pass)].data() + static_cast<std::size_t>(row.first[at(x)]) * kColourStride;
  for (int i = 0; i < own_; ++i) {
    for (int c = 0; c < 3; ++c) out[i * kColourStride + c] = result_[at(i * 3 + c)];
  }
}

}  // namespace stein::rpf
