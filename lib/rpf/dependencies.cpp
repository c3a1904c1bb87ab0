// SPDX-License-Identifier: Apache-2.0
//
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#include "rpf/dependencies.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/sample_counts.hpp"

namespace stein::rpf {
namespace {

constexpr float kTiny = 1e-10F;  // keeps 0 / 0 from fractions: what depends on nothing is 0 % random
constexpr std::ptrdiff_t kLanes = 16;

float fraction(float part, float rest) { return part / (part + rest + kTiny); }

float sum(const std::array<float, 3>& values) { return values[0] + values[1] + values[2]; }

}  // namespace

DependencyMeter::DependencyMeter(const RecordLayout& layout, float floor) : layout_(layout), floor_(floor) {
  const auto columns = static_cast<std::size_t>(layout.columns());
  const auto features = static_cast<std::size_t>(layout.features);
  constexpr std::size_t kMostBins = kernels::kMostSampleCode + 1;
  first_row_.resize(columns + 1);
  own_.resize(columns);
  freedom_.resize(columns);
  pair_.resize(columns);
  row_count_.resize(columns * kMostBins + kLanes);
  joint_.resize(columns * kMostBins + kLanes);
  result_.feature_random.resize(features);
  result_.feature_position.resize(features);
  result_.colour_on_feature.resize(features);
}

void DependencyMeter::make_entropies(int count) {
  for (auto n = static_cast<int>(n_log_n_.size()); n <= count; ++n) {
    n_log_n_.push_back(n == 0 ? 0.0F : static_cast<float>(n * std::log(static_cast<double>(n))));
  }
}

void DependencyMeter::make_codes(const SamplePlanes& planes, const kernels::PlaneMoments* moments) {
  const int columns = layout_.columns();
  const int padded = (planes.count + kernels::kSampleBlock - 1) / kernels::kSampleBlock * kernels::kSampleBlock;
  const auto size = static_cast<std::size_t>(padded);
  if (codes_.size() < size * static_cast<std::size_t>(columns)) codes_.resize(size * static_cast<std::size_t>(columns));
  for (int k = 0; k < columns; ++k) {
    std::uint8_t* codes = codes_.data() + static_cast<std::ptrdiff_t>(k) * padded;
    first_row_[static_cast<std::size_t>(k) + 1] =
        first_row_[static_cast<std::size_t>(k)] +
        kernels::sample_codes(planes.column(k), moments[k], planes.count, codes);
  }
  pitch_ = (first_row_.back() + 2 * kLanes - 1) / kLanes * kLanes;  // whole vectors from any row on
  const std::size_t words = size / 32 * static_cast<std::size_t>(pitch_);
  if (words_.size() < words) words_.resize(words);
  const kernels::CodeBits bits{words_.data(), pitch_, padded / 32};
  for (int k = 0; k < columns; ++k) {
    const int first = first_row_[static_cast<std::size_t>(k)];
    kernels::code_rows(codes_.data() + static_cast<std::ptrdiff_t>(k) * padded, first,
                       first_row_[static_cast<std::size_t>(k) + 1] - first, bits);
  }
  kernels::row_counts(bits, first_row_.back(), row_count_.data());
  count_bins();
}

void DependencyMeter::count_bins() {
  for (std::size_t k = 0; k < own_.size(); ++k) {
    own_[k] = 0;
    freedom_[k] = -1;
    for (int r = first_row_[k]; r < first_row_[k + 1]; ++r) {
      const std::int32_t n = row_count_[static_cast<std::size_t>(r)];
      own_[k] += n_log_n_[static_cast<std::size_t>(n)];
      freedom_[k] += n > 0 ? 1.0F : 0.0F;
    }
  }
}

// Eq. 8 with p = n / N: sum n_xy/N log(N n_xy / (n_x n_y)) = log N + (sum n_xy log n_xy - sum n_x log n_x -
// sum n_y log n_y) / N. Of independent vectors that is (bins_x - 1)(bins_y - 1) / 2N on average (Miller 1955).
void DependencyMeter::mutual_information(int x, int first_y, int end_y, float* out) {
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const kernels::CodeBits bits{
      words_.data(), pitch_, (count_ + kernels::kSampleBlock - 1) / kernels::kSampleBlock * kernels::kSampleBlock / 32};
  const int first_row = first_row_[at(first_y)];
  kernels::joint_entropy_sums(bits, row_count_.data(), n_log_n_.data(), first_row_[at(x)], first_row_[at(x) + 1],
                              first_row, first_row_[at(end_y)], joint_.data());
  const float inverse = 1.0F / static_cast<float>(count_);
  const float all = n_log_n_[static_cast<std::size_t>(count_)] - own_[at(x)];
  for (int y = first_y; y < end_y; ++y) {
    float joint = 0;
    for (int r = first_row_[at(y)]; r < first_row_[at(y) + 1]; ++r) joint += joint_[at(r - first_row)];
    const float chance = 0.5F * floor_ * freedom_[at(x)] * freedom_[at(y)];
    out[y - first_y] = std::max((all + joint - own_[at(y)] - chance) * inverse, 0.0F);
  }
}

const Dependencies& DependencyMeter::measure(const SamplePlanes& planes, const kernels::PlaneMoments* moments) {
  count_ = planes.count;
  make_entropies(count_);
  make_codes(planes, moments);
  const int inputs = 2 + layout_.randoms;  // position, random parameters
  const auto position = [this] { return pair_[0] + pair_[1]; };
  const auto random = [&] { return std::accumulate(pair_.begin() + 2, pair_.begin() + inputs, 0.0F); };
  for (int k = 0; k < layout_.features; ++k) {
    mutual_information(k, layout_.position(), layout_.columns(), pair_.data());
    result_.feature_position[static_cast<std::size_t>(k)] = position();
    result_.feature_random[static_cast<std::size_t>(k)] = random();
  }
  std::fill(result_.colour_on_feature.begin(), result_.colour_on_feature.end(), 0.0F);
  for (int c = 0; c < 3; ++c) {
    mutual_information(layout_.colour() + c, layout_.position(), layout_.columns(), pair_.data());
    result_.colour_position[static_cast<std::size_t>(c)] = position();
    result_.colour_random[static_cast<std::size_t>(c)] = random();
    mutual_information(layout_.colour() + c, 0, layout_.features, pair_.data());
    for (std::size_t k = 0; k < result_.colour_on_feature.size(); ++k) result_.colour_on_feature[k] += pair_[k];
  }
  result_.colour_feature = std::accumulate(result_.colour_on_feature.begin(), result_.colour_on_feature.end(), 0.0F);
  return result_;
}

void weigh(const Dependencies& d, float growth, FilterWeights& weights) {
  const float grown = 1.0F + growth;
  for (std::size_t c = 0; c < 3; ++c) {
    const float W_cr = fraction(d.colour_random[c], d.colour_position[c]);  // Eq. 6
    weights.alpha[c] = std::max(1.0F - grown * W_cr, 0.0F);                 // Eq. 7
  }
  const float D_cr = sum(d.colour_random);
  const float D_cp = sum(d.colour_position);
  weights.colour_random = fraction(D_cr, D_cp);
  weights.beta.resize(d.feature_random.size());
  for (std::size_t k = 0; k < weights.beta.size(); ++k) {
    const float W_fr = fraction(d.feature_random[k], d.feature_position[k]);  // Eq. 3
    const float W_cf =
        fraction(d.colour_on_feature[k], D_cr + D_cp + d.colour_feature - d.colour_on_feature[k]);  // Eq. 12
    weights.beta[k] = W_cf * std::max(1.0F - grown * W_fr, 0.0F);                                   // Eq. 5
  }
}

}  // namespace stein::rpf
