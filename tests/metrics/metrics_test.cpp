// SPDX-License-Identifier: Apache-2.0
#include "metrics/metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "catch.hpp"
#include "stein/error.hpp"

namespace {

using stein::metrics::compare;
using stein::metrics::Comparison;
using stein::metrics::Rgb;

struct Image {
  Image(int w, int h, float value = 0) : width(w), height(h) {
    for (auto& channel : channels) {
      channel.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value);
    }
  }
  [[nodiscard]] Rgb view() const {
    return {stein::ConstPlaneView(channels[0].data(), width, height),
            stein::ConstPlaneView(channels[1].data(), width, height),
            stein::ConstPlaneView(channels[2].data(), width, height)};
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }

  int width;
  int height;
  std::array<std::vector<float>, 3> channels;
};

Image random_image(int width, int height, unsigned seed) {
  Image image(width, height);
  std::mt19937 random(seed);
  for (auto& channel : image.channels) {
    for (float& v : channel) {
      v = static_cast<float>(random() % 1400) / 1000.0F - 0.2F;  // some below 0 and some above 1
    }
  }
  return image;
}

double naive_encode(double v) {
  v = std::clamp(v, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

double naive_grey(const Image& image, int x, int y) {
  double sum = 0;
  for (const auto& channel : image.channels) {
    sum += naive_encode(channel[image.index(x, y)]);
  }
  return sum / 3;
}

struct Statistics {
  double mean_a = 0, mean_b = 0, variance_a = 0, variance_b = 0, covariance = 0;
};

// Two passes over an 11x11 window that is clipped to the image: first the means, then the centred moments.
Statistics window_statistics(const Image& a, const Image& b, int cx, int cy) {
  Statistics s;
  double total = 0;
  const auto over_window = [&](auto visit) {
    for (int y = std::max(cy - 5, 0); y <= std::min(cy + 5, a.height - 1); ++y) {
      for (int x = std::max(cx - 5, 0); x <= std::min(cx + 5, a.width - 1); ++x) {
        visit(std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / 4.5), naive_grey(a, x, y), naive_grey(b, x, y));
      }
    }
  };
  over_window([&](double w, double va, double vb) {
    total += w;
    s.mean_a += w * va;
    s.mean_b += w * vb;
  });
  s.mean_a /= total;
  s.mean_b /= total;
  over_window([&](double w, double va, double vb) {
    s.variance_a += w / total * (va - s.mean_a) * (va - s.mean_a);
    s.variance_b += w / total * (vb - s.mean_b) * (vb - s.mean_b);
    s.covariance += w / total * (va - s.mean_a) * (vb - s.mean_b);
  });
  return s;
}

double naive_ssim(const Image& a, const Image& b) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const Statistics s = window_statistics(a, b, x, y);
      sum += (2 * s.mean_a * s.mean_b + 1e-4) * (2 * s.covariance + 9e-4) /
             ((s.mean_a * s.mean_a + s.mean_b * s.mean_b + 1e-4) * (s.variance_a + s.variance_b + 9e-4));
    }
  }
  return sum / (a.width * a.height);
}

}  // namespace

TEST_CASE("equal images have no error") {
  const Image image = random_image(23, 17, 1);
  const Comparison figures = compare(image.view(), image.view());
  CHECK(figures.rel_mse == 0);
  CHECK(figures.trimmed_rel_mse == 0);
  CHECK(figures.mse == 0);
  CHECK(figures.psnr == std::numeric_limits<double>::infinity());
  CHECK(figures.ssim == Approx(1).epsilon(1e-12));
}

TEST_CASE("a constant difference has closed forms") {
  const Image image(20, 15, 0.75F);
  const Image reference(20, 15, 0.5F);
  const Comparison figures = compare(image.view(), reference.view());
  CHECK(figures.mse == Approx(0.0625));
  CHECK(figures.rel_mse == Approx(0.0625 / 0.26));
  CHECK(figures.trimmed_rel_mse == Approx(figures.rel_mse));
  const double a = naive_encode(0.75);
  const double b = naive_encode(0.5);
  CHECK(figures.psnr == Approx(-20 * std::log10(a - b)));
  CHECK(figures.ssim == Approx((2 * a * b + 1e-4) / (a * a + b * b + 1e-4)));
}

TEST_CASE("the relative error divides by the reference, not by the image") {
  const Image one(4, 4, 1);
  const Image three(4, 4, 3);
  CHECK(compare(three.view(), one.view()).rel_mse == Approx(4 / 1.01));
  CHECK(compare(one.view(), three.view()).rel_mse == Approx(4 / 9.01));
}

