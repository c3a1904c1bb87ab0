// SPDX-License-Identifier: Apache-2.0
//
// What the passes lost: the step against its definition in double, on noise, on skewed light, at edges.
#include "rpf/light_return.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "catch.hpp"
#include "rpf/samples.hpp"

namespace {

using stein::RpfParams;
using stein::rpf::LightReturn;
using stein::rpf::SampleRow;
using stein::rpf::SampleRows;
using stein::test::filter_image;
using stein::test::make_image;
using stein::test::Random;
using stein::test::SampleImage;
using Kind = stein::SampleGroup::Kind;

/// Of a pixel's channel.
using Value = std::function<float(int x, int y, int c)>;

std::vector<float> returned(const SampleImage& image, float sigma, const Value& filtered) {
  const stein::SampleSource source = image.source();
  const auto layout = stein::rpf::make_layout(source, RpfParams{});
  const LightReturn light(sigma);
  SampleRows rows(source, layout, {1, light.row_floats(image.width)}, image.height, nullptr);
  for (int y = 0; y < image.height; ++y) {
    rows.read_row();
    SampleRow& row = rows.row(y);
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) row.pixels[0][static_cast<std::size_t>(3 * x + c)] = filtered(x, y, c);
      light.note_pixel(layout, 0, x, row);
    }
  }
  std::vector<float> out;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; x += LightReturn::kSpan) light.run(1, x, y, rows);
    const float* row = rows.row(y).pixels[1];
    out.insert(out.end(), row, row + std::ptrdiff_t{3} * image.width);
  }
  return out;
}

double mean_of(const std::vector<float>& pixel, int channels, int c) {
  double sum = 0;
  const std::size_t n = pixel.size() / static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < n; ++i)
    sum += pixel[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)];
  return n > 0 ? sum / static_cast<double>(n) : 0.0;
}

/// The definition of docs/filters/rpf.md, one pixel.
std::vector<double> expected(const SampleImage& image, double sigma, const Value& filtered, int x, int y) {
  const int radius = static_cast<int>(std::ceil(2 * sigma));
  std::vector<double> weights;
  std::vector<std::vector<double>> lost;
  for (int ny = std::max(y - radius, 0); ny <= std::min(y + radius, image.height - 1); ++ny) {
    for (int nx = std::max(x - radius, 0); nx <= std::min(x + radius, image.width - 1); ++nx) {
      const std::vector<float>& pixel = image.pixels[static_cast<std::size_t>(ny * image.width + nx)];
      if (pixel.empty()) continue;
      double difference = 0;
      double size = 1e-30;
      std::vector<double> d;
      for (int c = 0; c < 3; ++c) {
        const double a = filtered(x, y, c);
        const double b = filtered(nx, ny, c);
        difference += (a - b) * (a - b);
        size += (a * a + b * b) / 2;
        d.push_back(mean_of(pixel, image.channels(), c) - b);
      }
      const double like = std::max(0.0, 1 - difference / size / 1.5);
      const double distance = (nx - x) * (nx - x) + (ny - y) * (ny - y);
      weights.push_back(like * like * std::exp(-distance / (2 * sigma * sigma)));
      lost.push_back(d);
    }
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> light(3);
  double square = 0;
  double variance = 0;
  for (std::size_t c = 0; c < 3 && sum > 0; ++c) {
    for (std::size_t i = 0; i < lost.size(); ++i) light[c] += weights[i] * lost[i][c] / sum;
    for (std::size_t i = 0; i < lost.size(); ++i) variance += std::pow(weights[i] * (lost[i][c] - light[c]) / sum, 2);
    square += light[c] * light[c];
  }
  const double share = square > 0 ? std::max(0.0, 1 - 2 * variance / square) : 0.0;
  for (int c = 0; c < 3; ++c) {
    const double value = filtered(x, y, c);
    light[static_cast<std::size_t>(c)] =
        std::max(value + share * light[static_cast<std::size_t>(c)], std::min(value, 0.0));
  }
  return light;
}

/// Grey samples: `dim` mostly, now and then `bright`.
SampleImage skewed(int width, int height, int samples, float dim, float bright) {
  return make_image(width, height, samples, {{Kind::kRandom, "random.light", 1}}, [=](int, int, Random& random) {
    const auto u = static_cast<float>(random.uniform());
    const float v = u < 0.1F ? bright : dim * (0.8F + 0.4F * static_cast<float>(random.uniform()));
    return std::vector<float>{v, v, 0.5F * v, u};
  });
}

double mean_channel(const std::vector<float>& colour, std::size_t c) {
  double sum = 0;
  for (std::size_t i = c; i < colour.size(); i += 3) sum += colour[i];
  return 3 * sum / static_cast<double>(colour.size());
}

}  // namespace

