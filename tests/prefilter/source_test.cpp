// SPDX-License-Identifier: Apache-2.0
#include "prefilter/source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Pixel {
  float colour = 0;
  float variance = 0;
  float input = 0;
  float input_variance = 0;
  float mask = 0;
};

// Everything that the source says of channel c of one pixel, read by rows that start at x - lead.
Pixel pixel_of(const Source& source, std::size_t c, int x, int y, int lead) {
  const int count = lead + 1;
  const int first = x - lead;
  std::vector<float> a(static_cast<std::size_t>(count));
  std::vector<float> b(static_cast<std::size_t>(count));
  Pixel pixel;
  source.colour_row(c, y, first, count, a.data());
  pixel.colour = a.back();
  source.variance_row(c, y, first, count, a.data());
  pixel.variance = a.back();
  source.mask_row(y, first, count, a.data());
  pixel.mask = a.back();
  source.input_row(c, y, first, count, a.data(), b.data());
  pixel.input = a.back();
  pixel.input_variance = b.back();
  return pixel;
}

bool is_same(const Pixel& p, const Pixel& q) {
  return p.colour == q.colour && p.variance == q.variance && p.input == q.input &&
         p.input_variance == q.input_variance && p.mask == q.mask;
}

struct FeatureRow {
  std::vector<std::vector<float>> means;
  std::vector<float> variance;
};

FeatureRow feature_row(const Source& source, std::size_t feature, float factor, int y, int x, int count) {
  FeatureRow row;
  const auto n = static_cast<std::size_t>(count);
  row.means.assign(source.frame().features[feature].mean.size(), std::vector<float>(n));
  row.variance.resize(n);
  std::vector<float*> pointers;
  pointers.reserve(row.means.size());
  for (std::vector<float>& mean : row.means) pointers.push_back(mean.data());
  source.feature_row(feature, factor, y, x, count, pointers.data(), row.variance.data());
  return row;
}

// Mean over the channels of n times the variance of the mean, in units of the normalised feature.
double per_sample_variance(const Source& source, std::size_t f, int x, int y) {
  const Frame& frame = source.frame();
  const Feature& feature = frame.features[f];
  const double n = frame.sample_count ? frame.sample_count.at(x, y) : frame.uniform_sample_count;
  double sum = 0;
  for (const ConstPlaneView& plane : feature.variance) sum += plane.at(x, y) * n;
  const double scale = source.feature_scale(f);
  return sum * scale * scale / static_cast<double>(feature.mean.size());
}

}  // namespace

TEST_CASE("source: a pixel of a clean frame is seen as it is") {
  OwnedFrame frame(20, 6, {});
  fill_random(frame, 1);
  const Source source(frame.frame(), inspect(frame.frame()));
  CHECK(source.replaced().list().empty());
  for (const int lead : {0, 5}) {
    const float mean = frame.at("G", 7, 3);
    const float variance = frame.at("variance.G", 7, 3);
    CHECK(is_same(pixel_of(source, 1, 7, 3, lead), {mean, variance, mean, variance, 1.0F}));
  }
}

TEST_CASE("source: an invalid pixel has its fill for a colour, no variance and no weight") {
  OwnedFrame frame(20, 6, {});
  frame.at("R", 7, 3) = kNan;
  frame.at("G", 7, 3) = 9.0F;
  frame.at("sampleCount", 19, 5) = 0.0F;
  frame.at("variance.B", 0, 0) = -1.0F;
  const Source source(frame.frame(), inspect(frame.frame()));
  REQUIRE(source.replaced().list().size() == 3);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(is_same(pixel_of(source, c, 7, 3, 0), {0.5F, 0.0F, 0.5F, 0.0F, 0.0F}));
    CHECK(is_same(pixel_of(source, c, 7, 3, 7), {0.5F, 0.0F, 0.5F, 0.0F, 0.0F}));
    CHECK(is_same(pixel_of(source, c, 19, 5, 3), {0.5F, 0.0F, 0.5F, 0.0F, 0.0F}));
    CHECK(is_same(pixel_of(source, c, 0, 0, 0), {0.5F, 0.0F, 0.5F, 0.0F, 0.0F}));
    for (const int x : {6, 8}) CHECK(is_same(pixel_of(source, c, x, 3, 2), {0.5F, 0.01F, 0.5F, 0.01F, 1.0F}));
    CHECK(is_same(pixel_of(source, c, 7, 2, 2), {0.5F, 0.01F, 0.5F, 0.01F, 1.0F}));
  }
}

