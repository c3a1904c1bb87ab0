// SPDX-License-Identifier: Apache-2.0
//
// How much the colour and the features of a set of samples depend on the random parameters and on the position, and
// what that makes of them in the filter: RPF sec. 4.4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exec/buffers.hpp"
#include "kernels/sample_weights.hpp"
#include "rpf/record_layout.hpp"

namespace stein::rpf {

/// Planes of a neighbourhood's samples, one per column of a record.
struct SamplePlanes {
  const float* data = nullptr;
  std::ptrdiff_t pitch = 0;
  int count = 0;
  [[nodiscard]] const float* column(int k) const noexcept { return data + k * pitch; }
};

/// Sums of mutual information, in nats.
struct Dependencies {
  std::array<float, 3> colour_random{};    ///< D_c^r,k, Eq. 11
  std::array<float, 3> colour_position{};  ///< D_c^p,k, Eq. 11
  float colour_feature = 0;                ///< D_c^f, Eq. 12 and 13
  std::vector<float> feature_random;       ///< D_f^r,k, Eq. 9
  std::vector<float> feature_position;     ///< D_f^p,k, Eq. 10
  std::vector<float> colour_on_feature;    ///< D_c^f,k of each feature, summed over the colour channels
};

/// What the filter makes of them.
struct FilterWeights {
  std::array<float, 3> alpha{};  ///< Eq. 7
  std::vector<float> beta;       ///< Eq. 5
  float colour_random = 0;       ///< W_c^r over all channels
};

/// Works out dependencies; keeps its memory between sets of samples.
class DependencyMeter {
 public:
  /// `floor`: RpfParams::information_floor.
  DependencyMeter(const RecordLayout& layout, float floor);

  /// `moments`: of each column.
  const Dependencies& measure(const SamplePlanes& planes, const kernels::PlaneMoments* moments);

 private:
  void make_codes(const SamplePlanes& planes, const kernels::PlaneMoments* moments);
  void make_entropies(int count);
  void count_bins();
  /// out[y - first_y] = mutual information of column x and each of the columns [first_y, end_y).
  void mutual_information(int x, int first_y, int end_y, float* out);

  const RecordLayout& layout_;
  float floor_;
  int count_ = 0;
  std::vector<int> first_row_;       // of each column's bins, and of all
  std::vector<std::uint8_t> codes_;  // column by column
  std::vector<std::uint32_t> words_;
  std::ptrdiff_t pitch_ = 0;
  std::vector<std::int32_t> row_count_;
  std::vector<float> n_log_n_;  // n log n
  std::vector<float> own_;      // of each column: sum of n log n over its bins
  std::vector<float> freedom_;  // of each column: its bins that hold samples, less one
  std::vector<float> joint_;    // sums of the rows of one call
  std::vector<float> pair_;     // mutual information of the pairs of one column
  Dependencies result_;
};

/// Eq. 3 to 7 and 12, with the random parameters' part grown to (1 + growth) of itself.
void weigh(const Dependencies& dependencies, float growth, FilterWeights& weights);

}  // namespace stein::rpf