TEST_CASE("the trimmed error drops floor(N / 10000) of the worst pixels") {
  // 25,000 pixels: two are dropped. Three outliers of different size: the smallest stays.
  Image image(250, 100, 0);
  const Image reference(250, 100, 0);
  image.channels[0][image.index(3, 4)] = 10;
  image.channels[1][image.index(200, 90)] = 20;
  image.channels[2][image.index(100, 50)] = 1;
  const Comparison figures = compare(image.view(), reference.view());
  CHECK(figures.rel_mse == Approx((100 + 400 + 1) / 0.01 / 3 / 25000));
  CHECK(figures.trimmed_rel_mse == Approx(1 / 0.01 / 3 / 24998));

  Image small(99, 101, 0);  // 9,999 pixels: none is dropped
  small.channels[0][0] = 10;
  const Comparison untrimmed = compare(small.view(), Image(99, 101, 0).view());
  CHECK(untrimmed.trimmed_rel_mse == Approx(untrimmed.rel_mse));
}

TEST_CASE("SSIM and PSNR agree with a direct evaluation") {
  const auto size = GENERATE(std::array<int, 2>{26, 19}, std::array<int, 2>{11, 11}, std::array<int, 2>{30, 10},
                             std::array<int, 2>{7, 5}, std::array<int, 2>{1, 1});
  const Image a = random_image(size[0], size[1], 2);
  const Image b = random_image(size[0], size[1], 3);
  const Comparison figures = compare(a.view(), b.view());
  CHECK(figures.ssim == Approx(naive_ssim(a, b)).epsilon(1e-6));
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < a.channels[c].size(); ++i) {
      sum += std::pow(naive_encode(a.channels[c][i]) - naive_encode(b.channels[c][i]), 2);
    }
  }
  CHECK(figures.psnr == Approx(-10 * std::log10(sum / (3.0 * size[0] * size[1]))).epsilon(1e-6));
}

TEST_CASE("non-finite pixels make every figure non-finite") {
  const float bad = GENERATE(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                             -std::numeric_limits<float>::infinity());
  const bool in_image = GENERATE(true, false);
  Image image(200, 100, 0.5F);
  Image reference(200, 100, 0.25F);
  Image& spoilt = in_image ? image : reference;
  spoilt.channels[1][spoilt.index(60, 40)] = bad;
  const Comparison figures = compare(image.view(), reference.view());
  CHECK_FALSE(std::isfinite(figures.rel_mse));
  CHECK_FALSE(std::isfinite(figures.trimmed_rel_mse));
  CHECK_FALSE(std::isfinite(figures.mse));
  CHECK_FALSE(std::isfinite(figures.psnr));
  CHECK_FALSE(std::isfinite(figures.ssim));
}

TEST_CASE("images of different sizes are refused") {
  const Image a(8, 6);
  CHECK_THROWS_AS(compare(a.view(), Image(6, 8).view()), stein::Error);
  CHECK_THROWS_AS(compare(Image(8, 7).view(), a.view()), stein::Error);
  CHECK_THROWS_AS(stein::metrics::relative_error_map(a.view(), Image(9, 6).view()), stein::Error);
  Rgb incomplete = a.view();
  incomplete[2] = {};
  CHECK_THROWS_AS(compare(incomplete, a.view()), stein::Error);
}

TEST_CASE("the error map averages the channels of a pixel") {
  Image image(5, 3, 0);
  image.channels[0][image.index(4, 2)] = 0.3F;
  image.channels[2][image.index(4, 2)] = 0.6F;
  image.channels[1][image.index(0, 1)] = 0.1F;
  const stein::Plane map = stein::metrics::relative_error_map(image.view(), Image(5, 3, 0).view());
  REQUIRE(map.width() == 5);
  REQUIRE(map.height() == 3);
  CHECK(map.row(2)[4] == Approx((0.09 + 0.36) / 0.01 / 3));
  CHECK(map.row(1)[0] == Approx(0.01 / 0.01 / 3));
  CHECK(map.row(0)[0] == 0);
}

TEST_CASE("sRGB encoding clips and follows both branches") {
  using stein::metrics::encode_srgb;
  CHECK(encode_srgb(0.0F) == 0.0F);
  CHECK(encode_srgb(-3.0F) == 0.0F);
  CHECK(encode_srgb(std::numeric_limits<float>::quiet_NaN()) == 0.0F);
  CHECK(encode_srgb(1.0F) == 1.0F);
  CHECK(encode_srgb(900.0F) == 1.0F);
  CHECK(encode_srgb(0.002F) == Approx(0.02584));
  CHECK(encode_srgb(0.214041F) == Approx(0.5).epsilon(1e-5));
}
