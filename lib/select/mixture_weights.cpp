// SPDX-License-Identifier: Apache-2.0
#include "select/mixture_weights.hpp"

#include <algorithm>
#include <cmath>

namespace stein {
namespace {

using Vector = std::array<double, kMaxMixed>;

bool is_among(std::uint32_t among, int k) { return ((among >> static_cast<unsigned>(k)) & 1U) != 0; }

int best_alone(const MixtureRisk& risk, int count, std::uint32_t among) {
  const auto value = [&](int k) { return risk.product(k, k) + 2.0 * risk.divergences[static_cast<std::size_t>(k)]; };
  int best = 0;
  for (int k = 1; k < count; ++k) {
    if (is_among(among, k) && value(k) < value(best)) best = k;
  }
  return best;
}

// Half of the derivative of the risk by a weight.
double slope(const MixtureRisk& risk, const Vector& weights, int count, int k) {
  double sum = risk.divergences[static_cast<std::size_t>(k)];
  for (int l = 0; l < count; ++l) sum += risk.product(k, l) * weights[static_cast<std::size_t>(l)];
  return sum;
}

// Moves weight from b to a, or back, to where the risk is least. Returns how much.
double balance(const MixtureRisk& risk, int count, int a, int b, Vector& weights) {
  const double curvature = risk.product(a, a) + risk.product(b, b) - 2.0 * risk.product(a, b);
  const double least = 1e-12 * (risk.product(a, a) + risk.product(b, b));
  if (!(curvature > least)) return 0.0;  // the same picture twice
  double& weight_a = weights[static_cast<std::size_t>(a)];
  double& weight_b = weights[static_cast<std::size_t>(b)];
  const double wanted = (slope(risk, weights, count, b) - slope(risk, weights, count, a)) / curvature;
  const double step = std::clamp(wanted, -weight_a, weight_b);
  weight_a += step;
  weight_b -= step;
  return std::abs(step);
}

}  // namespace

void MixtureRisk::add(const MixtureRisk& other, double factor) {
  for (std::size_t i = 0; i < products.size(); ++i) products[i] += factor * other.products[i];
  for (std::size_t k = 0; k < divergences.size(); ++k) divergences[k] += factor * other.divergences[k];
  noise += factor * other.noise;
  pixels += factor * other.pixels;
}

// Exact minimisation along the edges of the simplex in turn: the risk is convex, and every point where no edge leads
// down is its minimum.
MixtureWeights least_risk(const MixtureRisk& risk, int count, std::uint32_t among) {
  constexpr int kMostSweeps = 200;
  constexpr double kStill = 1e-6;
  Vector weights{};
  weights[static_cast<std::size_t>(best_alone(risk, count, among))] = 1.0;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double moved = 0;
    for (int a = 1; a < count; ++a) {
      if (!is_among(among, a)) continue;
      for (int b = 0; b < a; ++b) {
        if (is_among(among, b)) moved += balance(risk, count, a, b, weights);
      }
    }
    if (moved < kStill) break;
  }
  MixtureWeights out{};
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    out[i] = static_cast<float>(weights[i]);
  }
  return out;
}

}  // namespace stein
