// SPDX-License-Identifier: Apache-2.0
#include "filters/smooth_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/cross_nlm_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Up to three normalised channels of a feature as the colour of a frame; pixels that are not to be looked at have no
// samples.
void copy_as_colour(const Source& source, std::size_t feature, std::size_t first, std::size_t count, OwnedFrame& to) {
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  for (int y = 0; y < to.frame().height; ++y) {
    for (int x = 0; x < to.frame().width; ++x) {
      float means[4];
      float* rows[4] = {means, means + 1, means + 2, means + 3};
      float unused = 0;
      source.feature_row(feature, 1.0F, y, x, 1, rows, &unused);
      for (std::size_t c = 0; c < 3; ++c) {
        float variance = 0;
        if (c < count) source.feature_variance_row(feature, first + c, y, x, 1, &variance);
        to.at(kRgb[c], x, y) = c < count ? means[first + c] : 0.0F;
        to.at(std::string("variance.") + kRgb[c], x, y) = variance;
        if (!is_valid(source.frame(), x, y) || variance >= Source::kNoInformation) to.at("sampleCount", x, y) = 0;
      }
    }
  }
}

// As AOS sec. 6: by each feature's own patches, not blurred.
CrossNlmParams own_patches() {
  CrossNlmParams params;
  params.distance = PatchDistance::kVarianceNormalised;
  params.window_radius = 5;
  params.patch_radius = 2;
  params.patch_blur = 0;
  params.guides.feature_sigmas.clear();
  return params;
}

// Largest deviations from non-local means of a frame that has the channels for its colour.
struct Deviation {
  double mean = 0;
  double variance = 0;  // relative to that before
};

Deviation deviation(const SmoothFeatures& smooth, const Source& source, std::size_t feature, int channel,
                    std::size_t first, std::size_t count) {
  const Frame& frame = source.frame();
  OwnedFrame colours(frame.width, frame.height, {}, false);
  copy_as_colour(source, feature, first, count, colours);
  const Source alone(colours.frame(), inspect(colours.frame()));
  const CrossNlmParams params = own_patches();
  const CrossNlmReference reference(params, alone);
  const double sigma = std::sqrt(0.5);
  Deviation found;
  for (int i = 0; i < frame.width * frame.height; i += 3) {
    const int x = i % frame.width;
    const int y = i / frame.width;
    const auto mean = reference.result(sigma, x, y);
    const auto divergence = reference.divergence(sigma, x, y, Divergence::kPlain);
    for (std::size_t c = 0; c < count; ++c) {
      const int k = channel + static_cast<int>(c);
      float before = 0;
      source.feature_variance_row(feature, first + c, y, x, 1, &before);
      if (!is_valid(colours.frame(), x, y)) {
        if (before >= Source::kNoInformation) CHECK(smooth.variance(k, y)[x] == Source::kNoInformation);
        continue;
      }
      found.mean = std::max(found.mean, std::abs(smooth.mean(k, y)[x] - mean[c]));
      const double left = std::clamp<double>(divergence[c], 0.0, before);
      found.variance = std::max(found.variance, std::abs(smooth.variance(k, y)[x] - left) / before);
    }
  }
  return found;
}

void prepare_all(const SmoothFeatures& smooth, const Frame& frame) {
  FilterScratch scratch;
  for (int y = 0; y < frame.height; y += 16) {
    for (int x = 0; x < frame.width; x += 32) {
      smooth.prepare({x, y, std::min(x + 32, frame.width), std::min(y + 16, frame.height)}, scratch);
    }
  }
}

}  // namespace

