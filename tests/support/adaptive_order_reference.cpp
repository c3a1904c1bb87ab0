// SPDX-License-Identifier: Apache-2.0
#include "support/adaptive_order_reference.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "filters/smooth_features.hpp"

namespace stein::test {
namespace {

// Part of what the filter is, as columns that depend on others drop out and so do features that vary by rounding.
constexpr double kDependent = 1e-5;
constexpr double kLeastNoise = 1e-6;
constexpr std::size_t kMostDirections = 4;

CrossNlmParams weights_of(const AdaptiveOrderParams& params) {
  CrossNlmParams nlm;
  nlm.distance = PatchDistance::kVarianceNormalised;
  nlm.window_radius = params.window_radius;
  nlm.patch_radius = params.patch_radius;
  nlm.patch_blur = params.patch_blur;
  nlm.guides.feature_sigmas.clear();
  nlm.guides.other_feature_sigma = 0;
  return nlm;
}

}  // namespace

AdaptiveOrderReference::AdaptiveOrderReference(const AdaptiveOrderParams& params, const Source& source)
    : params_(params), source_(source), nlm_params_(weights_of(params)), nlm_(nlm_params_, source) {
  const Frame& frame = source.frame();
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    if (params.guides.sigma_of(frame.features[f].name) <= 0) continue;
    for (std::size_t k = 0; k < frame.features[f].mean.size(); ++k) channels_.emplace_back(f, k);
  }
  const SmoothFeatures smooth(source, params.guides, frame.width, frame.height, frame.height);
  exec::TileScratch scratch;
  smooth.prepare({0, 0, frame.width, frame.height}, scratch);
  for (int k = 0; k < smooth.channels(); ++k) {
    Vector mean;
    Vector noise;
    for (int y = 0; y < frame.height; ++y) {
      mean.insert(mean.end(), smooth.mean(k, y), smooth.mean(k, y) + frame.width);
      noise.insert(noise.end(), smooth.variance(k, y), smooth.variance(k, y) + frame.width);
    }
    mean_.push_back(std::move(mean));
    noise_.push_back(std::move(noise));
  }
}

AdaptiveOrderReference::Vector AdaptiveOrderReference::features_at(int x, int y) const {
  const std::size_t at =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(source_.frame().width) + static_cast<std::size_t>(x);
  Vector features;
  for (const Vector& plane : mean_) features.push_back(plane[at]);
  return features;
}

// Over the square roots of the noise; `scale` becomes one over those.
AdaptiveOrderReference::Matrix AdaptiveOrderReference::whitened_covariance(int x, int y, Vector& scale) const {
  const std::size_t n = mean_.size();
  const auto width = static_cast<std::size_t>(source_.frame().width);
  const auto neighbours = nlm_.neighbours(kNoColour, x, y);
  const double count = std::max(static_cast<double>(neighbours.size()), 1.0);
  Vector mean(n, 0.0);
  scale.assign(n, kLeastNoise);
  for (const auto& other : neighbours) {
    const std::size_t at = static_cast<std::size_t>(other.y) * width + static_cast<std::size_t>(other.x);
    for (std::size_t k = 0; k < n; ++k) {
      mean[k] += mean_[k][at] / count;
      scale[k] += noise_[k][at] / count;
    }
  }
  for (double& value : scale) value = 1.0 / std::sqrt(value);
  Matrix covariance(n, Vector(n, 0.0));
  for (const auto& other : neighbours) {
    const Vector features = features_at(other.x, other.y);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        covariance[i][j] += scale[i] * scale[j] * (features[i] - mean[i]) * (features[j] - mean[j]) / count;
      }
    }
  }
  return covariance;
}

// Jacobi's method.
AdaptiveOrderReference::Eigen AdaptiveOrderReference::decompose(Matrix a) {
  const std::size_t n = a.size();
  Matrix v(n, Vector(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) v[i][i] = 1.0;
  for (int sweep = 0; sweep < 10; ++sweep) {
    for (std::size_t p = 0; p + 1 < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[p][p] - a[q][q]);
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        const auto turn = [&](double& first, double& second) {
          const double turned = c * first + s * second;
          second = c * second - s * first;
          first = turned;
        };
        for (std::size_t k = 0; k < n; ++k) turn(a[k][p], a[k][q]);
        for (std::size_t k = 0; k < n; ++k) turn(a[p][k], a[q][k]);
        for (std::size_t k = 0; k < n; ++k) turn(v[k][p], v[k][q]);
      }
    }
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a[i][i] > a[j][j]; });
  Eigen eigen;
  for (const std::size_t i : order) {
    eigen.value.push_back(a[i][i]);
    eigen.vector.emplace_back();
    for (std::size_t k = 0; k < n; ++k) eigen.vector.back().push_back(v[k][i]);
  }
  return eigen;
}

