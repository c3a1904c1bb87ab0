// SPDX-License-Identifier: Apache-2.0
//
// The quantities of RPF section 4 on sample sets made by hand.
#include "rpf/dependencies.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "support/synthetic.hpp"

namespace {

using stein::rpf::Dependencies;
using stein::rpf::DependencyMeter;
using stein::rpf::FilterWeights;
using stein::rpf::RecordLayout;
using stein::test::Random;

/// Two features, two random parameters.
RecordLayout small_layout() {
  RecordLayout layout;
  layout.features = 2;
  layout.randoms = 2;
  layout.stride = 12;
  return layout;
}

enum Column : std::size_t { kTexture, kOther, kRed, kGreen, kBlue, kX, kY, kLens, kTime, kColumns };

using Columns = std::vector<std::vector<float>>;

/// Everything independent.
Columns independent(int samples, std::uint64_t seed) {
  Columns columns(kColumns);
  Random random(seed);
  for (auto& column : columns) {
    for (int i = 0; i < samples; ++i) column.push_back(static_cast<float>(random.uniform()));
  }
  return columns;
}

double deviation(const std::vector<float>& x) {
  double mean = 0;
  double square = 0;
  for (const float v : x) mean += v / static_cast<double>(x.size());
  for (const float v : x) square += (v - mean) * (v - mean) / static_cast<double>(x.size());
  return std::sqrt(square);
}

/// Sec. 4.4.3 as it is written, in double.
double information(const std::vector<float>& x, const std::vector<float>& y) {
  const auto bin = [](const std::vector<float>& v, std::size_t i) {
    const double d = deviation(v);
    return d > 0 ? static_cast<int>((v[i] - *std::min_element(v.begin(), v.end())) / d + 0.5) : 0;
  };
  std::map<int, double> px;
  std::map<int, double> py;
  std::map<std::pair<int, int>, double> pxy;
  const double part = 1.0 / static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    px[bin(x, i)] += part;
    py[bin(y, i)] += part;
    pxy[{bin(x, i), bin(y, i)}] += part;
  }
  double sum = 0;
  for (const auto& [key, p] : pxy) sum += p * std::log(p / (px[key.first] * py[key.second]));
  return sum;
}

Dependencies measure(const Columns& columns, float floor = 0) {
  const RecordLayout layout = small_layout();
  const int count = static_cast<int>(columns.front().size());
  const std::ptrdiff_t pitch = (count + 63) / 64 * 64;
  stein::exec::FloatBuffer planes;
  planes.reserve(static_cast<std::size_t>(pitch) * kColumns + 16);
  std::vector<stein::kernels::PlaneMoments> moments;
  for (std::size_t k = 0; k < kColumns; ++k) {
    float* plane = planes.data() + static_cast<std::ptrdiff_t>(k) * pitch;
    std::fill(plane, plane + pitch, columns[k].front());
    std::copy(columns[k].begin(), columns[k].end(), plane);
    moments.push_back(stein::kernels::sample_moments(plane, count));
  }
  DependencyMeter meter(layout, floor);
  return meter.measure({planes.data(), pitch, count}, moments.data());
}

FilterWeights weights_of(const Dependencies& dependencies, float growth = 0) {
  FilterWeights weights;
  stein::rpf::weigh(dependencies, growth, weights);
  return weights;
}

}  // namespace

TEST_CASE("mutual information is that of the paper's histograms, for any number of samples") {
  for (const int count : {1, 2, 15, 64, 65, 200, 484, 1000}) {
    Columns columns = independent(count, 3);
    for (std::size_t i = 0; i < columns[kRed].size(); ++i) {
      columns[kRed][i] = std::sin(5.0F * columns[kLens][i]) + 0.3F * columns[kX][i];
      columns[kTexture][i] = columns[kY][i] > 0.5F ? 40.0F : -3.0F * columns[kRed][i];
    }
    const Dependencies d = measure(columns);
    INFO(count << " samples");
    const double random = information(columns[kRed], columns[kLens]) + information(columns[kRed], columns[kTime]);
    const double position = information(columns[kTexture], columns[kX]) + information(columns[kTexture], columns[kY]);
    double feature = 0;
    for (const std::size_t c : {kRed, kGreen, kBlue}) feature += information(columns[c], columns[kTexture]);
    CHECK(d.colour_random[0] == Approx(random).margin(2e-5));
    CHECK(d.feature_position[0] == Approx(position).margin(2e-5));
    CHECK(d.colour_on_feature[0] == Approx(feature).margin(2e-5));
  }
}

