// SPDX-License-Identifier: Apache-2.0
//
// Many samples as one observation, and moments that were taken elsewhere.
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "accumulate/samples.hpp"
#include "catch.hpp"

namespace stein::test {
namespace {

std::vector<float> as_floats(const std::vector<double>& values) { return {values.begin(), values.end()}; }

}  // namespace

TEST_CASE("estimates: the variance comes from how weighted means differ") {
  const std::vector<double> samples = {4, 1, 16, 2.5};
  Random random(4);
  std::vector<Sample> means(samples.size());
  Accumulator film(1, 1, usual_layout());
  double total = 0;
  std::vector<double> expected(kChannels, 0.0);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    means[k] = draw_sample(random, 0.5);
    CHECK(film.add(0, 0, Estimate{.samples = samples[k], .mean = means[k].data()}));
    total += samples[k];
    for (std::size_t i = 0; i < kChannels; ++i) expected[i] += samples[k] * static_cast<double>(means[k][i]);
  }
  for (double& mean : expected) mean /= total;
  for (const auto& [a, b] : moment_channels()) {
    double sum = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      sum += samples[k] * (static_cast<double>(means[k][a]) - expected[a]) *
             (static_cast<double>(means[k][b]) - expected[b]);
    }
    expected.push_back(sum / (3 * total));
  }
  const Moments moments = film.moments();
  const std::vector<double> found = pixel_of(moments.frame());
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(found[i] == Approx(expected[i]).epsilon(1e-5).margin(1e-7));
  CHECK(at(moments.frame().sample_count) == Approx(total));
  CHECK(moments.frame().degrees_of_freedom == 3);
}

TEST_CASE("estimates: pooled moments are those of all samples") {
  Random random(8);
  Accumulator whole(1, 1, usual_layout());
  Accumulator pooled(1, 1, usual_layout());
  for (const int count : {2, 1, 30, 9}) {
    Accumulator part(1, 1, usual_layout());
    for (int i = 0; i < count; ++i) {
      const Sample sample = draw_sample(random, 0.4);
      part.add(0, 0, sample.data());
      whole.add(0, 0, sample.data());
    }
    const std::vector<float> values = as_floats(pixel_of(part.moments().frame()));
    CHECK(pooled.add(0, 0, Estimate{static_cast<double>(count), values.data(), values.data() + kChannels}));
  }
  const Moments moments = pooled.moments();
  const std::vector<double> found = pixel_of(moments.frame());
  const std::vector<double> expected = pixel_of(whole.moments().frame());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == Approx(expected[i]).epsilon(1e-5).margin(1e-7));
  CHECK(moments.frame().degrees_of_freedom == 0);
}

TEST_CASE("estimates: variances of few degrees of freedom stay so") {
  std::vector<float> values(kChannels + moment_channels().size(), 0.25F);
  Accumulator film(1, 1, usual_layout());
  const Estimate estimate{
      .samples = 40, .mean = values.data(), .moments = values.data() + kChannels, .degrees_of_freedom = 3};
  film.add(0, 0, estimate);
  CHECK(film.moments().frame().degrees_of_freedom == 3);
  CHECK(at(film.moments().frame().colour_variance[1]) == Approx(0.25));
  film.add(0, 0, estimate);  // the same mean: twice the samples, half the variance
  CHECK(film.moments().frame().degrees_of_freedom == 7);
  CHECK(at(film.moments().frame().colour_variance[1]) == Approx(0.25 / 2 * 6 / 7));
}

TEST_CASE("estimates: of less than one sample") {
  Accumulator film(1, 1, {});
  const std::array<float, 3> mean = {1, 2, 3};
  const std::array<float, 6> moments = {};
  CHECK(film.add(0, 0, {.samples = 0.5, .mean = mean.data(), .moments = moments.data()}));
  CHECK(film.moments().frame().sample_count.at(0, 0) == 0.5F);
}

TEST_CASE("estimates: what cannot be used is refused or repaired") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> values(kChannels + moment_channels().size(), 0.25F);
  Accumulator film(1, 1, usual_layout());
  const auto add = [&](std::size_t bad, float value, double samples = 4) {
    std::vector<float> changed = values;
    changed[bad] = value;
    return film.add(0, 0, Estimate{samples, changed.data(), changed.data() + kChannels});
  };
  CHECK_FALSE(add(1, kNan));                  // mean G
  CHECK_FALSE(add(kChannels + 2, -1));        // variance B
  CHECK_FALSE(add(2 * kChannels + 1, kNan));  // covariance R.B
  CHECK_FALSE(add(0, 1, 0));
  CHECK_FALSE(add(0, 1, -2));
  CHECK_FALSE(add(0, 1, std::numeric_limits<double>::quiet_NaN()));
  CHECK(film.rejected() == 6);
  CHECK(film.repaired() == 0);
  CHECK(add(6, kNan));                       // mean depth
  CHECK(add(kChannels + 6, -1));             // its variance
  CHECK(add(2 * kChannels + 3 + 3, kNan));   // its covariance with R
  CHECK(add(2 * kChannels + 3 + 11, kNan));  // with B
  CHECK(film.rejected() == 6);
  CHECK(film.repaired() == 4);
  const Moments moments = film.moments();
  CHECK(at(moments.frame().features[1].mean[0]) == 0);
  CHECK(at(moments.frame().features[1].variance[0]) == 0);
  CHECK(at(moments.frame().features[0].mean[0]) == 0.25);
  CHECK(at(moments.frame().features[0].variance[0]) == Approx(0.25 * 4 * 3 * 4 / (16 * 15)));
}

}  // namespace stein::test
