// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "prefilter/source.hpp"
#include "support/synthetic.hpp"

namespace stein::test {

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

TEST_CASE("source: what moves does not depend on where a row is cut, nor on how long it is") {
  constexpr int kWidth = 1100;  // rows are worked on in parts
  OwnedFrame owned(kWidth, 2, kUsualFeatures);
  fill_random(owned, 12);
  const Source source(owned.frame(), inspect(owned.frame()));
  const Source moved = source.perturbed({3, 1, 0.5F});
  std::vector<float> whole[4];
  for (std::vector<float>& row : whole) row.resize(kWidth);
  for (std::size_t c = 0; c < 3; ++c) moved.direction_row(c, 1, 0, kWidth, whole[c].data());
  moved.feature_direction_row(1, 2, 1.0F, 1, 0, kWidth, whole[3].data());
  for (const auto& [x, count] : {std::pair(0, 1), std::pair(3, 15), std::pair(505, 17), std::pair(1, 1099)}) {
    std::vector<float> part(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < 4; ++k) {
      if (k < 3) moved.direction_row(k, 1, x, count, part.data());
      if (k == 3) moved.feature_direction_row(1, 2, 1.0F, 1, x, count, part.data());
      CHECK(std::equal(part.begin(), part.end(), whole[k].begin() + x));
    }
  }
}

TEST_CASE("source: over many draws the directions have the covariances of the colour, channel by channel") {
  OwnedFrame owned(1, 1, {});
  const std::pair<const char*, float> values[] = {{"variance.R", 1.0F},      {"variance.G", 2.0F},
                                                  {"variance.B", 3.0F},      {"covariance.R.G", 0.9F},
                                                  {"covariance.R.B", -0.6F}, {"covariance.G.B", 0.8F}};
  for (const auto& [name, value] : values) owned.at(name, 0, 0) = value;
  const Source source(owned.frame(), inspect(owned.frame()));
  constexpr int kDraws = 20000;
  double sums[3][3] = {};
  double following = 0;  // of a draw and the next
  float before = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Source moved = source.perturbed({7, draw, 0.5F});
    float b[3];
    for (std::size_t c = 0; c < 3; ++c) moved.direction_row(c, 0, 0, 1, &b[c]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) sums[i][j] += static_cast<double>(b[i]) * b[j] / kDraws;
    }
    following += static_cast<double>(b[0]) * before / kDraws;
    before = b[0];
  }
  const double expected[3][3] = {{1.0, 0.9, -0.6}, {0.9, 2.0, 0.8}, {-0.6, 0.8, 3.0}};
  const double bound = 4.0 * 3.0 / std::sqrt(kDraws);  // four standard errors of products of at most some 3
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) CHECK(std::abs(sums[i][j] - expected[i][j]) < bound);
  }
  CHECK(std::abs(following) < bound);
}

}  // namespace stein::test
