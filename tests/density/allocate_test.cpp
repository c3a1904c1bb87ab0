// SPDX-License-Identifier: Apache-2.0
//
// The properties of allocate_samples on random densities, against a slow bisection, and its errors.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "stein/density.hpp"
#include "stein/error.hpp"

namespace {

using stein::AllocationParams;

struct Case {
  std::vector<float> density;
  int width = 0;
  AllocationParams params;
  std::vector<float> existing = {};
};

std::vector<std::uint32_t> allocate(const Case& c) {
  const int height = static_cast<int>(c.density.size()) / c.width;
  const stein::ConstPlaneView existing(c.existing.empty() ? nullptr : c.existing.data(), c.width, height);
  return stein::allocate_samples({c.density.data(), c.width, height}, c.params, existing);
}

std::vector<std::uint32_t> allocate(const std::vector<float>& density, std::int64_t budget, std::uint32_t low = 0,
                                    std::uint32_t high = UINT32_MAX) {
  return allocate(Case{density, static_cast<int>(density.size()), {budget, low, high}});
}

std::int64_t total(const std::vector<std::uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

/// A density over 60 decades or a narrow range, with zeros and repeated values; bounds and a budget between them.
Case random_case(std::mt19937& random) {
  const auto between = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  Case c;
  c.width = between(1, 20);
  c.density.resize(static_cast<std::size_t>(c.width) * static_cast<std::size_t>(between(1, 20)));
  const float decades = between(0, 1) == 0 ? 30.0F : 2.0F;
  const int zeros_percent = between(0, 2) * 20;
  std::uniform_real_distribution<float> exponent(-decades, decades);
  for (float& s : c.density) {
    s = between(0, 99) < zeros_percent ? 0.0F : std::pow(10.0F, exponent(random));
    if (between(0, 9) == 0) s = c.density.front();
  }
  c.params.min_per_pixel = static_cast<std::uint32_t>(between(0, 1) * between(0, 10));
  c.params.max_per_pixel =
      c.params.min_per_pixel + static_cast<std::uint32_t>(between(0, 1) == 0 ? between(0, 40) : 100000);
  const auto pixels = static_cast<std::int64_t>(c.density.size());
  const std::int64_t low = pixels * c.params.min_per_pixel;
  const std::int64_t high = pixels * c.params.max_per_pixel;
  const int kind = between(0, 9);
  const std::int64_t upper = kind < 5 ? std::min(high, low + 20 * pixels) : high;
  c.params.budget = kind == 9 ? high : std::uniform_int_distribution<std::int64_t>(low, upper)(random);
  return c;
}

/// clamp(level * S, min, max) with the level found by bisection over all magnitudes; zeros share what saturation
/// leaves.
std::vector<double> ideal_shares(const Case& c) {
  const auto budget = static_cast<double>(c.params.budget);
  const double low = c.params.min_per_pixel;
  const double high = c.params.max_per_pixel;
  const auto at_level = [&](double log_level) {
    std::vector<double> shares;
    for (std::size_t i = 0; i < c.density.size(); ++i) {
      const double existing = c.existing.empty() ? 0.0 : c.existing[i];
      shares.push_back(c.density[i] > 0.0F ? std::clamp(std::exp(log_level) * c.density[i] - existing, low, high)
                                           : low);
    }
    return shares;
  };
  const auto sum = [](const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); };
  double below = -200.0;
  double above = 200.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (below + above);
    (sum(at_level(middle)) < budget ? below : above) = middle;
  }
  std::vector<double> shares = at_level(above);
  const auto zeros = static_cast<double>(std::count(c.density.begin(), c.density.end(), 0.0F));
  const double left = budget - sum(shares);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (c.density[i] == 0.0F) shares[i] += std::max(left, 0.0) / zeros;
  }
  return shares;
}

