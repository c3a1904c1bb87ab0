// SPDX-License-Identifier: Apache-2.0
#include "prefilter/direction.hpp"

#include <cmath>
#include <limits>

#include "catch.hpp"
#include "prefilter/source.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// Mean of b_i b_j over all eight sign vectors: exact, not an estimate.
template <class Left, class Right>
double covariance(Left left, Right right) {
  double sum = 0;
  for (int bits = 0; bits < 8; ++bits) {
    const std::array<float, 3> z = {(bits & 1) != 0 ? 1.0F : -1.0F, (bits & 2) != 0 ? 1.0F : -1.0F,
                                    (bits & 4) != 0 ? 1.0F : -1.0F};
    sum += static_cast<double>(left(z)) * right(z);
  }
  return sum / 8.0;
}

}  // namespace

TEST_CASE("direction: signs are a function of seed, draw and pixel, and independent of each other") {
  CHECK(random_signs(1, 0, 5, 7) == random_signs(1, 0, 5, 7));
  double sums[3] = {};
  double products[3] = {};
  double neighbours = 0;
  double draws = 0;
  constexpr int kSize = 200;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const auto z = random_signs(1, 0, x, y);
      for (std::size_t i = 0; i < 3; ++i) {
        CHECK(std::abs(z[i]) == 1.0F);
        sums[i] += z[i];
        products[i] += z[i] * z[(i + 1) % 3];
      }
      neighbours += z[0] * random_signs(1, 0, x + 1, y)[0];
      draws += z[0] * random_signs(1, 1, x, y)[0];
    }
  }
  const double bound = 4.0 * kSize;  // four standard deviations of a sum of kSize^2 signs
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(std::abs(sums[i]) < bound);
    CHECK(std::abs(products[i]) < bound);
  }
  CHECK(std::abs(neighbours) < bound);
  CHECK(std::abs(draws) < bound);
}

TEST_CASE("direction: colour and feature have the covariances asked for") {
  struct Case {
    float v[3], c01, c02, c12, f[3];
  };
  const Case cases[] = {
      {{1.0F, 2.0F, 3.0F}, 0.5F, -0.3F, 1.1F, {0.2F, -0.4F, 0.7F}},
      {{1e-8F, 4e-8F, 2e-8F}, 1e-8F, 0.0F, 0.0F, {1e-5F, 2e-5F, -1e-5F}},
      {{900.0F, 100.0F, 25.0F}, 300.0F, 150.0F, 50.0F, {3.0F, 1.0F, 0.5F}},  // grey light: rank 1
      {{0.0F, 1.0F, 0.0F}, 0.0F, 0.0F, 0.0F, {0.0F, 0.3F, 0.0F}},            // one channel only
      {{0.0F, 0.0F, 0.0F}, 0.0F, 0.0F, 0.0F, {0.0F, 0.0F, 0.0F}},
  };
  for (const Case& k : cases) {
    const ColourFactor factor(k.v[0], k.v[1], k.v[2], k.c01, k.c02, k.c12);
    const auto colour = [&](std::size_t c) { return [&factor, c](const auto& z) { return factor.colour(c, z); }; };
    const auto feature = [&](const auto& z) { return factor.feature(k.f[0], k.f[1], k.f[2], z); };
    const float pairs[3][3] = {{k.v[0], k.c01, k.c02}, {k.c01, k.v[1], k.c12}, {k.c02, k.c12, k.v[2]}};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        const double margin = 1e-6 * std::sqrt(k.v[a] * k.v[b]);
        CHECK(covariance(colour(a), colour(b)) == Approx(pairs[a][b]).epsilon(1e-5).margin(margin));
      }
      CHECK(covariance(colour(a), feature) == Approx(k.f[a]).epsilon(1e-4).margin(1e-12));
    }
  }
}

