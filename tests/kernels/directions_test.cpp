// SPDX-License-Identifier: Apache-2.0
#include "kernels/directions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "catch.hpp"
#include "core/hash.hpp"
#include "kernels/guides.hpp"
#include "kernels/instruction_sets.hpp"

namespace stein::kernels {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Signs {
  Signs(std::uint64_t stream, int x, int y, int count) {
    float* rows[3];
    for (std::size_t k = 0; k < 3; ++k) {
      row[k].resize(static_cast<std::size_t>(count) + kMaxLanes);
      rows[k] = row[k].data();
    }
    random_sign_rows(stream, x, y, count, rows);
  }
  std::vector<float> row[3];
};

struct Covariances {
  float v[3], c01, c02, c12, f[3];
};

const Covariances kCases[] = {
    {{1.0F, 2.0F, 3.0F}, 0.5F, -0.3F, 1.1F, {0.2F, -0.4F, 0.7F}},
    {{1e-8F, 4e-8F, 2e-8F}, 1e-8F, 0.0F, 0.0F, {1e-5F, 2e-5F, -1e-5F}},
    {{900.0F, 100.0F, 25.0F}, 300.0F, 150.0F, 50.0F, {3.0F, 1.0F, 0.5F}},  // grey light: rank 1
    {{0.0F, 1.0F, 0.0F}, 0.0F, 0.0F, 0.0F, {0.0F, 0.3F, 0.0F}},            // one channel only
    {{0.0F, 0.0F, 0.0F}, 0.0F, 0.0F, 0.0F, {0.0F, 0.0F, 0.0F}},
};

// One case with each of the eight sign vectors: means over the pixels are exact expectations.
struct EightDirections {
  explicit EightDirections(const Covariances& c) {
    DirectionRows rows;
    rows.count = 8;
    const float pairs[3] = {c.c01, c.c02, c.c12};
    for (std::size_t k = 0; k < 3; ++k) {
      std::fill_n(variance[k], kMaxLanes, c.v[k]);
      std::fill_n(covariance[k], kMaxLanes, pairs[k]);
      std::fill_n(with_feature[k], kMaxLanes, c.f[k]);
      for (int i = 0; i < kMaxLanes; ++i) sign[k][i] = (i >> k & 1) != 0 ? 1.0F : -1.0F;
      rows.variance[k] = variance[k];
      rows.covariance[k] = covariance[k];
      rows.sign[k] = sign[k];
      rows.colour[k] = colour[k];
      rows.solved[k] = solved[k];
      rows.deviation[k] = deviation[k];
    }
    direction_rows(rows);
    AlongRow row;
    row.count = 8;
    row.scale = 2.0F;
    std::fill_n(own_variance, kMaxLanes, 1e6F);  // bounds nothing
    row.variance = own_variance;
    for (std::size_t k = 0; k < 3; ++k) {
      row.covariance[k] = with_feature[k];
      row.solved[k] = solved[k];
      row.deviation[k] = deviation[k];
    }
    row.result = feature;
    along_row(row);
  }
  static double mean_product(const float* a, const float* b) {
    double sum = 0;
    for (int i = 0; i < 8; ++i) sum += static_cast<double>(a[i]) * b[i];
    return sum / 8.0;
  }

  float variance[3][kMaxLanes], covariance[3][kMaxLanes], with_feature[3][kMaxLanes], sign[3][kMaxLanes];
  float colour[3][kMaxLanes], solved[3][kMaxLanes], deviation[3][kMaxLanes];
  float own_variance[kMaxLanes], feature[kMaxLanes];
};

}  // namespace

TEST_CASE("random signs: those of the hash, on every instruction set, wherever a row begins") {
  constexpr std::uint64_t kStream = 0x123456789ABCDEF0ULL;
  for_each_instruction_set([&] {
    for (const int x : {0, 5, 1000, (1 << 20) - 3}) {
      const Signs signs(kStream, x, 77, 100);
      int wrong = 0;
      for (int i = 0; i < 100; ++i) {
        const std::uint64_t bits = mixed(kStream ^ mixed(pixel_key(x + i, 77) + 0xD1B54A32D192ED03ULL));
        const unsigned at[3] = {17, 31, 47};
        for (std::size_t k = 0; k < 3; ++k)
          wrong += signs.row[k][static_cast<std::size_t>(i)] == ((bits >> at[k] & 1U) != 0 ? 1.0F : -1.0F) ? 0 : 1;
      }
      CHECK(wrong == 0);
    }
  });
}