TEST_CASE("identical vectors share all of their entropy") {
  Columns columns = independent(400, 5);
  for (std::size_t i = 0; i < 400; ++i)
    columns[kTexture][i] = i % 4 < 2 ? 0.0F : 1.0F;  // two bins apart by 2 deviations
  columns[kLens] = columns[kTexture];
  std::fill(columns[kTime].begin(), columns[kTime].end(), 3.0F);  // a constant tells nothing
  CHECK(measure(columns).feature_random[0] == Approx(std::log(2.0)).margin(1e-5));
}

TEST_CASE("independent vectors share what chance makes of so many bins, and nothing once that is taken off") {
  double plain = 0;
  double corrected = 0;
  constexpr int kSets = 40;
  for (int set = 0; set < kSets; ++set) {
    const Columns columns = independent(400, static_cast<std::uint64_t>(set) + 100);
    plain += measure(columns).colour_random[0] / kSets;
    corrected += measure(columns, 1).colour_random[0] / kSets;
  }
  // Uniform vectors have 4 to 5 bins: 2 pairs with 9 to 16 degrees of freedom each.
  CHECK(plain > 2 * 9 / 800.0 * 0.7);
  CHECK(plain < 2 * 16 / 800.0 * 1.3);
  CHECK(corrected < 0.35 * plain);  // what is left is cut off at 0
}

TEST_CASE("a colour that depends on the lens alone is found to, and is ignored by the filter") {
  Columns columns = independent(484, 9);
  for (const std::size_t c : {kRed, kGreen, kBlue}) {
    for (std::size_t i = 0; i < 484; ++i) columns[c][i] = std::cos(6.0F * columns[kLens][i]);  // without correlation
  }
  const Dependencies d = measure(columns, 1);
  CHECK(d.colour_random[0] > 0.5F);
  CHECK(d.colour_position[0] < 0.05F);
  const FilterWeights weights = weights_of(d);
  CHECK(weights.alpha[0] < 0.1F);
  CHECK(weights.colour_random > 0.9F);
}

TEST_CASE("a colour that depends on a feature alone depends on no random parameter") {
  Columns columns = independent(484, 11);
  for (std::size_t i = 0; i < 484; ++i) columns[kTexture][i] = columns[kX][i] > 0.5F ? 1.0F : 0.0F;
  for (const std::size_t c : {kRed, kGreen, kBlue}) columns[c] = columns[kTexture];
  const Dependencies d = measure(columns, 1);
  CHECK(d.colour_random[0] < 0.02F);
  CHECK(d.colour_position[0] > 0.3F);
  const FilterWeights weights = weights_of(d);
  CHECK(weights.alpha[0] > 0.9F);                             // the colour is scene detail
  CHECK(weights.beta[kTexture] > 10 * weights.beta[kOther]);  // the other feature does not make the colour
}

TEST_CASE("alpha and beta at their extremes") {
  Dependencies d;
  d.feature_random = {0, 2};
  d.feature_position = {1, 0};
  d.colour_on_feature = {3, 0};
  d.colour_feature = 3;
  SECTION("all of the colour from the position") {
    d.colour_position = {1, 1, 1};
    const FilterWeights w = weights_of(d);
    CHECK(w.alpha[0] == Approx(1));
    CHECK(w.colour_random == Approx(0).margin(1e-6));
    CHECK(w.beta[0] == Approx(0.5));  // W_cf = 3 / (0 + 3 + 3), W_fr = 0
    CHECK(w.beta[1] == 0);
  }
  SECTION("all of the colour from random parameters") {
    d.colour_random = {1, 1, 1};
    const FilterWeights w = weights_of(d);
    CHECK(w.alpha[0] == Approx(0).margin(1e-6));
    CHECK(w.colour_random == Approx(1));
  }
  SECTION("half of each, and more of it in later passes") {
    d.colour_random = {1, 1, 1};
    d.colour_position = {1, 1, 1};
    CHECK(weights_of(d).alpha[1] == Approx(0.5));
    CHECK(weights_of(d, 0.3F).alpha[1] == Approx(0.35));
    CHECK(weights_of(d, 2.0F).alpha[1] == 0);  // never below
  }
  SECTION("nothing depends on anything") {
    d = {};
    d.feature_random = d.feature_position = d.colour_on_feature = {0};
    const FilterWeights w = weights_of(d);
    CHECK(w.alpha[0] == 1);
    CHECK(w.beta[0] == 0);
  }
}