// [direction][channel]: what a difference of features adds to the direction, whose variance over the window is 1.
const AdaptiveOrderReference::Matrix& AdaptiveOrderReference::directions(int x, int y) const {
  const auto [entry, is_new] = directions_.try_emplace({x, y});
  Matrix& directions = entry->second;
  if (!is_new) return directions;
  Vector scale;
  const Eigen eigen = decompose(whitened_covariance(x, y, scale));
  for (std::size_t r = 0; r < std::min(eigen.value.size(), kMostDirections); ++r) {
    if (eigen.value[r] <= static_cast<double>(params_.noise_threshold)) break;
    directions.emplace_back();
    for (std::size_t k = 0; k < scale.size(); ++k) {
      directions.back().push_back(eigen.vector[r][k] * scale[k] / std::sqrt(eigen.value[r]));
    }
  }
  return directions;
}

bool AdaptiveOrderReference::is_near_threshold(int x, int y) const {
  Vector scale;
  const Eigen eigen = decompose(whitened_covariance(x, y, scale));
  return std::any_of(eigen.value.begin(), eigen.value.end(), [&](double value) {
    return std::abs(value - static_cast<double>(params_.noise_threshold)) < 0.01 * params_.noise_threshold;
  });
}

// The features at which a pixel's fit is read.
AdaptiveOrderReference::Vector AdaptiveOrderReference::read_at(int x, int y, const Nudge& nudge) const {
  Vector features = features_at(x, y);
  const std::size_t at =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(source_.frame().width) + static_cast<std::size_t>(x);
  for (std::size_t k = 0; k < features.size() && !nudge.features.empty(); ++k) {
    const auto [f, channel] = channels_[k];
    float before = 0;
    source_.feature_variance_row(f, channel, y, x, 1, &before);
    const double kept = before > 0 ? noise_[k][at] / before : 1.0;  // what smoothing leaves of a step
    features[k] += kept * source_.feature_scale(f) * nudge.features[f][channel];
  }
  return features;
}

// AOS Eq. 7; powers over the roots of their second moments for normal variates.
AdaptiveOrderReference::Vector AdaptiveOrderReference::row_of(int order, const Vector& first) {
  Vector row = {1.0};
  double moment = 1.0;
  for (int power = 1; power <= order; ++power) {
    moment *= 2 * power - 1;
    for (const double value : first) row.push_back(std::pow(value, power) / std::sqrt(moment));
  }
  return row;
}

void AdaptiveOrderReference::add_equations(Window& window, std::size_t dimensions) const {
  const std::size_t n = window.rows.empty() ? 1 : window.rows[0].size();
  window.equations.assign(n, Vector(n, 0.0));
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a; b < n; ++b) {
      const float ridge = a <= dimensions ? params_.ridge : params_.curvature_ridge.value_or(30.0F);
      double sum = a > 0 && a == b ? static_cast<double>(ridge) : 0.0;
      for (std::size_t i = 0; i < window.rows.size(); ++i) {
        sum += window.neighbours[i].weight * window.rows[i][a] * window.rows[i][b];
      }
      window.equations[a][b] = window.equations[b][a] = sum;
    }
  }
}