TEST_CASE("what the passes lost goes back as defined, with edges, empty pixels and ends of the image") {
  SampleImage image = skewed(37, 29, 3, 0.5F, 2.0F);
  for (const int x : {0, 16, 17, 36}) image.at(x, 3).clear();
  const Value filtered = [](int x, int y, int c) {
    const float edge = x + y < 40 ? 0.4F : 1.3F;
    return c == 2 ? -0.01F + 0.001F * static_cast<float>(y) : edge + 0.004F * static_cast<float>(x);
  };
  for (const float sigma : {0.7F, 2.5F}) {
    const std::vector<float> out = returned(image, sigma, filtered);
    int changed = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const std::vector<double> truth = expected(image, sigma, filtered, x, y);
        const std::size_t i = static_cast<std::size_t>(y * image.width + x) * 3;
        changed += std::abs(truth[0] - filtered(x, y, 0)) > 0.01 ? 1 : 0;
        for (std::size_t c = 0; c < 3; ++c) REQUIRE(out[i + c] == Approx(truth[c]).margin(2e-5));
      }
    }
    CHECK(changed > 300);
  }
}

TEST_CASE("where nothing was lost, little of the noise comes back, and a loss comes back almost whole") {
  const SampleImage image = skewed(64, 48, 4, 0.5F, 2.0F);
  const double light = 0.9 * 0.5 + 0.1 * 2;
  const auto mean_square = [&](double kept) {
    const std::vector<float> out =
        returned(image, 5, [&](int, int, int c) { return static_cast<float>((c == 2 ? 0.5 : 1.0) * kept * light); });
    double sum = 0;
    for (std::size_t i = 0; i < out.size(); i += 3) sum += std::pow(out[i] - light, 2);
    return 3 * sum / static_cast<double>(out.size());
  };
  const double pixel_variance = 0.09 * 1.5 * 1.5 / 4;
  CHECK(mean_square(1) < pixel_variance / 100);
  CHECK(mean_square(0.8) < 0.1 * std::pow(0.2 * light, 2));
}

TEST_CASE("pixels of another colour neither give nor take") {
  const SampleImage image = make_image(24, 8, 2, {{Kind::kFeature, "depth", 1}}, [](int x, int, Random& random) {
    const float v = x < 12 ? 1.0F : 20.0F + 0.2F * static_cast<float>(random.uniform());
    return std::vector<float>{v, v, v, 1.0F};
  });
  const std::vector<float> out = returned(image, 4, [](int x, int, int) { return x < 12 ? 1.0F : 18.0F; });
  for (std::size_t i = 0; i < out.size(); i += 3) {
    const bool is_left = i / 3 % 24 < 12;
    REQUIRE(out[i] == Approx(is_left ? 1.0 : 20.1).epsilon(is_left ? 1e-6 : 0.01));
  }
}

TEST_CASE("the filter keeps the light of a wall that few samples light") {
  // What the light depends on is only in part the parameter that is known.
  const SampleImage image = make_image(40, 32, 8, {{Kind::kRandom, "random.light", 1}}, [](int, int, Random& random) {
    const auto u = static_cast<float>(random.uniform());
    const auto hidden = static_cast<float>(random.uniform());
    const float v = u * std::pow(hidden, 4.0F);
    return std::vector<float>{v, v, v, u};
  });
  RpfParams params;
  params.boxes = {15, 9, 7};
  params.shares = {0.2F, 0.4F, 0.6F};
  params.colour_variance = 0.05F;  // narrow weights lose more
  std::vector<float> rendered;
  for (const std::vector<float>& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) rendered.push_back(static_cast<float>(mean_of(pixel, image.channels(), c)));
  }
  const double light = mean_channel(rendered, 0);
  params.return_sigma = 0;
  const double without = std::abs(mean_channel(filter_image(image, params).colour, 0) / light - 1);
  params.return_sigma = RpfParams{}.return_sigma;
  const double with = std::abs(mean_channel(filter_image(image, params).colour, 0) / light - 1);
  INFO("lost without: " << without << ", with: " << with);
  CHECK(without > 0.02);
  CHECK(with < 0.4 * without);
}
