// SPDX-License-Identifier: Apache-2.0
#include "stein/accumulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "accumulate/samples.hpp"
#include "catch.hpp"
#include "stein/error.hpp"

namespace stein::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<Sample> draw_samples(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Sample> samples(count);
  for (Sample& sample : samples) sample = draw_sample(random, 0.3);
  return samples;
}

/// Means, then variances and covariances of the means, in two passes.
std::vector<double> two_passes(const std::vector<Sample>& samples) {
  const auto n = static_cast<double>(samples.size());
  std::vector<double> values(kChannels, 0.0);
  for (const Sample& sample : samples) {
    for (std::size_t k = 0; k < kChannels; ++k) values[k] += static_cast<double>(sample[k]) / n;
  }
  for (const auto& [a, b] : moment_channels()) {
    double sum = 0;
    for (const Sample& sample : samples) {
      sum += (static_cast<double>(sample[a]) - values[a]) * (static_cast<double>(sample[b]) - values[b]);
    }
    values.push_back(sum / (n * (n - 1)));
  }
  return values;
}

/// Covariances relative to what they could be at most.
void check_equal(const std::vector<double>& found, const std::vector<double>& expected, double tolerance) {
  REQUIRE(found.size() == expected.size());
  const auto pairs = moment_channels();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double scale =
        i < kChannels
            ? std::abs(expected[i])
            : std::sqrt(expected[kChannels + pairs[i - kChannels][0]] * expected[kChannels + pairs[i - kChannels][1]]);
    INFO("moment " << i << ": " << found[i] << " instead of " << expected[i]);
    CHECK(std::abs(found[i] - expected[i]) <= tolerance * scale);
  }
}

Accumulator accumulate(const std::vector<Sample>& samples, std::size_t first, std::size_t end) {
  Accumulator film(1, 1, usual_layout());
  for (std::size_t i = first; i < end; ++i) CHECK(film.add(0, 0, samples[i].data()));
  return film;
}

