// SPDX-License-Identifier: Apache-2.0
//
// What one run says of its own noise against how 256 runs differ.
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "accumulate/samples.hpp"
#include "catch.hpp"

namespace stein::test {
namespace {

constexpr std::size_t kSeeds = 256;
constexpr int kSamples = 128;

/// Covariance of two series and the variance of that estimate, from the spread of the products.
struct Estimated {
  double covariance = 0;
  double variance = 0;
};

template <class Values>
Estimated covariance(const std::vector<Values>& series, std::size_t a, std::size_t b) {
  const auto n = static_cast<double>(series.size());
  double mean_a = 0;
  double mean_b = 0;
  for (const Values& v : series) {
    mean_a += static_cast<double>(v[a]) / n;
    mean_b += static_cast<double>(v[b]) / n;
  }
  double sum = 0;
  double squares = 0;
  for (const Values& v : series) {
    const double product = (static_cast<double>(v[a]) - mean_a) * (static_cast<double>(v[b]) - mean_b);
    sum += product;
    squares += product * product;
  }
  return {sum / (n - 1), (squares / n - sum * sum / (n * n)) / n};
}

struct Runs {
  std::vector<std::vector<double>> moments;  // of each seed
  std::vector<Sample> samples;               // of the first seed
};

Runs run_all_seeds(int pixel) {
  Runs runs;
  for (std::size_t seed = 0; seed < kSeeds; ++seed) {
    // Far apart: neighbouring seeds of this generator give one sequence, shifted.
    Random random(1'000'000 * static_cast<std::uint64_t>(pixel + 1) + 1000 * seed);
    Accumulator film(1, 1, usual_layout());
    for (int i = 0; i < kSamples; ++i) {
      const Sample sample = draw_sample(random, 0.1 + 0.25 * pixel);
      film.add(0, 0, sample.data());
      if (seed == 0) runs.samples.push_back(sample);
    }
    runs.moments.push_back(pixel_of(film.moments().frame()));
  }
  return runs;
}

}  // namespace

TEST_CASE("accumulator: the noise that one run predicts is how runs differ") {
  const int pixel = GENERATE(0, 1, 2, 3);
  const Runs runs = run_all_seeds(pixel);
  const auto pairs = moment_channels();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i];
    const Estimated spread = covariance(runs.moments, a, b);
    const double of_one_run = covariance(runs.samples, a, b).variance / (kSamples * kSamples);
    const double predicted = runs.moments[0][kChannels + i];
    double mean = 0;
    for (const auto& run : runs.moments) mean += run[kChannels + i] / kSeeds;
    INFO("pixel " << pixel << ", channels " << a << " and " << b << ": " << predicted << " predicted, " << mean
                  << " by all runs, " << spread.covariance << " found");
    CHECK(std::abs(predicted - spread.covariance) <= 4 * std::sqrt(spread.variance + of_one_run) + 1e-12);
    CHECK(std::abs(mean - spread.covariance) <= 4 * std::sqrt(spread.variance + of_one_run / kSeeds) + 1e-12);
  }
}

}  // namespace stein::test