TEST_CASE("smooth features: equal plain non-local means of each feature, and so does what is left of their noise") {
  const std::vector<FeatureShape> shapes = {{"depth", 1}, {"unused", 2}, {"normal", 3}, {"other", 4}};
  OwnedFrame frame(37, 21, shapes);
  fill_random(frame, 4);
  frame.at("R", 20, 9) = kNaN;
  frame.at("sampleCount", 0, 20) = 0;
  frame.at("normal.Y", 11, 6) = kNaN;
  frame.at("depth.variance.Z", 30, 18) = -1;
  FeatureGuides guides;
  guides.feature_sigmas = {{"depth", 0.5F}, {"unused", 0.0F}, {"normal", 0.5F}, {"other", 2.0F}};
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 37; ++x) {
      frame.at("other.W", x, y) = 0.5F;
      frame.at("other.variance.W", x, y) = 1e-4F;
    }
  }
  for (int i = 0; i < 4; ++i) {  // about to stand out: the derivative is above 1
    frame.at("other.W", 3 + 9 * i, 6) += 0.01F * static_cast<float>(14 + 2 * i);
  }
  const Source source(frame.frame(), inspect(frame.frame()));
  const SmoothFeatures smooth(source, guides, 32, 16, 21);
  REQUIRE(smooth.channels() == 8);
  prepare_all(smooth, frame.frame());
  struct Part {
    std::size_t feature;
    int channel;
    std::size_t first;
    std::size_t count;
  };
  for (const Part& part : {Part{0, 0, 0, 1}, Part{2, 1, 0, 3}, Part{3, 4, 0, 3}, Part{3, 7, 3, 1}}) {
    CAPTURE(part.feature, part.first);
    const Deviation found = deviation(smooth, source, part.feature, part.channel, part.first, part.count);
    CHECK(found.mean < 1e-5);
    CHECK(found.variance < 1e-3);
  }
}

TEST_CASE("smooth features: covariances shrink as the variances do") {
  OwnedFrame frame(19, 15, {{"normal", 3}, {"depth", 1}});
  fill_random(frame, 6);
  frame.at("depth.Z", 7, 7) = kNaN;
  FeatureGuides guides;
  guides.feature_sigmas = {{"normal", 1.0F}, {"depth", 1.0F}};
  const Source source(frame.frame(), inspect(frame.frame()));
  const SmoothFeatures smooth(source, guides, 32, 16, 15);
  prepare_all(smooth, frame.frame());
  REQUIRE(smooth.has_covariance());
  std::vector<float> planes(12 * 19);
  float* rows[12];
  for (std::size_t k = 0; k < 12; ++k) rows[k] = planes.data() + 19 * k;
  std::vector<float> line(19);
  smooth.covariance_rows(7, 0, 19, line.data(), rows);
  double least = 1;
  for (int x = 0; x < 19; ++x) {
    for (int k = 0; k < 4; ++k) {
      const std::size_t feature = k < 3 ? 0 : 1;
      const std::size_t channel = k < 3 ? static_cast<std::size_t>(k) : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        float covariance = 0;
        float before = 0;
        source.feature_covariance_row(c, feature, channel, 1.0F, 7, x, 1, &covariance);
        source.feature_variance_row(feature, channel, 7, x, 1, &before);
        const double left = static_cast<double>(smooth.variance(k, 7)[x]) / before;
        CHECK(left <= 1.0);
        if (before < Source::kNoInformation) least = std::min(least, left);
        const bool is_bad = k == 3 && x == 7;
        const float found = rows[c * 4 + static_cast<std::size_t>(k)][x];
        CHECK(found == Approx(is_bad ? 0.0 : covariance * left).epsilon(1e-5).margin(1e-12));
      }
    }
  }
  CHECK(least < 0.5);  // something was smoothed
  FeatureGuides none;
  none.feature_sigmas.clear();
  none.other_feature_sigma = 0;
  const SmoothFeatures nothing(source, none, 32, 16, 15);
  CHECK(nothing.channels() == 0);
  CHECK_FALSE(nothing.has_covariance());
}

TEST_CASE("smooth features: exact features stay as they are") {
  OwnedFrame frame(16, 12, {{"normal", 3}}, false);
  Random random(3);
  for (const char* name : {"normal.X", "normal.Y", "normal.Z"}) {
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 16; ++x) frame.at(name, x, y) = static_cast<float>(random.uniform());
    }
  }
  frame.frame().features[0].variance.clear();
  const Source source(frame.frame(), inspect(frame.frame()));
  const SmoothFeatures smooth(source, FeatureGuides{}, 32, 16, 12);
  prepare_all(smooth, frame.frame());
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x) {
      CHECK(smooth.mean(2, y)[x] == Approx(frame.at("normal.Z", x, y)).epsilon(1e-6));
      CHECK(smooth.variance(2, y)[x] == 0.0F);
    }
  }
}

}  // namespace stein::test
