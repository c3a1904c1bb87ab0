// SPDX-License-Identifier: Apache-2.0
#include "filters/atrous.hpp"

#include <hwy/targets.h>

#include <array>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "support/atrous_reference.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

using DoublePlanes = std::array<std::vector<double>, 3>;

double deviation(const BankResult& bank, std::size_t candidate, const DoublePlanes& expected, const Frame& frame) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const double e = expected[c][pixel_index(frame.width, x, y)];
        const double error = std::abs(bank.result[candidate][c].row(y)[x] - e) / (1.0 + std::abs(e));
        if (!(error <= largest)) largest = error;  // NaN is the largest of all
      }
    }
  }
  return largest;
}

// Largest deviation from the plain reference, relative to the size of the values involved.
double deviation(const AtrousSureParams& params, const FilterSpec& spec, const Frame& frame) {
  const Source source(frame, inspect(frame));
  const std::vector<AtrousLevel> levels = atrous_reference(params, source);
  const BankResult bank = run_filter(spec, frame, {32, 16});
  const double first = deviation(bank, 0, atrous_result(params, levels), frame);
  if (bank.result.size() == 1) return first;
  const double second = deviation(bank, 1, levels.back().colour, frame);
  return first <= second ? second : first;
}

double deviation(const AtrousSureParams& params, const Frame& frame) { return deviation(params, params, frame); }

AtrousSureParams with_weight(float weight) {
  AtrousSureParams params;
  params.fixed_weight = weight;
  return params;
}

// A value that shrinks in part where fill_random puts little but noise.
AtrousSureParams lenient() {
  AtrousSureParams params;
  params.noise_margin = 1.0F;
  return params;
}

std::vector<AtrousSureParams> variants() {
  std::vector<AtrousSureParams> all = {{}, lenient(), with_weight(0.4F)};
  all.push_back(lenient());
  all.back().value_sigma = 0.0F;
  all.push_back(lenient());
  all.back().levels = 2;
  all.push_back(lenient());
  all.back().plain = true;
  return all;
}

void fill(OwnedFrame& frame, const std::string& name, float value) {
  for (int y = 0; y < frame.frame().height; ++y) std::fill_n(frame.plane(name).row(y), frame.frame().width, value);
}

// A flat image with white noise of variance 0.01 in each channel, and features that say nothing.
void fill_flat(OwnedFrame& frame, Random& random) {
  for (const char* c : {"R", "G", "B"}) {
    for (int y = 0; y < frame.frame().height; ++y) {
      for (int x = 0; x < frame.frame().width; ++x) {
        frame.at(c, x, y) = static_cast<float>(0.5 + 0.1 * random.normal());
      }
    }
  }
}

}  // namespace

TEST_CASE("atrous: equals the plain double reference for all sizes from 1 to 40") {
  for (int size = 1; size <= 40; ++size) {
    OwnedFrame frame(size, 41 - size, kUsualFeatures);
    fill_random(frame, static_cast<std::uint64_t>(size));
    INFO("width " << size);
    CHECK(deviation({}, frame.frame()) < 1e-5);
    CHECK(deviation(lenient(), frame.frame()) < 1e-5);
  }
}

TEST_CASE("atrous: equals the reference for any set of features and parameters, also where a level reaches far") {
  const std::vector<std::vector<FeatureShape>> sets = {{},
                                                       kUsualFeatures,
                                                       {{"depth", 1}},
                                                       {{"normal", 3}, {"position", 3}},
                                                       {{"a", 1}, {"b", 2}, {"c", 3}, {"d", 4}, {"e", 1}}};
  for (const auto& features : sets) {
    OwnedFrame frame(75, 71, features);
    fill_random(frame, 7);
    for (const AtrousSureParams& params : variants()) CHECK(deviation(params, frame.frame()) < 1e-5);
  }
}

