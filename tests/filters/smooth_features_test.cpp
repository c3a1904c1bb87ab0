// SPDX-License-Identifier: Apache-2.0
#include "filters/smooth_features.hpp"

#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/feature_nlm_reference.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// One feature of all pixels.
class Smoothed {
 public:
  struct Tile {
    int width = 0;
    int height = 0;
  };
  Smoothed(const Source& source, std::size_t feature, const NlmWindow& window, const Tile& tile)
      : channels_(static_cast<int>(source.frame().features[feature].mean.size())),
        ring_(2 * channels_, source.frame().width, source.frame().height) {
    const FeatureSmoother smoother(source, window, tile.width, tile.height);
    exec::TileScratch scratch;
    for (int y = 0; y < source.frame().height; y += tile.height) {
      for (int x = 0; x < source.frame().width; x += tile.width) {
        const Rect part{x, y, std::min(x + tile.width, source.frame().width),
                        std::min(y + tile.height, source.frame().height)};
        smoother.run(feature, part, scratch, ring_, 0, channels_);
      }
    }
  }
  [[nodiscard]] float mean(int channel, int x, int y) const { return ring_.row(channel, y)[x]; }
  [[nodiscard]] float kept(int channel, int x, int y) const { return ring_.row(channels_ + channel, y)[x]; }

 private:
  int channels_;
  exec::RowRing ring_;
};

// Largest deviation from the plain reference; of what is kept of steps, at some of the pixels.
struct Deviation {
  double mean = 0;
  double kept = 0;
};

Deviation deviation(const Frame& frame, std::size_t feature, const NlmWindow& window) {
  const Source source(frame, inspect(frame));
  const Smoothed smoothed(source, feature, window, {32, 16});
  FeatureNlmReference reference(source, feature, window);
  Deviation largest;
  for (int i = 0; i < frame.width * frame.height; ++i) {
    const int x = i % frame.width;
    const int y = i / frame.width;
    const std::vector<double> means = reference.means(x, y);
    for (std::size_t k = 0; k < means.size(); ++k) {
      const int channel = static_cast<int>(k);
      largest.mean = std::max(largest.mean, std::abs(smoothed.mean(channel, x, y) - means[k]));
      if (i % 7 != 0) continue;
      largest.kept = std::max(largest.kept, std::abs(smoothed.kept(channel, x, y) - reference.kept(x, y, k)));
    }
  }
  return largest;
}

void check_deviation(const Frame& frame, std::size_t feature, const NlmWindow& window) {
  const Deviation found = deviation(frame, feature, window);
  CHECK(found.mean < 1e-5);
  CHECK(found.kept < 1e-3);
}

// With pixels and features that cannot be used.
const std::vector<FeatureShape> kShapes = {{"depth", 1}, {"pair", 2}, {"normal", 3}, {"other", 4}};

void fill_with_holes(OwnedFrame& frame, std::uint64_t seed) {
  const int width = frame.frame().width;
  const int height = frame.frame().height;
  fill_random(frame, seed);
  frame.at("R", width / 2, height / 2) = kNaN;
  frame.at("sampleCount", 0, height - 1) = 0;
  frame.at("normal.Y", width / 3, height / 3) = kNaN;
  frame.at("depth.variance.Z", width - 1, 0) = -1;
}

void prepare_all(const SmoothFeatures& smooth, const Frame& frame) {
  exec::TileScratch scratch;
  for (int y = 0; y < frame.height; y += 16) {
    for (int x = 0; x < frame.width; x += 32) {
      smooth.prepare({x, y, std::min(x + 32, frame.width), std::min(y + 16, frame.height)}, scratch);
    }
  }
}

}  // namespace

TEST_CASE("feature smoother: equals plain non-local means for any number of channels, window and patch") {
  OwnedFrame frame(37, 21, kShapes);
  fill_with_holes(frame, 4);
  for (const NlmWindow& window :
       {NlmWindow{1, 1}, NlmWindow{2, 1}, NlmWindow{5, 1}, NlmWindow{3, 2}, NlmWindow{5, 2}}) {
    for (std::size_t feature = 0; feature < 4; ++feature) {
      CAPTURE(window.radius, window.patch_radius, feature);
      check_deviation(frame.frame(), feature, window);
    }
  }
}

TEST_CASE("feature smoother: more than all of a step is never left") {
  OwnedFrame frame(37, 21, {{"other", 1}});
  fill_random(frame, 4);
  for (int i = 0; i < 37 * 21; ++i) {
    frame.at("other.Z", i % 37, i / 37) = 0.5F;
    frame.at("other.variance.Z", i % 37, i / 37) = 1e-4F;
  }
  for (int i = 0; i < 4; ++i) {  // about to stand out: the derivative is above 1
    frame.at("other.Z", 3 + 9 * i, 6) += 0.01F * static_cast<float>(14 + 2 * i);
  }
  const Source source(frame.frame(), inspect(frame.frame()));
  const Smoothed smoothed(source, 0, SmoothFeatures::kWindow, {32, 16});
  FeatureNlmReference reference(source, 0, SmoothFeatures::kWindow);
  int all = 0;
  for (int i = 0; i < 4; ++i) {
    const double expected = reference.kept(3 + 9 * i, 6, 0);
    CHECK(std::abs(smoothed.kept(0, 3 + 9 * i, 6) - expected) < 1e-3);
    all += expected == 1.0 ? 1 : 0;
  }
  CHECK(all > 0);
}