void check_properties(const Case& c, const std::vector<std::uint32_t>& counts) {
  REQUIRE(counts.size() == c.density.size());
  REQUIRE(total(counts) == c.params.budget);
  const std::vector<double> ideal = ideal_shares(c);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    CAPTURE(i, c.density[i], counts[i], ideal[i]);
    REQUIRE(counts[i] >= c.params.min_per_pixel);
    REQUIRE(counts[i] <= c.params.max_per_pixel);
    REQUIRE(std::abs(counts[i] - ideal[i]) < 1.0 + 1e-6);
  }
  if (!c.existing.empty()) return;
  std::vector<std::size_t> order(counts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return c.density[a] < c.density[b]; });
  std::uint32_t most = 0;  // of all pixels of lower or equal density
  for (const std::size_t i : order) {
    REQUIRE(counts[i] + 1 >= most);
    most = std::max(most, counts[i]);
  }
}

void require_error(const Case& c, stein::ErrorCode code, const std::string& part) {
  try {
    static_cast<void>(allocate(c));
    FAIL("no error");
  } catch (const stein::Error& error) {
    CAPTURE(error.what());
    CHECK(error.code() == code);
    CHECK(std::string(error.what()).find(part) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("Shares of random densities are exact in sum, bounded, ordered and within one sample of the ideal") {
  std::mt19937 random(20120611);
  for (int i = 0; i < 2000; ++i) {
    const Case c = random_case(random);
    CAPTURE(i, c.params.budget, c.params.min_per_pixel, c.params.max_per_pixel, c.density.size());
    const std::vector<std::uint32_t> counts = allocate(c);
    check_properties(c, counts);
    REQUIRE(allocate(c) == counts);
  }
}

TEST_CASE("Shares beside existing samples are exact in sum, bounded and within one sample of the ideal") {
  std::mt19937 random(20120612);
  for (int i = 0; i < 1000; ++i) {
    Case c = random_case(random);
    std::uniform_int_distribution<int> samples(0, i % 2 == 0 ? 8 : 1000);
    for (std::size_t k = 0; k < c.density.size(); ++k) c.existing.push_back(static_cast<float>(samples(random)));
    CAPTURE(i, c.params.budget, c.params.min_per_pixel, c.params.max_per_pixel, c.density.size());
    check_properties(c, allocate(c));
  }
}

TEST_CASE("Existing samples count, and none are taken back") {
  const auto beside = [](std::vector<float> existing, std::int64_t budget) {
    return allocate(Case{{1, 2, 3, 4}, 4, {.budget = budget}, std::move(existing)});
  };
  CHECK(beside({0, 0, 0, 0}, 20) == std::vector<std::uint32_t>{2, 4, 6, 8});
  CHECK(beside({1, 1, 1, 1}, 16) == std::vector<std::uint32_t>{1, 3, 5, 7});
  CHECK(beside({9, 0, 0, 0}, 18) == std::vector<std::uint32_t>{0, 4, 6, 8});
  CHECK(beside({-7, NAN, INFINITY, 0}, 20) == std::vector<std::uint32_t>{2, 4, 6, 8});
  CHECK(beside({9, 9, 9, 9}, 0) == std::vector<std::uint32_t>{0, 0, 0, 0});
}

TEST_CASE("Shares are proportional where the bounds do not matter") {
  CHECK(allocate({1, 2, 3, 4}, 20) == std::vector<std::uint32_t>{2, 4, 6, 8});
  CHECK(allocate({1e-30F, 3e-30F}, 8) == std::vector<std::uint32_t>{2, 6});
  CHECK(allocate({1e30F, 3e30F}, 8) == std::vector<std::uint32_t>{2, 6});
  // 2.25, 2.25, 4.5: the largest remainder takes the sample that is left.
  CHECK(allocate({1, 1, 2}, 9) == std::vector<std::uint32_t>{2, 2, 5});
}

TEST_CASE("Bounds move samples to the pixels that still have room") {
  CHECK(allocate({1, 1, 100}, 12, 0, 6) == std::vector<std::uint32_t>{3, 3, 6});
  CHECK(allocate({1, 100, 100}, 24, 4) == std::vector<std::uint32_t>{4, 10, 10});
  CHECK(allocate({1, 5, 100}, 24, 4, 12) == std::vector<std::uint32_t>{4, 8, 12});
  CHECK(allocate({7, 1, 3}, 9, 3, 3) == std::vector<std::uint32_t>{3, 3, 3});
  // A small density among huge ones keeps its precision once those are at the maximum.
  CHECK(allocate({1e30F, 1e-30F, 3e-30F}, 18, 0, 10) == std::vector<std::uint32_t>{10, 2, 6});
}

TEST_CASE("Ties go to the lower pixel index") {
  CHECK(allocate({1, 1, 1, 1}, 6) == std::vector<std::uint32_t>{2, 2, 1, 1});
  CHECK(allocate({0, 0, 0}, 5) == std::vector<std::uint32_t>{2, 2, 1});
}

TEST_CASE("A density of zero gets the minimum, and the rest once the others are full") {
  CHECK(allocate({0, 0, 0, 0}, 8) == std::vector<std::uint32_t>{2, 2, 2, 2});
  CHECK(allocate({0, 5, 0, 5}, 8) == std::vector<std::uint32_t>{0, 4, 0, 4});
  CHECK(allocate({0, 5, 0, 5}, 20, 1, 6) == std::vector<std::uint32_t>{4, 6, 4, 6});
  CHECK(allocate({0, 0, 0}, 6'000'000'001) == std::vector<std::uint32_t>{2'000'000'001, 2'000'000'000, 2'000'000'000});
  CHECK(allocate({-3, 5, -0.0F, 5}, 8) == std::vector<std::uint32_t>{0, 4, 0, 4});
}

TEST_CASE("One pixel takes the whole budget, also beyond 32 bits in all") {
  CHECK(allocate({0}, 0) == std::vector<std::uint32_t>{0});
  CHECK(allocate({0.5F}, 7) == std::vector<std::uint32_t>{7});
  CHECK(allocate({0.5F}, UINT32_MAX) == std::vector<std::uint32_t>{UINT32_MAX});
  const std::vector<std::uint32_t> full = allocate(std::vector<float>(1000, 2.0F), 1000 * std::int64_t{UINT32_MAX});
  CHECK(std::count(full.begin(), full.end(), UINT32_MAX) == 1000);
}

TEST_CASE("Sums stay exact at budgets beyond the precision of double") {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> exponent(-3.0F, 3.0F);
  std::vector<float> density(200000);
  for (float& s : density) s = std::pow(10.0F, exponent(random));
  for (const std::int64_t budget : {std::int64_t{400'000'000'000'003}, std::int64_t{858'993'459'000'000 - 1}}) {
    const std::vector<std::uint32_t> counts = allocate(density, budget, 3);
    CHECK(total(counts) == budget);
    CHECK(*std::min_element(counts.begin(), counts.end()) >= 3);
  }
}

TEST_CASE("A density with strides is read in row order") {
  const std::vector<float> density = {1, 9, 2, 9, 3, 9, 4, 9};
  const stein::ConstPlaneView flipped(density.data() + 4, 2, 2, 8, -16);
  CHECK(stein::allocate_samples(flipped, {.budget = 10}) == std::vector<std::uint32_t>{3, 4, 1, 2});
}

TEST_CASE("Arguments that cannot be met are refused with the reason") {
  using stein::ErrorCode;
  const std::vector<float> two = {1, 2};
  require_error({two, 2, {-1, 0, 5}}, ErrorCode::kInvalidArgument, "budget is -1");
  require_error({two, 2, {5, 3, 9}}, ErrorCode::kInvalidArgument, "lower the minimum or raise the budget");
  require_error({two, 2, {11, 0, 5}}, ErrorCode::kInvalidArgument, "raise the maximum or lower the budget");
  require_error({two, 2, {4, 3, 2}}, ErrorCode::kInvalidArgument, "the minimum must not be above the maximum");
  require_error({{1, 2, 3, NAN}, 2, {4, 0, 9}}, ErrorCode::kInvalidFrame, "nan at pixel (1, 1)");
  require_error({{1, 2, -INFINITY, 4}, 2, {4, 0, 9}}, ErrorCode::kInvalidFrame, "-inf at pixel (0, 1)");
  CHECK_THROWS_AS(stein::allocate_samples({}, {.budget = 1}), stein::Error);
  CHECK_THROWS_AS(stein::allocate_samples({two.data(), 2, 1}, {.budget = 1}, {two.data(), 1, 2}), stein::Error);
}
