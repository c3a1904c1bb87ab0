// SPDX-License-Identifier: Apache-2.0
//
// Local polynomial regression as the equations say, in double, one pixel, order and sigma_r at a time.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "support/cross_nlm_reference.hpp"

namespace stein::test {

class AdaptiveOrderReference {
 public:
  /// sigma_r of weights that do not depend on the colour.
  static constexpr double kNoColour = std::numeric_limits<double>::infinity();

  /// Regresses on the features as SmoothFeatures gives them.
  AdaptiveOrderReference(const AdaptiveOrderParams& params, const Source& source);

  /// AOS Eq. 4 to 9. A nudge of features moves where the pixel's fit is read; the window's directions stay.
  [[nodiscard]] std::array<double, 3> result(int order, double sigma_r, int x, int y, const Nudge& nudge = {}) const;

  /// Joint SURE Eq. 2 by central differences of the above.
  [[nodiscard]] std::array<double, 3> divergence(int order, double sigma_r, int x, int y, Divergence divergence) const;

  /// AOS Eq. 11 to 16.
  [[nodiscard]] std::array<double, 3> taylor_error(int order, double sigma_r, int x, int y) const;

  /// Whether rounding may decide on a direction of feature space: its variance is within 1 % of the threshold.
  [[nodiscard]] bool is_near_threshold(int x, int y) const;

 private:
  using Vector = std::vector<double>;
  using Matrix = std::vector<Vector>;
  struct Eigen {
    Vector value;  // falling
    Matrix vector;
  };
  struct Window {
    std::vector<CrossNlmReference::Neighbour> neighbours;
    Matrix rows;  // X
    std::array<double, 3> own{};
    Matrix equations;  // X^T W X + ridge
  };
  [[nodiscard]] Vector features_at(int x, int y) const;
  [[nodiscard]] Matrix whitened_covariance(int x, int y, Vector& scale) const;
  [[nodiscard]] const Matrix& directions(int x, int y) const;
  [[nodiscard]] Vector read_at(int x, int y, const Nudge& nudge) const;
  [[nodiscard]] static Vector row_of(int order, const Vector& first);
  void add_equations(Window& window, std::size_t dimensions) const;
  [[nodiscard]] Window window(int order, double sigma_r, int x, int y, const Nudge& nudge) const;
  [[nodiscard]] static Vector coefficients(const Window& window, std::size_t channel);
  [[nodiscard]] static Eigen decompose(Matrix a);
  [[nodiscard]] static Vector solve(Matrix a, Vector right);

  const AdaptiveOrderParams& params_;
  const Source& source_;
  CrossNlmParams nlm_params_;
  CrossNlmReference nlm_;
  std::vector<std::pair<std::size_t, std::size_t>> channels_;  // feature and its channel
  Matrix mean_;                                                // [channel][pixel]
  Matrix noise_;
  mutable std::map<std::pair<int, int>, Matrix> directions_;  // of the pixels that were asked for
};

}  // namespace stein::test
