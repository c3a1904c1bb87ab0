// SPDX-License-Identifier: Apache-2.0
#include "select/selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "catch.hpp"

namespace stein {

TEST_CASE("argmin_row: the entry of least risk gets all the weight, the first of equals") {
  std::array<std::vector<float>, 3> risks = {std::vector<float>{3, 1, 2, 1, 5, -1, 0},
                                             std::vector<float>{2, 1, 2, 2, 4, -2, 0},
                                             std::vector<float>{1, 0, 1, 1, 4, -3, 0}};
  constexpr std::array<std::size_t, 6> kBest = {2, 2, 2, 0, 1, 2};
  float* maps[] = {risks[0].data(), risks[1].data(), risks[2].data()};
  argmin_row(maps, 3, 6);
  for (std::size_t x = 0; x < kBest.size(); ++x) {
    for (std::size_t e = 0; e < 3; ++e) CHECK(risks[e][x] == (e == kBest[x] ? 1.0F : 0.0F));
  }
  for (const std::vector<float>& map : risks) CHECK(map[6] == 0.0F);  // beyond the count
}

TEST_CASE("argmin_row: all equal gives the first entry, a single entry itself") {
  std::array<std::vector<float>, 2> risks = {std::vector<float>(4, 0.25F), std::vector<float>(4, 0.25F)};
  float* maps[] = {risks[0].data(), risks[1].data()};
  argmin_row(maps, 2, 4);
  CHECK(risks[0] == std::vector<float>(4, 1.0F));
  CHECK(risks[1] == std::vector<float>(4, 0.0F));
  argmin_row(maps, 1, 4);
  CHECK(risks[0] == std::vector<float>(4, 1.0F));
}

TEST_CASE("shrink_row: local evidence counts as far as it goes beyond its standard error") {
  constexpr float kPrior = 1.0F;
  // Differences from the prior of 2, 2, 2, -2, 0.1 with standard errors 0, 1, 3, 1, 1; then rounding below zero.
  const std::vector<float> mean = {3.0F, 3.0F, 3.0F, -1.0F, 1.1F, 3.0F};
  const std::vector<float> variance = {0.0F, 4.0F, 36.0F, 4.0F, 4.0F, -1.0F};
  std::vector<float> square(6);
  for (std::size_t i = 0; i < 6; ++i) square[i] = mean[i] * mean[i] + variance[i];
  const std::vector<float> inverse_count(6, 0.25F);
  std::vector<float> squared_error(6);
  standard_error_row(mean.data(), square.data(), inverse_count.data(), 6, squared_error.data());
  CHECK(squared_error[1] == Approx(1.0));
  CHECK(squared_error[5] == 0.0F);
  std::vector<float> out(7, -5.0F);
  shrink_row(mean.data(), squared_error.data(), kPrior, 6, out.data());
  CHECK(out[0] == 3.0F);
  CHECK(out[1] == Approx(1.0 + 2.0 * (1.0 - 1.0 / 4.0)));
  CHECK(out[2] == kPrior);
  CHECK(out[3] == Approx(1.0 - 2.0 * (1.0 - 1.0 / 4.0)));
  CHECK(out[4] == kPrior);
  CHECK(out[5] == 3.0F);
  CHECK(out[6] == -5.0F);
}

TEST_CASE("optimism_row: what the noise of two estimates takes off the lesser, on average") {
  constexpr int kDraws = 100000;
  constexpr float kNoise[] = {0.6F, 0.8F};  // standard deviations: of the difference 1
  std::mt19937 engine(11);                  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<float> normal;
  // Estimates that know themselves: their truths are spread as widely as one may think before having seen them.
  for (const float spread : {5.0F, 10.0F}) {
    double missing = 0;
    double squares = 0;
    double stated = 0;
    for (int i = 0; i < kDraws; ++i) {
      const float truth[] = {spread * normal(engine), 0.0F};
      const float risk[] = {truth[0] + kNoise[0] * normal(engine), truth[1] + kNoise[1] * normal(engine), 1e6F};
      const float variance[] = {kNoise[0] * kNoise[0], kNoise[1] * kNoise[1], 1.0F};
      const float* const risks[] = {risk, risk + 1, risk + 2};
      const float* const variances[] = {variance, variance + 1, variance + 2};
      float optimism = -1;
      optimism_row(risks, variances, 3, 1, &optimism);
      const int least = risk[0] < risk[1] ? 0 : 1;
      const double low = static_cast<double>(truth[least]) - static_cast<double>(risk[least]);
      missing += low - static_cast<double>(optimism);
      squares += low * low;
      stated += static_cast<double>(optimism);
    }
    INFO("spread " << spread << ": stated " << stated / kDraws << ", missing " << missing / kDraws);
    CHECK(std::abs(missing) < 4.0 * std::sqrt(squares));
    CHECK(stated > 8.0 * std::sqrt(squares));  // without it, the test would fail
  }
}

TEST_CASE("optimism_row: of five estimates that are close to each other") {
  constexpr int kEntries = 5;
  constexpr int kDraws = 200000;
  const float risk[kEntries] = {0.0F, 0.3F, -0.2F, 0.5F, 0.1F};
  const float variance[kEntries] = {1.0F, 0.5F, 0.25F, 2.0F, 0.0F};
  const float* risks[kEntries];
  const float* variances[kEntries];
  for (int e = 0; e < kEntries; ++e) {
    risks[e] = risk + e;
    variances[e] = variance + e;
  }
  std::mt19937 engine(5);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<float> normal;
  double lost = 0;
  for (int i = 0; i < kDraws; ++i) {
    float least = 1e9F;
    float noise = 0;
    for (int e = 0; e < kEntries; ++e) {
      const float own = std::sqrt(variance[e]) * normal(engine);
      if (risk[e] + own >= least) continue;
      least = risk[e] + own;
      noise = own;
    }
    lost -= static_cast<double>(noise) / kDraws;
  }
  float optimism = 0;
  optimism_row(risks, variances, kEntries, 1, &optimism);
  CHECK(optimism == Approx(lost).epsilon(0.03));  // Clark's approximation: 1 %, in any order of the entries
}

// Estimates of which the image's mean is known: their truths spread about it. Without the handicap what the choice is
// taken to lose is too much by a tenth to twice itself.
TEST_CASE("handicap_row: what noise takes off the choice between shrunk estimates and a baseline") {
  constexpr int kDraws = 40000;
  constexpr int kEntries = 4;  // the first is the baseline
  std::mt19937 engine(23);     // NOLINT(cert-msc32-c,cert-msc51-cpp): the same draws each time
  std::normal_distribution<double> normal;
  double all_lost = 0;
  double all_unequal = 0;
  for (const double prior : {0.0, 0.5, 1.0}) {
    for (const double spread : {0.5, 1.0, 2.0}) {
      for (const int entries : {2, kEntries}) {
        double lost = 0;
        double stated = 0;
        double unequal = 0;
        for (int i = 0; i < kDraws; ++i) {
          double truth[kEntries] = {};
          float mean[kEntries] = {};
          float score[kEntries] = {};
          float rival[kEntries] = {};
          float variance[kEntries] = {0.0F, 1.0F, 1.0F, 1.0F};
          const float* scores[kEntries];
          const float* rivals[kEntries];
          const float* variances[kEntries];
          for (int e = 0; e < entries; ++e) {
            const auto p = static_cast<float>(e == 0 ? 0.0 : prior);
            if (e > 0) truth[e] = prior + spread * normal(engine);
            if (e > 0) mean[e] = static_cast<float>(truth[e] + normal(engine));
            shrink_row(mean + e, variance + e, p, 1, score + e);
            handicap_row(score + e, variance + e, p, 1, rival + e);
            scores[e] = score + e;
            rivals[e] = rival + e;
            variances[e] = variance + e;
          }
          float optimism[2] = {-1.0F, -1.0F};
          optimism_row(rivals, variances, entries, 1, optimism);
          optimism_row(scores, variances, entries, 1, optimism + 1);
          const auto chosen = std::min_element(score, score + entries) - score;
          lost += truth[chosen] - static_cast<double>(mean[chosen]);
          stated += static_cast<double>(optimism[0]);
          unequal += static_cast<double>(optimism[1]);
        }
        INFO("prior " << prior << ", spread " << spread << ", entries " << entries << ": lost " << lost / kDraws
                      << ", stated " << stated / kDraws << ", without the handicap " << unequal / kDraws);
        CHECK(stated == Approx(lost).epsilon(0.15));
        CHECK(unequal > 1.1 * lost);
        all_lost += lost;
        all_unequal += unequal;
      }
    }
  }
  CHECK(all_unequal > 1.3 * all_lost);
}

TEST_CASE("optimism_row: none for a single estimate, or where estimates are exact or far apart") {
  const float risk[] = {1.0F, 2.0F, 1.5F};
  const float exact[] = {0.0F, 0.0F, 0.0F};
  const float small[] = {1e-4F, 1e-4F, 1e-4F};
  const float* const risks[] = {risk, risk + 1, risk + 2};
  const float* const none[] = {exact, exact + 1, exact + 2};
  const float* const some[] = {small, small + 1, small + 2};
  float out[2] = {-1.0F, -5.0F};
  optimism_row(risks, none, 3, 1, out);
  CHECK(out[0] == 0.0F);
  optimism_row(risks, some, 3, 1, out);
  CHECK(out[0] == 0.0F);
  const float* const equal[] = {risk, risk};
  optimism_row(equal, some, 2, 1, out);
  CHECK(out[0] == Approx(std::sqrt(2e-4) / std::sqrt(2.0 * 3.14159265)));
  optimism_row(equal, some, 1, 1, out);
  CHECK(out[0] == 0.0F);
  CHECK(out[1] == -5.0F);
}

TEST_CASE("largest_row: the index of the largest weight, the first of equals") {
  const std::array<std::vector<float>, 3> weights = {std::vector<float>{0.5F, 0.2F, 0.3F, 0.4F, 0.0F},
                                                     std::vector<float>{0.3F, 0.6F, 0.3F, 0.2F, 0.5F},
                                                     std::vector<float>{0.2F, 0.2F, 0.4F, 0.4F, 0.5F}};
  const float* maps[] = {weights[0].data(), weights[1].data(), weights[2].data()};
  std::vector<float> index(6, -1.0F);
  largest_row(maps, 3, 5, index.data());
  CHECK(index == std::vector<float>{0, 1, 2, 0, 1, -1});
}

}  // namespace stein