TEST_CASE("source: an outlier is filtered as scaled down, but stays itself in the input") {
  OwnedFrame frame(20, 6, {});
  frame.at("R", 4, 2) = kNan;
  frame.at("R", 6, 2) = 50.0F;
  frame.at("variance.R", 6, 2) = 400.0F;
  Source source(frame.frame(), inspect(frame.frame()));
  source.replace({{2, 0, {3.0F, 4.0F, 5.0F}, true}, {6, 2, {0.75F, 0.25F, 0.125F}, true}, {0, 5, {1, 1, 1}, true}});
  REQUIRE(source.replaced().list().size() == 4);
  CHECK(is_same(pixel_of(source, 0, 6, 2, 4), {0.75F, 0.0F, 50.0F, 400.0F, 1.0F}));
  CHECK(is_same(pixel_of(source, 1, 6, 2, 0), {0.25F, 0.0F, 0.5F, 0.01F, 1.0F}));
  CHECK(is_same(pixel_of(source, 2, 2, 0, 1), {5.0F, 0.0F, 0.5F, 0.01F, 1.0F}));
  CHECK(is_same(pixel_of(source, 2, 0, 5, 0), {1.0F, 0.0F, 0.5F, 0.01F, 1.0F}));
  CHECK(pixel_of(source, 0, 4, 2, 4).mask == 0.0F);  // the fill is still there
  CHECK(pixel_of(source, 0, 4, 2, 4).colour == 0.5F);
  for (std::size_t i = 1; i < 4; ++i) {
    const ReplacedPixel& p = source.replaced().list()[i - 1];
    const ReplacedPixel& q = source.replaced().list()[i];
    CHECK(std::pair(p.y, p.x) < std::pair(q.y, q.x));
  }
}

TEST_CASE("source: the colour that is seen of an outlier moves by its response, its features as they are") {
  OwnedFrame frame(20, 6, {});
  fill_random(frame, 3);
  frame.at("R", 4, 2) = kNan;
  Source source(frame.frame(), inspect(frame.frame()));
  const Source before = source;
  ReplacedPixel outlier{6, 2, {0.75F, 0.25F, 0.125F}, true, 0.5F, 0.25F};
  source.replace({outlier});
  const auto covariance = [](const Source& of, std::size_t a, std::size_t b, int x) {
    float row[8];
    of.colour_covariance_row(a, b, 2, x - 1, 3, row);
    return row[1];
  };
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      CHECK(covariance(source, a, b, 6) == 0.25F * covariance(before, a, b, 6));
      CHECK(covariance(source, a, b, 7) == covariance(before, a, b, 7));
      CHECK(covariance(source, a, b, 4) == 0.0F);
    }
    CHECK(covariance(before, a, a, 6) > 0.0F);
  }
  const Perturbation perturbation{5, 0, 0.25F};
  const Source moved = source.perturbed(perturbation);
  const Source moved_before = before.perturbed(perturbation);
  for (std::size_t c = 0; c < 3; ++c) {
    float b = 0;
    float same = 0;
    moved.direction_row(c, 2, 6, 1, &b);
    moved_before.direction_row(c, 2, 6, 1, &same);
    CHECK(b == same);
    REQUIRE(b != 0.0F);
    CHECK(pixel_of(moved, c, 6, 2, 3).colour == Approx(outlier.colour[c] + 0.25F * 0.25F * b));
    moved.direction_row(c, 2, 4, 1, &b);
    CHECK(b == 0.0F);
    CHECK(pixel_of(moved, c, 4, 2, 3).colour == pixel_of(before, c, 4, 2, 3).colour);
  }
}

