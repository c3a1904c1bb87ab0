// SPDX-License-Identifier: Apache-2.0
//
// Random directions with given covariances, and the bounds that covariances have.
#pragma once

#include <cstdint>

namespace stein::kernels {

/// out = factor * covariance, of two means with variances va and vb >= 0: bounded by their standard deviations
/// (Cauchy-Schwarz), and 0 where the covariance is no number or nothing varies. `out` may be `covariance`.
void bounded_covariance_row(const float* covariance, const float* va, const float* vb, float factor, int count,
                            float* out);

/// Three rows of independent numbers of mean 0 and variance 1 for the pixels (x + i, y): signs, which give the least
/// variance. A function of the stream and the pixel alone, so that threads and tiles cannot change them.
/// The rows are written in whole vectors of kMaxLanes floats.
void random_sign_rows(std::uint64_t stream, int x, int y, int count, float* const* out);

/// b = L z, with z signs and L the lower triangle of L L^T = S, the covariance of three colour channels: a direction
/// with the covariance S. A pivot that is less than rounding (grey light, fewer than four samples) makes a column of
/// zeros. All rows are read and written in whole vectors of kMaxLanes floats.
struct DirectionRows {
  int count = 0;
  const float* variance[3] = {};    ///< the diagonal of S, >= 0
  const float* covariance[3] = {};  ///< of channels 0 and 1, 0 and 2, 1 and 2, bounded as above
  const float* sign[3] = {};        ///< z
  float* colour[3] = {};            ///< b
  float* solved[3] = {};            ///< S^+ b; of a singular S a generalised inverse's
  float* deviation[3] = {};         ///< square roots of the variances
};
void direction_rows(const DirectionRows& rows);

/// Of something that has the covariances c with the channels, bounded as above: scale c S^+ b, whose covariance with b
/// is scale c. Of all that have it this has the least variance, which is less noise than the thing's own.
/// All rows are read and written in whole vectors.
struct AlongRow {
  int count = 0;
  float scale = 1;
  const float* covariance[3] = {};  ///< c, as it comes
  const float* variance = nullptr;  ///< its own, >= 0
  const float* solved[3] = {};      ///< of DirectionRows
  const float* deviation[3] = {};
  float* result = nullptr;
};
void along_row(const AlongRow& row);

}  // namespace stein::kernels