AdaptiveOrderReference::Window AdaptiveOrderReference::window(int order, double sigma_r, int x, int y,
                                                              const Nudge& nudge) const {
  Window window{nlm_.neighbours(sigma_r, x, y, nudge), {}, {}, {}};
  for (std::size_t c = 0; c < 3; ++c) {
    float own = 0;
    source_.colour_row(c, y, x, 1, &own);
    window.own[c] = own + nudge.colour[c];
  }
  const Matrix basis = order > 0 ? directions(x, y) : Matrix();
  const Vector own = read_at(x, y, nudge);
  const double radius = params_.window_radius;
  const double unit = 1.0 / std::sqrt(radius * (radius + 1.0) / 3.0);
  for (auto& other : window.neighbours) {
    const bool is_self = other.x == x && other.y == y;
    const Vector features = is_self ? own : features_at(other.x, other.y);
    Vector first = {unit * (other.x - x), unit * (other.y - y)};
    for (const Vector& direction : basis) {
      first.push_back(0.0);
      for (std::size_t k = 0; k < own.size(); ++k) first.back() += direction[k] * (features[k] - own[k]);
    }
    window.rows.push_back(row_of(order, first));
    if (params_.spatial_sigma <= 0) continue;
    const double distance = (other.x - x) * (other.x - x) + (other.y - y) * (other.y - y);
    other.weight *= std::exp(-distance / (2.0 * params_.spatial_sigma * params_.spatial_sigma));
  }
  add_equations(window, 2 + basis.size());
  return window;
}

// Gaussian elimination; the coefficients of columns that depend on those before them are 0.
AdaptiveOrderReference::Vector AdaptiveOrderReference::solve(Matrix a, Vector right) {
  const std::size_t n = a.size();
  const Matrix whole = a;
  std::vector<bool> is_kept(n);
  for (std::size_t k = 0; k < n; ++k) {
    is_kept[k] = a[k][k] > std::max(kDependent * whole[k][k], 1e-30);
    if (!is_kept[k]) continue;
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k + 1; j < n; ++j) a[i][j] -= factor * a[k][j];
      right[i] -= factor * right[k];
    }
  }
  Vector solution(n, 0.0);
  for (std::size_t k = n; k-- > 0;) {
    if (!is_kept[k]) continue;
    solution[k] = right[k];
    for (std::size_t j = k + 1; j < n; ++j) solution[k] -= a[k][j] * solution[j];
    solution[k] /= a[k][k];
  }
  return solution;
}

// beta
AdaptiveOrderReference::Vector AdaptiveOrderReference::coefficients(const Window& window, std::size_t channel) {
  Vector right(window.equations.size(), 0.0);
  for (std::size_t i = 0; i < window.rows.size(); ++i) {
    const double difference = window.neighbours[i].colour[channel] - window.own[channel];
    for (std::size_t a = 0; a < right.size(); ++a) {
      right[a] += window.neighbours[i].weight * window.rows[i][a] * difference;
    }
  }
  return solve(window.equations, right);
}

std::array<double, 3> AdaptiveOrderReference::result(int order, double sigma_r, int x, int y,
                                                     const Nudge& nudge) const {
  const Window at = window(order, sigma_r, x, y, nudge);
  std::array<double, 3> result{};
  for (std::size_t c = 0; c < 3; ++c) result[c] = at.own[c] + coefficients(at, c)[0];
  return result;
}

std::array<double, 3> AdaptiveOrderReference::divergence(int order, double sigma_r, int x, int y,
                                                         Divergence divergence) const {
  return divergence_reference(source_, x, y, divergence,
                              [&](const Nudge& nudge) { return result(order, sigma_r, x, y, nudge); });
}

std::array<double, 3> AdaptiveOrderReference::taylor_error(int order, double sigma_r, int x, int y) const {
  const Window low = window(order, sigma_r, x, y, {});
  const Window high = window(order + 2, sigma_r, x, y, {});
  const std::size_t n = low.equations.size();
  Vector unit(n, 0.0);
  unit[0] = 1.0;
  const Vector g = solve(low.equations, unit);
  std::array<double, 3> error{};
  for (std::size_t c = 0; c < 3; ++c) {
    const Vector beta = coefficients(high, c);
    double bias = 0;
    for (std::size_t i = 0; i < low.rows.size(); ++i) {
      const auto& other = low.neighbours[i];
      const double kernel = other.weight * std::inner_product(g.begin(), g.end(), low.rows[i].begin(), 0.0);
      double higher = 0;
      for (std::size_t b = n; b < beta.size(); ++b) higher += high.rows[i][b] * beta[b];
      float variance = 0;
      source_.variance_row(c, other.y, other.x, 1, &variance);
      bias += kernel * higher;
      error[c] += kernel * kernel * variance;
    }
    error[c] += bias * bias;
  }
  return error;
}

}  // namespace stein::test