TEST_CASE("source: features are scaled, their variance is that of a sample, and a group shares its mean") {
  constexpr int kWidth = 1100;  // rows are worked on in parts
  OwnedFrame frame(kWidth, 2, {{"normal", 3}, {"depth", 1}, {"other", 2}});
  fill_random(frame, 2);
  for (int x = 0; x < kWidth; ++x) {
    frame.at("sampleCount", x, 1) = static_cast<float>(1 + x % 7);
    frame.at("depth.Z", x, 1) *= 40.0F;
  }
  const Source source(frame.frame(), inspect(frame.frame()));
  REQUIRE(source.feature_scale(0) == 1.0F);
  REQUIRE(source.feature_scale(1) < 0.1F);
  for (std::size_t f = 0; f < 3; ++f) {
    for (const auto& [x, count] : {std::pair(0, kWidth), std::pair(37, 600), std::pair(1099, 1)}) {
      const FeatureRow row = feature_row(source, f, 2.5F, 1, x, count);
      for (int i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        for (std::size_t k = 0; k < row.means.size(); ++k) {
          const double mean = frame.frame().features[f].mean[k].at(x + i, 1);
          CHECK(row.means[k][at] == Approx(mean * source.feature_scale(f) * 2.5).epsilon(1e-6));
        }
        CHECK(row.variance[at] == Approx(per_sample_variance(source, f, x + i, 1)).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("source: one sample count for all pixels works as a plane of it") {
  OwnedFrame frame(30, 2, {{"albedo", 3}});
  fill_random(frame, 3);
  frame.frame().sample_count = {};
  frame.frame().uniform_sample_count = 16.0F;
  const Source source(frame.frame(), inspect(frame.frame()));
  const FeatureRow row = feature_row(source, 0, 1.0F, 0, 0, 30);
  for (int x = 0; x < 30; ++x) {
    CHECK(row.variance[static_cast<std::size_t>(x)] == Approx(per_sample_variance(source, 0, x, 0)).epsilon(1e-6));
  }
  CHECK(row.variance[0] > 0.02F);
}

TEST_CASE("source: a feature without variance is free of noise") {
  OwnedFrame frame(30, 2, {{"albedo", 3}});
  frame.frame().features[0].variance.clear();
  frame.frame().features[0].colour_covariance.clear();
  const Source source(frame.frame(), inspect(frame.frame()));
  const FeatureRow row = feature_row(source, 0, 1.0F, 0, 0, 30);
  CHECK(row.variance == std::vector<float>(30, 0.0F));
  CHECK(row.means[2] == std::vector<float>(30, 0.5F));
}

TEST_CASE("source: a bad feature pixel drops out of distances, and no other one does") {
  OwnedFrame frame(600, 3, {{"normal", 3}, {"depth", 1}});
  const auto is_at_hole = [](int x) { return std::abs(x - 550) < 2 || std::abs(x - 3) < 2; };
  for (int x = 0; x < 600; ++x) {  // so wide that pixels in them have few usable neighbours
    if (!is_at_hole(x)) continue;
    for (const int y : {1, 2}) frame.at(x > 300 ? "normal.Y" : "normal.variance.Z", x, y) = x > 300 ? kNan : -1.0F;
  }
  const Source source(frame.frame(), inspect(frame.frame()));
  for (const int start : {0, 2}) {
    const FeatureRow normal = feature_row(source, 0, 2.0F, 2, start, 600 - start);
    const FeatureRow depth = feature_row(source, 1, 2.0F, 2, start, 600 - start);
    for (int x = start; x < 600; ++x) {
      const auto i = static_cast<std::size_t>(x - start);
      const bool is_bad = is_at_hole(x);
      for (const std::vector<float>& mean : normal.means) CHECK(mean[i] == (is_bad ? 0.0F : 1.0F));
      // Against any other pixel the distance must vanish: 1e4^2 is the largest squared difference.
      CHECK((is_bad ? normal.variance[i] >= 1e9F : normal.variance[i] == Approx(0.008)));
      CHECK(depth.variance[i] < 1.0F);
    }
  }
  const FeatureRow clean_row = feature_row(source, 0, 2.0F, 0, 0, 600);
  CHECK(clean_row.means[1] == std::vector<float>(600, 1.0F));
}

TEST_CASE("source: a sample count that is no number does not spoil the features of its pixel") {
  OwnedFrame frame(20, 2, {{"albedo", 3}});
  const float bad_counts[] = {kNan, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                              -5.0F, 0.0F};
  for (int i = 0; i < 5; ++i) frame.at("sampleCount", 2 + 3 * i, 1) = bad_counts[i];
  const Source source(frame.frame(), inspect(frame.frame()));
  REQUIRE(source.replaced().list().size() == 5);
  const FeatureRow row = feature_row(source, 0, 1.0F, 1, 0, 20);
  for (std::size_t x = 0; x < 20; ++x) {
    CHECK(row.variance[x] >= 0.0F);
    CHECK(row.variance[x] <= 1e11F);
    CHECK(row.means[0][x] == 0.5F);
  }
}

TEST_CASE("source: huge features and variances stay finite when squared") {
  OwnedFrame frame(40, 40, {{"normal", 3}});
  frame.at("normal.X", 5, 5) = 1e38F;
  frame.at("normal.Y", 5, 5) = -1e38F;
  frame.at("normal.variance.X", 6, 5) = 3e38F;
  const Source source(frame.frame(), inspect(frame.frame()));
  const FeatureRow row = feature_row(source, 0, 10.0F, 5, 0, 40);
  CHECK(row.means[0][5] == 1e4F);
  CHECK(row.means[1][5] == -1e4F);
  CHECK(row.variance[6] >= 1e9F);
  CHECK(row.variance[6] <= 1e11F);
}

TEST_CASE("source: a feature's variance of few degrees of freedom is raised towards its neighbours'") {
  OwnedFrame frame(600, 7, {{"normal", 3}, {"depth", 1}});  // wider than what is worked on at a time
  fill_random(frame, 4);
  frame.at("depth.variance.Z", 511, 3) = 0;
  frame.at("depth.variance.Z", 509, 2) = kNan;
  frame.at("normal.variance.Y", 20, 3) = 100;
  const Source plain(frame.frame(), inspect(frame.frame()));
  frame.frame().degrees_of_freedom = 3;
  const Source source(frame.frame(), inspect(frame.frame()));
  int raised = 0;
  for (std::size_t f = 0; f < 2; ++f) {
    const FeatureRow found = feature_row(source, f, 1.0F, 3, 0, 600);
    const FeatureRow before = feature_row(plain, f, 1.0F, 3, 0, 600);
    for (int x = 0; x < 600; ++x) {
      double sum = 0;
      int neighbours = 0;
      for (int v = 1; v <= 5; ++v) {
        for (int u = std::max(x - 2, 0); u <= std::min(x + 2, 599); ++u) {
          const double variance = per_sample_variance(plain, f, u, v);
          if (!std::isfinite(variance)) continue;
          sum += variance;
          ++neighbours;
        }
      }
      const double own = per_sample_variance(plain, f, x, 3);
      const double expected = std::max(own, (3 * own + 3 * sum / neighbours) / 6);
      INFO("feature " << f << " at " << x);
      CHECK(found.variance[static_cast<std::size_t>(x)] == Approx(expected).epsilon(1e-5).margin(1e-12));
      CHECK(found.means[0][static_cast<std::size_t>(x)] == before.means[0][static_cast<std::size_t>(x)]);
      raised += expected > own * 1.0001 ? 1 : 0;
    }
    // Where a row begins and ends does not matter.
    const FeatureRow part = feature_row(source, f, 1.0F, 3, 505, 20);
    for (std::size_t i = 0; i < 20; ++i) CHECK(part.variance[i] == found.variance[505 + i]);
  }
  CHECK(raised > 100);
  CHECK(feature_row(source, 0, 1.0F, 3, 20, 1).variance[0] == Approx(per_sample_variance(plain, 0, 20, 3)));
  CHECK(feature_row(source, 1, 1.0F, 2, 509, 1).variance == feature_row(plain, 1, 1.0F, 2, 509, 1).variance);  // filled
}

}  // namespace stein::test
