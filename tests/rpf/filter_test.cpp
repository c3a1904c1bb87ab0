// SPDX-License-Identifier: Apache-2.0
//
// The whole filter on samples made by code: what it removes, what it keeps, and what it makes of bad input.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "rpf/samples.hpp"
#include "stein/error.hpp"

namespace {

using stein::RpfParams;
using stein::SampleGroup;
using stein::test::filter_image;
using stein::test::FilteredImage;
using stein::test::make_image;
using stein::test::make_wall;
using stein::test::Random;
using stein::test::SampleImage;
using Kind = SampleGroup::Kind;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Small boxes: tests are quick.
RpfParams small_boxes() {
  RpfParams params;
  params.boxes = {15, 9, 7};
  params.shares = {0.2F, 0.4F, 0.6F};
  return params;
}

bool all_finite(const FilteredImage& image) {
  for (const float v : image.colour) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const stein::Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("noise of the light goes, the edge between two materials stays") {
  const SampleImage wall = make_wall(32, 24, 8);
  const FilteredImage out = filter_image(wall, small_boxes());
  double noise_before = 0;
  double noise_after = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      const double truth = x < 16 ? 0.2 : 0.8;
      const std::vector<float>& pixel = wall.pixels[static_cast<std::size_t>(y * 32 + x)];
      double mean = 0;
      for (std::size_t i = 0; i < pixel.size(); i += static_cast<std::size_t>(wall.channels())) mean += pixel[i] / 8.0;
      noise_before += std::pow(mean / truth - 1, 2) / (32 * 24);
      noise_after += std::pow(out.at(x, y, 0) / truth - 1, 2) / (32 * 24);
    }
  }
  CHECK(noise_before > 0.03);
  CHECK(noise_after < noise_before / 10);
  CHECK(std::abs(out.at(15, 12, 0) / 0.2 - 1) < 0.25);
  CHECK(std::abs(out.at(16, 12, 0) / 0.8 - 1) < 0.25);
}

TEST_CASE("what a feature counts for at least holds for what a path sees first, not for what it meets later") {
  // One feature, which is the light that the sample was drawn with, as the colour is.
  const auto noisy_feature = [](const char* name) {
    return make_image(24, 20, 8, {{Kind::kFeature, name, 1}, {Kind::kRandom, "random.light", 1}},
                      [](int, int, Random& random) {
                        const auto light = static_cast<float>(random.uniform());
                        return std::vector<float>{light, light, light, light, light};
                      });
  };
  const auto filtered = [&](const char* name, float share) {
    RpfParams params = small_boxes();
    params.least_feature_share = share;
    return filter_image(noisy_feature(name), params).colour;
  };
  CHECK(filtered("visibility", 0.0F) == filtered("visibility", 1.0F));
  CHECK(filtered("albedo", 0.0F) != filtered("albedo", 1.0F));
}

TEST_CASE("a constant colour stays, and the colour scales with the light") {
  const auto flat = make_image(20, 9, 4, {{Kind::kFeature, "depth", 1}}, [](int, int, Random&) {
    return std::vector<float>{0.3F, 7.0F, 0.0F, 1.0F};
  });
  const FilteredImage out = filter_image(flat, small_boxes());
  for (int x = 0; x < 20; ++x) {
    CHECK(out.at(x, 4, 0) == Approx(0.3));
    CHECK(out.at(x, 4, 1) == Approx(7));
    CHECK(out.at(x, 4, 2) == 0);
  }
  const SampleImage wall = make_wall(16, 12, 6);
  SampleImage bright = wall;
  for (auto& pixel : bright.pixels) {
    for (std::size_t i = 0; i < pixel.size(); i += static_cast<std::size_t>(wall.channels())) {
      for (std::size_t c = 0; c < 3; ++c) pixel[i + c] *= 4;
    }
  }
  const FilteredImage dim = filter_image(wall, small_boxes());
  const FilteredImage lit = filter_image(bright, small_boxes());
  for (std::size_t i = 0; i < dim.colour.size(); ++i) REQUIRE(lit.colour[i] == Approx(4 * dim.colour[i]).epsilon(1e-4));
}

TEST_CASE("pixels with no, one, few and many samples, and samples that are no numbers") {
  SampleImage wall = make_wall(21, 17, 5);
  const auto channels = static_cast<std::size_t>(wall.channels());
  wall.at(3, 3).clear();
  for (int y = 8; y < 17; ++y) {
    for (int x = 10; x < 21; ++x) wall.at(x, y).clear();  // a corner wider than the smallest box
  }
  wall.at(4, 4).resize(channels);
  wall.at(5, 5).resize(2 * channels);
  for (int i = 0; i < 40; ++i) {
    const std::vector<float> some(wall.at(7, 7).begin(), wall.at(7, 7).begin() + static_cast<std::ptrdiff_t>(channels));
    wall.at(6, 6).insert(wall.at(6, 6).end(), some.begin(), some.end());
  }
  wall.at(2, 2)[0] = kNan;  // a colour
  wall.at(2, 2)[channels + 1] = std::numeric_limits<float>::infinity();
  wall.at(1, 1)[3] = kNan;              // a feature
  wall.at(1, 1)[channels + 10] = kNan;  // a random parameter
  RpfParams params = small_boxes();
  params.draws = 1;
  const FilteredImage out = filter_image(wall, params);
  CHECK(all_finite(out));
  for (const float e : out.error) REQUIRE(std::isfinite(e));
  CHECK(out.report.rejected == 2);
  CHECK(out.report.repaired == 2);
  CHECK(out.report.empty_pixels == 1 + 9 * 11);
  CHECK(out.report.single_pixels == 1);
  CHECK(out.at(3, 3, 0) == Approx(0.2).margin(0.15));   // from its neighbours
  CHECK(out.at(14, 13, 0) == Approx(0.2).margin(0.1));  // from as far as the largest box reaches
}