TEST_CASE("atrous: invalid pixels have no weight and are filled, bad features drop out of the distance") {
  OwnedFrame frame(45, 41, kUsualFeatures);
  fill_random(frame, 3);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.at("R", 5, 5) = nan;
  frame.at("variance.B", 12, 7) = -1.0F;
  frame.at("G", 0, 40) = std::numeric_limits<float>::infinity();
  for (int y = 14; y < 24; ++y) {
    for (int x = 20; x < 30; ++x) frame.at("sampleCount", x, y) = 0.0F;  // wider than the finest levels reach
  }
  frame.at("albedo.variance.G", 9, 9) = nan;
  frame.at("depth.Z", 35, 4) = -std::numeric_limits<float>::infinity();
  for (const AtrousSureParams& params : variants()) CHECK(deviation(params, frame.frame()) < 1e-5);
}

TEST_CASE("atrous: all instruction sets of this machine agree with the reference") {
  OwnedFrame frame(45, 43, kUsualFeatures);
  fill_random(frame, 13);
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    const double result = deviation(lenient(), frame.frame());
    hwy::SetSupportedTargetsForTest(0);
    INFO(hwy::TargetName(targets & -targets));
    CHECK(result < 1e-5);
  }
}

TEST_CASE("atrous: the plain filter keeps no detail, and all of it gives the input back") {
  OwnedFrame frame(70, 66, kUsualFeatures);
  fill_random(frame, 9);
  CHECK(deviation(with_weight(0.0F), AtrousParams{}, frame.frame()) < 1e-5);
  const BankResult all = run_filter(with_weight(1.0F), frame.frame());
  for (int y = 0; y < 66; ++y) {
    for (int x = 0; x < 70; ++x) CHECK(all.result[0][1].row(y)[x] == Approx(frame.at("G", x, y)).margin(1e-6));
  }
}

TEST_CASE("atrous: the picture without details is a second candidate where it is wanted") {
  OwnedFrame frame(70, 66, kUsualFeatures);
  fill_random(frame, 11);
  AtrousSureParams with_plain = lenient();
  with_plain.plain = true;
  const BankResult both = run_filter(with_plain, frame.frame());
  REQUIRE(both.result.size() == 2);
  const BankResult plain = run_filter(AtrousParams{}, frame.frame());
  const BankResult shrunk = run_filter(lenient(), frame.frame());
  REQUIRE(shrunk.result.size() == 1);
  double difference = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 66; ++y) {
      for (int x = 0; x < 70; ++x) {
        CHECK(both.result[1][c].row(y)[x] == plain.result[0][c].row(y)[x]);
        CHECK(both.result[0][c].row(y)[x] == shrunk.result[0][c].row(y)[x]);
        difference += std::abs(both.result[0][c].row(y)[x] - both.result[1][c].row(y)[x]);
      }
    }
  }
  CHECK(difference > 1.0);
}

TEST_CASE("atrous: a pixel's colour reaches as far as the taps of all levels together, and no farther") {
  OwnedFrame frame(133, 133, {});
  AtrousParams params;
  params.value_sigma = 0.0F;
  frame.at("R", 66, 66) = 1e9F;
  const BankResult bank = run_filter(params, frame.frame());
  constexpr int kReach = 2 * (1 + 2 + 4 + 8 + 16);
  CHECK(bank.halo == kReach + 2 + 3);  // noise and guides
  CHECK(bank.result[0][0].row(66)[66 + kReach] > 0.6F);
  CHECK(bank.result[0][0].row(66 - kReach)[66] > 0.6F);
  CHECK(bank.result[0][0].row(66)[66 - kReach - 1] == Approx(0.5));
  CHECK(bank.result[0][0].row(66 + kReach + 1)[66] == Approx(0.5));
}