TEST_CASE("source: covariances are those of the frame, bounded by the variances, and 0 where nothing is known") {
  OwnedFrame owned(6, 4, kUsualFeatures);
  fill_random(owned, 4);
  owned.at("covariance.R.B", 1, 1) = 100.0F;
  owned.at("covariance.G.albedo.R", 2, 1) = -100.0F;
  owned.at("covariance.G.albedo.R", 3, 1) = std::numeric_limits<float>::quiet_NaN();
  owned.at("albedo.G", 4, 1) = std::numeric_limits<float>::infinity();
  owned.at("R", 5, 1) = std::numeric_limits<float>::infinity();
  const Source source(owned.frame(), inspect(owned.frame()));
  float row[6];
  source.colour_covariance_row(2, 0, 1, 0, 6, row);
  CHECK(row[0] == owned.at("covariance.R.B", 0, 1));
  CHECK(row[1] == Approx(std::sqrt(owned.at("variance.R", 1, 1) * owned.at("variance.B", 1, 1))));
  CHECK(row[5] == 0.0F);
  source.colour_covariance_row(1, 1, 1, 0, 6, row);
  CHECK(row[2] == owned.at("variance.G", 2, 1));
  source.feature_covariance_row(1, 1, 0, 2.0F, 1, 0, 6, row);
  CHECK(row[0] == 2.0F * owned.at("covariance.G.albedo.R", 0, 1));
  CHECK(row[2] == Approx(-2.0 * std::sqrt(owned.at("variance.G", 2, 1) * owned.at("albedo.variance.R", 2, 1))));
  CHECK(row[3] == 0.0F);
  CHECK(row[4] == 0.0F);
  CHECK(row[5] == 0.0F);

  OwnedFrame without(6, 4, kUsualFeatures, false);
  const Source plain(without.frame(), inspect(without.frame()));
  plain.colour_covariance_row(0, 1, 0, 0, 6, row);
  CHECK(row[3] == 0.0F);
  plain.feature_covariance_row(0, 0, 0, 1.0F, 0, 0, 6, row);
  CHECK(row[3] == 0.0F);
}

TEST_CASE("source: a perturbation moves colours and features by its step, and invalid pixels not at all") {
  OwnedFrame owned(40, 3, kUsualFeatures);
  fill_random(owned, 8);
  owned.at("G", 7, 1) = std::numeric_limits<float>::quiet_NaN();
  const Source source(owned.frame(), inspect(owned.frame()));
  constexpr float kStep = 0.5F;
  const Source moved = source.perturbed({3, 2, kStep});
  float before[40];
  float after[40];
  float b[40];
  for (std::size_t c = 0; c < 3; ++c) {
    source.colour_row(c, 1, 0, 40, before);
    moved.colour_row(c, 1, 0, 40, after);
    moved.direction_row(c, 1, 0, 40, b);
    for (int x = 0; x < 40; ++x) {
      CHECK(after[x] == Approx(before[x] + kStep * b[x]).margin(1e-6));
      CHECK((std::abs(b[x]) > 0.0F) == (x != 7));
    }
  }
  float means[3][40];
  float moved_means[3][40];
  float variance[40];
  float moved_variance[40];
  float* rows[3] = {means[0], means[1], means[2]};
  float* moved_rows[3] = {moved_means[0], moved_means[1], moved_means[2]};
  source.feature_row(1, 10.0F, 1, 0, 40, rows, variance);
  moved.feature_row(1, 10.0F, 1, 0, 40, moved_rows, moved_variance);
  double sum = 0;
  for (int x = 0; x < 40; ++x) {
    CHECK(variance[x] == moved_variance[x]);
    const double step = (static_cast<double>(moved_means[0][x]) - means[0][x]) / (10.0 * kStep);
    CHECK(std::abs(step) <= 3.0 * std::sqrt(owned.at("albedo.variance.R", x, 1)));
    if (x == 7) CHECK(step == 0.0);
    sum += std::abs(step);
  }
  CHECK(sum > 0.01);
}

}  // namespace stein::test