TEST_CASE("samples without features, without random parameters, and single pixels") {
  for (const int width : {1, 3}) {
    const auto bare = make_image(width, 2, 3, {}, [](int, int, Random& random) {
      const auto v = static_cast<float>(random.uniform());
      return std::vector<float>{v, v, v};
    });
    const FilteredImage out = filter_image(bare, small_boxes());
    CHECK(all_finite(out));
    CHECK(out.report.warnings.size() == 3);  // and few samples
  }
}

TEST_CASE("features and random parameters are used by name, the first bounce where nothing better is known") {
  const auto image = make_image(8, 6, 4,
                                {{Kind::kFeature, "position", 3},
                                 {Kind::kFeature, "position2", 3},
                                 {Kind::kRandom, "random.lens", 2},
                                 {Kind::kIgnored, "alpha", 1}},
                                [](int, int, Random& random) {
                                  std::vector<float> sample;
                                  for (int k = 0; k < 12; ++k) sample.push_back(static_cast<float>(random.uniform()));
                                  return sample;
                                });
  using Names = std::vector<std::string>;
  CHECK(filter_image(image, small_boxes()).report.randoms == Names{"random.lens", "first bounce"});
  RpfParams params = small_boxes();
  params.first_bounce = false;
  params.features = {"position"};
  const FilteredImage out = filter_image(image, params);
  CHECK(out.report.randoms == Names{"random.lens"});
  CHECK(out.report.features == Names{"position"});
  params.features = {"albedo"};
  CHECK(message_of([&] { static_cast<void>(filter_image(image, params)); }) ==
        "rpf: the samples have no feature 'albedo'; they have: position position2");
}

TEST_CASE("parameters out of range are named") {
  const SampleImage wall = make_wall(4, 4, 2);
  const auto message = [&](auto change) {
    RpfParams params = small_boxes();
    change(params);
    return message_of([&] { static_cast<void>(filter_image(wall, params)); });
  };
  CHECK(message([](RpfParams& p) {
          p.boxes = {8};
          p.shares = {1};
        }).find("boxes[0] is 8") != std::string::npos);
  CHECK(message([](RpfParams& p) { p.shares.pop_back(); }).find("one for each box") != std::string::npos);
  CHECK(message([](RpfParams& p) { p.colour_variance = 0; }).find("colour_variance") != std::string::npos);
  CHECK(message([](RpfParams& p) { p.step = kNan; }).find("step") != std::string::npos);
  CHECK(message([](RpfParams& p) { p.return_sigma = 17; }).find("return_sigma") != std::string::npos);
  CHECK(message([](RpfParams& p) { p.draws = -1; }).find("draws") != std::string::npos);
  CHECK(message([](RpfParams&) {}).empty());
}

TEST_CASE("the paper's settings as printed are there") {
  const RpfParams params = stein::paper_rpf(stein::kRpfDetail);
  CHECK(params.boxes == std::vector<int>{55, 35, 17, 7});
  CHECK(params.colour_variance == 0.002F);
  CHECK(params.feature_variance == 0.002F);
  CHECK(stein::paper_rpf(stein::kRpfNoisy).feature_variance == 0.02F);
  CHECK(params.cluster_deviations == 3);
  CHECK(params.spikes == stein::RpfSpikes::kReset);
  CHECK(params.return_sigma == 0);
  CHECK(all_finite(filter_image(make_wall(12, 12, 4), params)));
}

TEST_CASE("the estimated error is near the true one") {
  const SampleImage wall = make_wall(40, 32, 8);
  RpfParams params = small_boxes();
  params.draws = 4;
  const FilteredImage out = filter_image(wall, params);
  double truth = 0;
  double estimate = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 40; ++x) {
      truth += std::pow(out.at(x, y, 0) - (x < 20 ? 0.2 : 0.8), 2) / (40 * 32);
      estimate += out.error[static_cast<std::size_t>((y * 40 + x) * 3)] / (40 * 32);
    }
  }
  const double input = (0.04 + 0.64) / 2 / 3 / 8;  // variance of uniform light in 8 samples
  CHECK(truth < input / 8);
  CHECK(std::abs(out.report.mean_error[0] - truth) < input / 4);
  CHECK(estimate == Approx(out.report.mean_error[0]).margin(input / 8));
}
