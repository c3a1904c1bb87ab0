// SPDX-License-Identifier: Apache-2.0
#include "select/mixture_weights.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "catch.hpp"

namespace stein {
namespace {

double value(const MixtureRisk& risk, const std::vector<double>& weights) {
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    sum += 2.0 * weights[k] * risk.divergences[k];
    for (std::size_t l = 0; l < weights.size(); ++l) {
      sum += weights[k] * weights[l] * risk.product(static_cast<int>(k), static_cast<int>(l));
    }
  }
  return sum;
}

// Of `count` pictures with errors of `rank` independent parts.
MixtureRisk random_risk(int count, int rank, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> errors(static_cast<std::size_t>(count),
                                          std::vector<double>(static_cast<std::size_t>(rank)));
  for (auto& error : errors) {
    for (double& part : error) part = normal(random);
  }
  MixtureRisk risk;
  risk.pixels = 1;
  for (int k = 0; k < count; ++k) {
    risk.divergences[static_cast<std::size_t>(k)] = normal(random);
    for (int l = 0; l <= k; ++l) {
      for (int part = 0; part < rank; ++part) {
        const auto i = static_cast<std::size_t>(part);
        risk.products[MixtureRisk::pair(k, l)] +=
            errors[static_cast<std::size_t>(k)][i] * errors[static_cast<std::size_t>(l)][i];
      }
    }
  }
  return risk;
}

// By trying all weights that are multiples of 1 / 60.
double least_on_grid(const MixtureRisk& risk) {
  constexpr int kSteps = 60;
  double least = 1e30;
  for (int a = 0; a <= kSteps; ++a) {
    for (int b = 0; a + b <= kSteps; ++b) {
      const double first = static_cast<double>(a) / kSteps;
      const double second = static_cast<double>(b) / kSteps;
      least = std::min(least, value(risk, {first, second, 1.0 - first - second}));
    }
  }
  return least;
}

}  // namespace

TEST_CASE("least_risk: no mixture on a fine grid is better, and weights are shares") {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    CAPTURE(trial);
    const MixtureRisk risk = random_risk(3, 1 + trial % 4, random);
    const MixtureWeights weights = least_risk(risk, 3);
    std::vector<double> shares(weights.begin(), weights.begin() + 3);
    CHECK(shares[0] + shares[1] + shares[2] == Approx(1.0).margin(1e-5));
    for (const double share : shares) CHECK(share >= 0.0);
    CHECK(value(risk, shares) <= least_on_grid(risk) + 1e-5);
    for (std::size_t k = 3; k < weights.size(); ++k) CHECK(weights[k] == 0.0F);
  }
}

TEST_CASE("least_risk: independent errors are weighed by their inverse variances") {
  MixtureRisk risk;
  risk.products[MixtureRisk::pair(0, 0)] = 1.0;
  risk.products[MixtureRisk::pair(1, 1)] = 4.0;
  risk.products[MixtureRisk::pair(2, 2)] = 16.0;
  const MixtureWeights weights = least_risk(risk, 3);
  CHECK(weights[0] == Approx(16.0 / 21.0).margin(1e-4));
  CHECK(weights[1] == Approx(4.0 / 21.0).margin(1e-4));
  CHECK(weights[2] == Approx(1.0 / 21.0).margin(1e-4));
}

TEST_CASE("least_risk: a single picture, equal ones, and nothing known") {
  MixtureRisk risk;
  CHECK(least_risk(risk, 2)[0] == 1.0F);
  risk.products[MixtureRisk::pair(0, 0)] = risk.products[MixtureRisk::pair(1, 0)] = 2.0;
  risk.products[MixtureRisk::pair(1, 1)] = 2.0;
  CHECK(least_risk(risk, 1)[0] == 1.0F);
  const MixtureWeights weights = least_risk(risk, 2);
  CHECK(weights[0] + weights[1] == 1.0F);
}

TEST_CASE("MixtureRisk: sums with factors") {
  std::mt19937 random(3);
  const MixtureRisk one = random_risk(4, 4, random);
  MixtureRisk sum = random_risk(4, 4, random);
  const MixtureRisk before = sum;
  sum.add(one, 0.5);
  CHECK(sum.product(1, 3) == Approx(before.product(3, 1) + 0.5 * one.product(1, 3)));
  CHECK(sum.divergences[2] == Approx(before.divergences[2] + 0.5 * one.divergences[2]));
  CHECK(sum.pixels == 1.5);
}

}  // namespace stein
