// SPDX-License-Identifier: Apache-2.0
//
// Random parameter filtering of one pixel: from scattered records of samples to planes, and their weighted means.
// RPF: Sen, Darabi, "On Filtering the Noise from the Random Parameters in Monte Carlo Rendering", 2012.
#pragma once

#include <cstddef>
#include <cstdint>

namespace stein::kernels {

inline constexpr int kSampleBlock = 64;  ///< planes of samples are padded to a multiple of this
inline constexpr int kRecordGroup = 4;   ///< the size of records is a multiple of this
inline constexpr int kMostSampleCode = 31;

/// Of `count` records, those whose first `columns` values all lie within [low, high]; columns, low and high are padded
/// to a multiple of 16 values that pass. Their numbers go to `kept` in order. Returns how many they are. Records must
/// be readable up to the padded number of columns.
int keep_similar_samples(const float* const* records, int count, const float* low, const float* high, int columns,
                         std::int32_t* kept);

/// Transposes: values 0 .. columns - 1 of record kept[i] go to plane[column * pitch + i]. Columns are a multiple of
/// kRecordGroup. From `count` up to the next multiple of kSampleBlock the first record is repeated.
void gather_samples(const float* const* records, const std::int32_t* kept, int count, int columns, float* planes,
                    std::ptrdiff_t pitch);

struct PlaneMoments {
  float mean = 0;
  float inverse_deviation = 0;  ///< 0 where all values are the same
  float least = 0;
  float largest = 0;
};
PlaneMoments sample_moments(const float* plane, int count);

/// Bins of one standard deviation: code = round((x - least) / deviation), RPF sec. 4.4.3; at most kMostSampleCode. Up
/// to the next multiple of kSampleBlock codes are 255. Returns the number of bins.
int sample_codes(const float* plane, const PlaneMoments& moments, int count, std::uint8_t* codes);

/// out = (in - mean) * scale, up to the next multiple of kSampleBlock.
void scale_samples(const float* in, float mean, float scale, int count, float* out);

/// RPF Eq. 2 and 14 for several samples of a pixel: w_ij = 2^-sum_k (x_ik - x_jk)^2 over the scaled planes.
struct SampleWeights {
  const float* const* scaled = nullptr;  ///< planes, of which the pixel's own samples are the first
  int planes = 0;
  const float* colour[3] = {};  ///< what is averaged
  int count = 0;                ///< samples j
  int own = 0;                  ///< samples i: 0 .. own - 1
};
/// result[3 * i + c]
void weighted_samples(const SampleWeights& samples, float* result);

}  // namespace stein::kernels