TEST_CASE("atrous: weights in steps are the nearest multiples") {
  OwnedFrame frame(40, 36, kUsualFeatures);
  fill_random(frame, 10);
  for (const char* c : {"variance.R", "variance.G", "variance.B"})
    fill(frame, c, 0.05F);  // of fill_random's noise 0.09
  AtrousSureParams params = lenient();
  params.value_sigma = 0.0F;
  params.levels = 1;  // so that one weight can be read off the result
  const Source source(frame.frame(), inspect(frame.frame()));
  const std::vector<AtrousLevel> levels = atrous_reference(params, source);
  params.weight_steps = 5;
  const BankResult bank = run_filter(params, frame.frame());
  int between = 0;
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 40; ++x) {
      const std::size_t i = pixel_index(40, x, y);
      const double detail = levels[0].detail[0][i];
      if (std::abs(detail) < 0.05) continue;
      const double w = (bank.result[0][0].row(y)[x] - levels[1].colour[0][i]) / detail;
      CHECK(5 * w == Approx(std::round(5 * w)).margin(1e-3));
      CHECK(std::abs(w - levels[0].detail_weight[i]) < 0.1 + 1e-4);
      if (w > 0.1 && w < 0.9) ++between;
    }
  }
  CHECK(between > 100);
}

TEST_CASE("atrous: the noise of every level and of its details is what flat images of white noise show") {
  constexpr int kSize = 190;
  OwnedFrame frame(kSize, kSize, {});
  AtrousSureParams params = with_weight(0.0F);
  params.value_sigma = 0.0F;
  std::vector<Statistics> noise(5);   // of c at levels 1 to 5, over what is predicted
  std::vector<Statistics> energy(5);  // of the taps around their mean at levels 0 to 4, likewise
  Random random(8);
  for (int r = 0; r < 20; ++r) {
    fill_flat(frame, random);
    const auto levels = atrous_reference(params, Source(frame.frame(), inspect(frame.frame())));
    for (std::size_t l = 0; l < 5; ++l) {
      const int margin = (4 << l) - 2;  // where taps are not clipped at any level so far
      double squares = 0;
      double ratio = 0;
      for (int y = margin; y < kSize - margin; ++y) {
        for (int x = margin; x < kSize - margin; ++x) {
          const std::size_t i = pixel_index(kSize, x, y);
          for (const auto& plane : levels[l + 1].colour)
            squares += std::pow(plane[i] - 0.5, 2) / levels[l + 1].noise[i];
          ratio += levels[l].energy[i] / levels[l].noise_energy[i];
        }
      }
      const double pixels = std::pow(kSize - 2 * margin, 2);
      noise[l].add(squares / pixels);
      energy[l].add(ratio / pixels);
    }
  }
  for (std::size_t l = 0; l < 5; ++l) {
    INFO("level " << l << ", noise " << noise[l].mean() << ", energy " << energy[l].mean());
    CHECK(std::abs(noise[l].mean() - 1.0) < 4.0 * noise[l].standard_error());
    CHECK(std::abs(energy[l].mean() - 1.0) < 4.0 * energy[l].standard_error());
    if (l < 3) CHECK(noise[l].standard_error() < 0.025);  // there a correlation of 0 would be far outside
    CHECK(energy[l].standard_error() < 0.06);
  }
}

TEST_CASE("atrous: what is nothing but noise is not kept, what is nothing but detail is") {
  OwnedFrame frame(96, 96, kUsualFeatures);
  Random random(5);
  fill_flat(frame, random);
  AtrousSureParams params;
  params.value_sigma = 0.0F;
  const auto noise = atrous_reference(params, Source(frame.frame(), inspect(frame.frame())));
  for (const char* c : {"variance.R", "variance.G", "variance.B"}) fill(frame, c, 1e-8F);
  const auto detail = atrous_reference(params, Source(frame.frame(), inspect(frame.frame())));
  for (std::size_t l = 0; l < 5; ++l) {
    double kept_noise = 0;
    double kept_detail = 0;
    for (std::size_t i = 0; i < noise[l].detail_weight.size(); ++i) {
      kept_noise += noise[l].detail_weight[i];
      kept_detail += detail[l].detail_weight[i];
    }
    INFO("level " << l);
    CHECK(kept_noise / static_cast<double>(noise[l].detail_weight.size()) < 0.02);
    CHECK(kept_detail / static_cast<double>(detail[l].detail_weight.size()) > 0.98);
  }
}

}  // namespace stein::test