template <class Work>
void expect_refusal(const std::string& word, Work&& work) {
  try {
    work();
    FAIL("no error was thrown");
  } catch (const stein::Error& error) {
    CHECK(error.code() == ErrorCode::kInvalidArgument);
    INFO(error.what());
    CHECK(std::string(error.what()).find(word) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("accumulator: moments are those of two passes") {
  const std::size_t count = GENERATE(2U, 3U, 16U, 1000U);
  const std::vector<Sample> samples = draw_samples(count, 11 + count);
  const Moments moments = accumulate(samples, 0, count).moments();
  check_equal(pixel_of(moments.frame()), two_passes(samples), 2e-7);  // what a float can hold
  CHECK(at(moments.frame().sample_count) == static_cast<double>(count));
  CHECK(moments.frame().degrees_of_freedom == 0);
  CHECK_NOTHROW(stein::check_strict(moments.frame()));
}

TEST_CASE("accumulator: the order of merging is rounding") {
  const std::vector<Sample> samples = draw_samples(5000, 3);
  const std::vector<std::size_t> ends = {0, 1, 3, 900, 901, 4000, 4000, 5000};
  std::vector<Accumulator> parts;
  for (std::size_t i = 1; i < ends.size(); ++i) parts.push_back(accumulate(samples, ends[i - 1], ends[i]));
  std::vector<std::size_t> order(parts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const Accumulator whole = accumulate(samples, 0, samples.size());
  Random random(1);
  for (int shuffle = 0; shuffle < 20; ++shuffle) {
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    Accumulator left(1, 1, usual_layout());
    Accumulator right(1, 1, usual_layout());
    for (std::size_t i = 0; i < order.size(); ++i) (i % 3 == 0 ? left : right).merge(parts[order[i]]);
    right.merge(left.state());  // as from another process
    REQUIRE(right.state().size() == whole.state().size());
    for (std::size_t i = 0; i < whole.state().size(); ++i)
      CHECK(right.state()[i] == Approx(whole.state()[i]).epsilon(1e-11).margin(1e-11));
  }
}

TEST_CASE("accumulator: a million samples around a million") {
  // Multiples of 1/16, the spacing of floats there: the sums of the two passes are exact.
  constexpr int kSamples = 1'000'000;
  constexpr double kBase = 1e6;
  Accumulator film(1, 1, {});
  Accumulator late(1, 1, {});
  Random random(5);
  std::array<double, 2> sum{};
  std::array<double, 3> products{};
  for (int i = 0; i < kSamples; ++i) {
    const double a = std::floor(random.uniform() * 64) / 16;
    const double b = a + std::floor(random.uniform() * 16) / 16;
    const float sample[3] = {static_cast<float>(kBase + a), static_cast<float>(kBase + b), static_cast<float>(-kBase)};
    (i % 3 == 0 ? film : late).add(0, 0, sample);
    sum[0] += a;
    sum[1] += b;
    products[0] += a * a;
    products[1] += b * b;
    products[2] += a * b;
  }
  film.merge(late);
  const Moments moments = film.moments();
  const double n = kSamples;
  const double scale = n * (n - 1);
  CHECK(at(moments.frame().colour[0]) == Approx(kBase + sum[0] / n).epsilon(1e-7));
  CHECK(at(moments.frame().colour_variance[0]) == Approx((products[0] - sum[0] * sum[0] / n) / scale).epsilon(1e-6));
  CHECK(at(moments.frame().colour_variance[1]) == Approx((products[1] - sum[1] * sum[1] / n) / scale).epsilon(1e-6));
  CHECK(at(moments.frame().colour_variance[2]) == 0);
  CHECK(at(moments.frame().colour_covariance[0]) == Approx((products[2] - sum[0] * sum[1] / n) / scale).epsilon(1e-6));
  CHECK(at(moments.frame().colour_covariance[1]) == 0);
}

TEST_CASE("accumulator: a bad colour costs the sample, a bad feature only itself") {
  Accumulator film(2, 1, {.features = {{"albedo", 3}, {"depth", 1}}, .halves = true});
  Accumulator expected(2, 1, film.layout());
  const Sample good = {1, 2, 3, 0.1F, 0.2F, 0.3F, 4};
  const Sample next = {3, 1, 2, 0.2F, 0.2F, 0.2F, 5};
  for (std::size_t c = 0; c < 3; ++c) {
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
      Sample sample = good;
      sample[c] = bad;
      CHECK_FALSE(film.add(1, 0, sample.data()));
    }
  }
  CHECK(film.rejected() == 9);
  CHECK(film.add(1, 0, good.data()));
  CHECK(film.add(1, 0, std::array{3.0F, 1.0F, 2.0F, 0.2F, kNan, 0.2F, 5.0F}.data()));
  CHECK(film.add(1, 0, std::array{3.0F, 1.0F, 2.0F, 0.2F, 0.2F, 0.2F, kInfinity}.data()));
  CHECK(film.rejected() == 9);
  CHECK(film.repaired() == 2);
  expected.add(1, 0, good.data());
  expected.add(1, 0, std::array{next[0], next[1], next[2], 0.0F, 0.0F, 0.0F, next[6]}.data());
  expected.add(1, 0, std::array{next[0], next[1], next[2], next[3], next[4], next[5], 0.0F}.data());
  CHECK(pixel_of(film.moments().frame(), 1) == pixel_of(expected.moments().frame(), 1));
  CHECK(at(film.moments().half(1)[0], 1) == 3);

  film.merge(film);
  CHECK(film.rejected() == 18);
  CHECK(film.repaired() == 4);
}

TEST_CASE("accumulator: halves take turns") {
  stein::SampleLayout layout = usual_layout();
  layout.halves = true;
  const std::vector<Sample> samples = draw_samples(9, 2);
  Accumulator film(1, 1, layout);
  Accumulator other(1, 1, layout);
  for (std::size_t i = 0; i < 9; ++i) (i < 5 ? film : other).add(0, 0, samples[i].data());
  film.merge(other);
  std::array<double, 2> sum{};
  for (std::size_t i = 0; i < 9; ++i) sum[(i < 5 ? i : i - 5) % 2] += static_cast<double>(samples[i][1]);
  Moments moments = film.moments();
  CHECK(at(moments.half(0)[1]) == Approx(sum[0] / 5).epsilon(1e-6));
  CHECK(at(moments.half(1)[1]) == Approx(sum[1] / 4).epsilon(1e-6));
  const Moments moved = std::move(moments);
  CHECK(at(moved.half(1)[1]) == Approx(sum[1] / 4).epsilon(1e-6));
  CHECK_FALSE(accumulate(samples, 0, 9).moments().half(0)[0]);
}

TEST_CASE("accumulator: pixels without samples, and with one") {
  Accumulator film(3, 2, {.features = {{"depth", 1}}, .covariances = false});
  const float sample[4] = {1, 2, 3, 4};
  film.add(2, 1, sample);
  const Moments moments = film.moments();
  CHECK(at(moments.frame().sample_count, 1, 1) == 0);
  CHECK(at(moments.frame().sample_count, 2, 1) == 1);
  CHECK(at(moments.frame().colour[2], 2, 1) == 3);
  CHECK(at(moments.frame().colour_variance[2], 2, 1) == 0);
  CHECK_FALSE(moments.frame().colour_covariance[0]);
  CHECK(moments.frame().features[0].colour_covariance.empty());
  CHECK(stein::inspect(moments.frame()).invalid_pixels == 5);
}

TEST_CASE("accumulator: what does not fit is refused") {
  Accumulator film(2, 2, usual_layout());
  expect_refusal("0x2", [] { Accumulator(0, 2, {}); });
  expect_refusal("1048577", [] { Accumulator(2, 1048577, {}); });
  expect_refusal("no name", [] { Accumulator(2, 2, {.features = {{"", 1}}}); });
  expect_refusal("albedo", [] { Accumulator(2, 2, {.features = {{"albedo", 3}, {"albedo", 1}}}); });
  expect_refusal("5 channels", [] { Accumulator(2, 2, {.features = {{"albedo", 5}}}); });
  expect_refusal("2x1", [&] { film.merge(Accumulator(2, 1, usual_layout())); });
  expect_refusal("2x2x3", [&] { film.merge(Accumulator(2, 2, {})); });
  const std::vector<double> state(7);
  expect_refusal("7 values", [&] { film.merge(state); });
}

TEST_CASE("accumulator: records of another process that cannot be used are refused and counted") {
  const stein::SampleLayout layout;
  Accumulator good(2, 1, layout);
  Accumulator bad(2, 1, layout);
  const std::array<float, 3> sample = {1, 2, 3};
  for (Accumulator* film : {&good, &bad}) {
    for (int x = 0; x < 2; ++x) {
      film->add(x, 0, sample.data());
      film->add(x, 0, sample.data());
    }
  }
  std::vector<double> state(bad.state().begin(), bad.state().end());
  const std::size_t field = GENERATE(0U, 1U, 4U);  // observations, samples, mean of R
  state[field] = GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
  good.merge(state);
  CHECK(good.rejected() == 1);
  const stein::Moments moments = good.moments();
  CHECK(moments.frame().sample_count.at(0, 0) == 2);
  CHECK(moments.frame().sample_count.at(1, 0) == 4);
  CHECK(moments.frame().colour[0].at(0, 0) == 1);
}

TEST_CASE("accumulator: threads share it where their pixels differ") {
  const std::vector<Sample> samples = draw_samples(400, 9);
  const auto fill = [&](Accumulator& film, int first, int step) {
    for (int x = first; x < film.width(); x += step) {
      for (std::size_t i = 0; i < samples.size(); ++i)
        film.add(x, 0, samples[(i + static_cast<std::size_t>(x)) % samples.size()].data());
    }
  };
  Accumulator shared(16, 1, usual_layout());
  Accumulator alone(16, 1, usual_layout());
  fill(alone, 0, 1);
  std::thread even([&] { fill(shared, 0, 2); });
  std::thread odd([&] { fill(shared, 1, 2); });
  even.join();
  odd.join();
  CHECK(std::equal(shared.state().begin(), shared.state().end(), alone.state().begin()));
}

}  // namespace stein::test