TEST_CASE("feature smoother: equals the reference for all sizes from 1 to 40") {
  for (int size = 1; size <= 40; ++size) {
    OwnedFrame frame(size, 41 - size, {{"normal", 3}});
    fill_random(frame, static_cast<std::uint64_t>(size));
    CAPTURE(size);
    check_deviation(frame.frame(), 0, {2, 1});
  }
}

TEST_CASE("feature smoother: all instruction sets of this machine agree with the reference") {
  OwnedFrame frame(23, 17, kShapes);
  fill_with_holes(frame, 8);
  for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    CAPTURE(kernels::instruction_set());
    check_deviation(frame.frame(), 2, {2, 1});
    check_deviation(frame.frame(), 3, {5, 2});
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST_CASE("feature smoother: tiles of any size give identical bits, with holes and without") {
  OwnedFrame frame(75, 45, kShapes);
  fill_with_holes(frame, 9);
  const Source source(frame.frame(), inspect(frame.frame()));
  const Smoothed whole(source, 2, {2, 1}, {75, 45});
  for (const Smoothed::Tile& tile : {Smoothed::Tile{16, 5}, Smoothed::Tile{32, 16}, Smoothed::Tile{48, 45}}) {
    const Smoothed parts(source, 2, {2, 1}, tile);
    int different = 0;
    for (int y = 0; y < 45; ++y) {
      for (int x = 0; x < 75; ++x) {
        for (int k = 0; k < 3; ++k) {
          different += whole.mean(k, x, y) == parts.mean(k, x, y) ? 0 : 1;
          different += whole.kept(k, x, y) == parts.kept(k, x, y) ? 0 : 1;
        }
      }
    }
    CAPTURE(tile.width, tile.height);
    CHECK(different == 0);
  }
}

// A Monte Carlo experiment: the covariance of the smoothed feature with the pixel's own noise over its variance.
TEST_CASE("feature smoother: of a pixel's noise as much is left as it says") {
  for (const NlmWindow& window : {NlmWindow{2, 1}, SmoothFeatures::kWindow}) {
    OwnedFrame frame(64, 64, {{"normal", 3}}, false);
    Random random(17);
    constexpr float kDeviation = 0.05F;
    Statistics left;
    Statistics said;
    for (int draw = 0; draw < 20; ++draw) {
      std::vector<double> noise;
      for (const char* name : {"normal.X", "normal.Y", "normal.Z"}) {
        for (int i = 0; i < 64 * 64; ++i) {
          noise.push_back(random.normal());
          frame.at(name, i % 64, i / 64) = 0.5F + kDeviation * static_cast<float>(noise.back());
          frame.at(std::string("normal.variance.") + name[7], i % 64, i / 64) = kDeviation * kDeviation;
        }
      }
      const Source source(frame.frame(), inspect(frame.frame()));
      const Smoothed smoothed(source, 0, window, {64, 64});
      double product = 0;
      double kept = 0;
      for (int i = 0; i < 64 * 64; ++i) {
        const auto at = static_cast<std::size_t>(i);
        for (int k = 0; k < 3; ++k) {
          const double mean = smoothed.mean(k, i % 64, i / 64) - 0.5;
          product += mean / kDeviation * noise[static_cast<std::size_t>(k) * 64 * 64 + at] / (3 * 64 * 64);
          kept += smoothed.kept(k, i % 64, i / 64) / (3 * 64 * 64.0);
        }
      }
      left.add(product);
      said.add(kept);
    }
    CAPTURE(window.radius, left.mean(), left.standard_error(), said.mean());
    CHECK(std::abs(left.mean() - said.mean()) < 4.0 * left.standard_error());
    CHECK(left.standard_error() < 0.03 * said.mean());
  }
}

TEST_CASE("smooth features: the means are smoothed, and as much noise is left as of a step") {
  OwnedFrame frame(37, 21, {{"depth", 1}, {"unused", 2}, {"normal", 3}, {"other", 4}});
  fill_random(frame, 4);
  frame.at("R", 20, 9) = kNaN;
  frame.at("sampleCount", 0, 20) = 0;
  frame.at("normal.Y", 11, 6) = kNaN;
  frame.at("depth.variance.Z", 30, 18) = -1;
  FeatureGuides guides;
  guides.feature_sigmas = {{"depth", 0.5F}, {"unused", 0.0F}, {"normal", 0.5F}, {"other", 2.0F}};
  const Source source(frame.frame(), inspect(frame.frame()));
  const SmoothFeatures smooth(source, guides, 32, 16, 21);
  REQUIRE(smooth.channels() == 8);
  prepare_all(smooth, frame.frame());
  int channel = 0;
  for (const std::size_t feature : {std::size_t{0}, std::size_t{2}, std::size_t{3}}) {
    const Smoothed alone(source, feature, SmoothFeatures::kWindow, {32, 16});
    for (std::size_t k = 0; k < frame.frame().features[feature].mean.size(); ++k, ++channel) {
      for (int i = 0; i < 37 * 21; ++i) {
        const int x = i % 37;
        const int y = i / 37;
        float before = 0;
        source.feature_variance_row(feature, k, y, x, 1, &before);
        const float left = before >= Source::kNoInformation ? before : before * alone.kept(static_cast<int>(k), x, y);
        CHECK(smooth.mean(channel, y)[x] == alone.mean(static_cast<int>(k), x, y));
        CHECK(smooth.variance(channel, y)[x] == left);
      }
    }
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
  smooth.covariance_rows(7, 0, 19, rows);
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