TEST_CASE("random signs: independent of each other, of the neighbours' and of other streams") {
  double sums[3] = {};
  double products[3] = {};
  double neighbours = 0;
  double streams = 0;
  constexpr std::size_t kSize = 200;
  for (int y = 0; y < static_cast<int>(kSize); ++y) {
    const Signs signs(1, 0, y, static_cast<int>(kSize) + 1);
    const Signs other(2, 0, y, static_cast<int>(kSize));
    for (std::size_t x = 0; x < kSize; ++x) {
      for (std::size_t k = 0; k < 3; ++k) {
        sums[k] += signs.row[k][x];
        products[k] += signs.row[k][x] * signs.row[(k + 1) % 3][x];
      }
      neighbours += signs.row[0][x] * signs.row[0][x + 1];
      streams += signs.row[0][x] * other.row[0][x];
    }
  }
  const double bound = 4.0 * kSize;  // four standard deviations of a sum of kSize^2 signs
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(std::abs(sums[k]) < bound);
    CHECK(std::abs(products[k]) < bound);
  }
  CHECK(std::abs(neighbours) < bound);
  CHECK(std::abs(streams) < bound);
}

TEST_CASE("directions: colour and feature have the covariances asked for, on every instruction set") {
  for_each_instruction_set([] {
    for (const Covariances& c : kCases) {
      const EightDirections b(c);
      const float pairs[3][3] = {{c.v[0], c.c01, c.c02}, {c.c01, c.v[1], c.c12}, {c.c02, c.c12, c.v[2]}};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          const double margin = 1e-6 * std::sqrt(c.v[i] * c.v[j]);
          CHECK(EightDirections::mean_product(b.colour[i], b.colour[j]) ==
                Approx(pairs[i][j]).epsilon(1e-5).margin(margin));
        }
        CHECK(EightDirections::mean_product(b.colour[i], b.feature) ==
              Approx(2.0 * c.f[i]).epsilon(1e-4).margin(1e-12));
        CHECK(b.deviation[i][0] == Approx(std::sqrt(c.v[i])));
      }
    }
  });
}

TEST_CASE("directions: covariances with a feature are bounded, and those that are no number count as 0") {
  EightDirections b({{4.0F, 1.0F, 1.0F}, 0.0F, 0.0F, 0.0F, {}});
  AlongRow row;
  row.count = 4;
  const float variances[kMaxLanes] = {9.0F, 9.0F, 9.0F, 0.0F};
  const float first[kMaxLanes] = {100.0F, -100.0F, kNan, 1.0F};
  const float rest[kMaxLanes] = {};
  row.variance = variances;
  for (std::size_t k = 0; k < 3; ++k) {
    row.covariance[k] = k == 0 ? first : rest;
    row.solved[k] = b.solved[k];
    row.deviation[k] = b.deviation[k];
  }
  row.result = b.feature;
  along_row(row);
  // With the first channel alone c S^+ b is c / 4 times its b, which is 2 z.
  CHECK(b.feature[0] == Approx(6.0F / 4.0F * b.colour[0][0]));
  CHECK(b.feature[1] == Approx(-6.0F / 4.0F * b.colour[0][1]));
  CHECK(b.feature[2] == 0.0F);
  CHECK(b.feature[3] == 0.0F);
}

TEST_CASE("bounded covariances: any count, in place, and nothing beyond the count, on every instruction set") {
  constexpr float kUntouched = -77.0F;
  constexpr std::size_t kMost = 50;
  std::vector<float> covariance(kMost);
  std::vector<float> va(kMost);
  std::vector<float> vb(kMost);
  std::vector<float> expected(kMost);
  const float odd[] = {kNan, kInfinity, -kInfinity, 0.0F};
  for (std::size_t i = 0; i < kMost; ++i) {
    covariance[i] = i % 5 == 0 ? odd[i / 5 % 4] : static_cast<float>(i) - 25.0F;
    va[i] = i % 7 == 3 ? 0.0F : static_cast<float>(i);
    vb[i] = 0.25F * static_cast<float>(i + 1);
    const float limit = std::sqrt(va[i]) * std::sqrt(vb[i]);
    expected[i] = std::isfinite(covariance[i]) ? 3.0F * std::clamp(covariance[i], -limit, limit) : 0.0F;
  }
  for_each_instruction_set([&] {
    for (std::size_t count = 0; count <= kMost; ++count) {
      std::vector<float> out(kMost + 1, kUntouched);
      std::copy_n(covariance.begin(), count, out.begin());
      bounded_covariance_row(out.data(), va.data(), vb.data(), 3.0F, static_cast<int>(count), out.data());
      int wrong = 0;
      for (std::size_t i = 0; i < out.size(); ++i) wrong += out[i] == (i < count ? expected[i] : kUntouched) ? 0 : 1;
      CHECK(wrong == 0);
    }
  });
}

}  // namespace stein::kernels
