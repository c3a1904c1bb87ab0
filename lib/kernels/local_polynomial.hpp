// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cross_nlm.hpp"

namespace stein::kernels {

inline constexpr int kMaxRegressionFeatures = 12;
inline constexpr int kMaxFeatureDimensions = 4;  ///< directions of feature space that a fit has at most
inline constexpr int kMaxDimensions = 2 + kMaxFeatureDimensions;
inline constexpr int kMaxOrders = 3;
inline constexpr int kMaxPolynomialOrder = 5;
inline constexpr int kMaxRegressionRadius = 20;  ///< of windows: weights.window_radius
inline constexpr int kMaxColumns = 1 + kMaxPolynomialOrder * kMaxDimensions;
/// Added to the features' noise, normalised units: below this a difference is rounding.
inline constexpr float kLeastFeatureVariance = 1e-6F;

/// A few rows of a bank of local polynomial regressions, one candidate per range sigma and order: index
/// sigma * orders + order.
///
/// Row y of every input is y * weights.pitch further than the first one.
struct LocalPolynomialRows {
  /// Window, patches and range sigmas as for a cross non-local means bank of normalised distances without guides,
  /// except for their mask. Candidates are the range sigmas; results are those of the regressions.
  CrossNlmRows weights;
  bool has_colour_weights = true;  ///< without: one candidate per order, patches are not looked at
  const float* spatial = nullptr;  ///< per tap: the exponent of its spatial weight, 2^-spatial
  const float* position[2] = {};   ///< per tap: its offset, such that the window's variance is about 1
  const float* variance[3] = {};   ///< of the mean of `weights.colour`, in the tile; read if is_taylor

  int features = 0;                                         ///< channels, at most kMaxRegressionFeatures
  const float* feature[kMaxRegressionFeatures] = {};        ///< normalised means
  const float* feature_noise[kMaxRegressionFeatures] = {};  ///< their variances of the mean
  bool has_feature_covariance = false;
  /// Covariance of the mean of colour channel c and feature channel k, at target pixels.
  const float* feature_covariance[3][kMaxRegressionFeatures] = {};
  float noise_threshold = 0;  ///< times the noise that a direction's variance must exceed

  float ridge = 0;            ///< pixels that speak for no slope
  float curvature_ridge = 0;  ///< and for no higher power
  int orders = 0;
  int order[kMaxOrders] = {};  ///< ascending
  /// divergence[] gets the error of AOS Eq. 16 in place of the divergence.
  bool is_taylor = false;

  float* scratch = nullptr;  ///< local_polynomial_scratch() floats, aligned to 64 bytes

  /// As CrossNlmRows::layers, in place of that of `weights`. If there are any, kLayerColours more channels are given
  /// values: those of the colour. What the equivalent kernel makes of them differs from the fits by rounding, and by
  /// that factor light is scaled, so that parts of the colour sum up to the result.
  LayerChannels layers;
  const int* layer_colour = nullptr;  ///< of each channel: the colour channel that it is light of, or -1
};

inline constexpr int kLayerColours = 3;

/// Columns of the largest fit that is made: two orders more with Taylor's bias.
[[nodiscard]] constexpr int most_columns(int highest_order, bool is_taylor) noexcept {
  return 1 + (highest_order + (is_taylor ? 2 : 0)) * kMaxDimensions;
}

/// The upper triangle of the normal equations and their three right-hand sides.
[[nodiscard]] constexpr int normal_equation_sums(int columns) noexcept {
  return columns * (columns + 1) / 2 + 3 * columns;
}

/// Equivalent kernel and coefficients of the three channels.
inline constexpr int kSolutionParts = 4;

/// What a pixel and range sigma need beyond the sums: solutions, and sums over the window of the divergence and
/// variance.
[[nodiscard]] constexpr int fit_floats(int columns, int orders) noexcept {
  return orders * (kSolutionParts * columns + 6);
}

[[nodiscard]] constexpr std::size_t local_polynomial_scratch(int range_sigmas, int columns, int orders, int features) {
  const int moments = features + features * (features + 1) / 2;
  const auto per_pixel =
      static_cast<std::size_t>(range_sigmas * (normal_equation_sums(columns) + fit_floats(columns, orders)) +
                               kMaxFeatureDimensions * features + moments);
  return kNlmBlockPixels * (std::size_t{4} * kNlmTapGroup + per_pixel) + kNlmPatchFields * kNlmPatchFloats +
         static_cast<std::size_t>(normal_equation_sums(kMaxColumns) + kMaxColumns) * kMaxLanes;
}

void local_polynomial_rows(const LocalPolynomialRows& rows);

}  // namespace stein::kernels
