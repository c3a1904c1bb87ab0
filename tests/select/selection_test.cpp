// SPDX-License-Identifier: Apache-2.0
#include "select/selection.hpp"

#include <array>
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
