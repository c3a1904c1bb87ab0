// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "renderer.hpp"
#include "scenes/scenes.hpp"
#include "stein/adaptive.hpp"
#include "support/statistics.hpp"

using namespace pathtracer;

namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 18;
constexpr std::size_t kPixels = static_cast<std::size_t>(kWidth) * kHeight;

stein::Execution with_threads(int threads) {
  stein::Execution execution;
  execution.threads = threads;
  return execution;
}

stein::Accumulator new_film() { return {kWidth, kHeight, {.features = feature_layout()}}; }

stein::Accumulator rendered(const Scene& scene, std::uint32_t samples, std::uint64_t seed, int threads = 0,
                            const PathSettings& settings = {}) {
  stein::Accumulator film = new_film();
  Renderer renderer(scene, kWidth, kHeight, seed, settings);
  renderer.render(std::vector<std::uint32_t>(kPixels, samples).data(), film, with_threads(threads));
  return film;
}

bool same_bits(const stein::Accumulator& a, const stein::Accumulator& b) {
  const auto x = a.state();
  const auto y = b.state();
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size_bytes()) == 0;
}

// Mean of the image's green, with the standard error that its variances tell.
struct ImageMean {
  double mean = 0;
  double variance = 0;
};

ImageMean image_mean(const stein::Accumulator& film) {
  const stein::Moments moments = film.moments();
  const stein::Frame& frame = moments.frame();
  ImageMean result;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      result.mean += frame.colour[1].at(x, y) / kPixels;
      result.variance += frame.colour_variance[1].at(x, y) / (kPixels * kPixels);
    }
  }
  return result;
}

bool agree(const ImageMean& a, const ImageMean& b) {
  return std::abs(a.mean - b.mean) <= 4 * std::sqrt(a.variance + b.variance);
}

std::vector<std::uint32_t> uneven_counts() {
  std::vector<std::uint32_t> counts(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) counts[i] = static_cast<std::uint32_t>(i * 7 % 5);
  return counts;
}

// A white object, lit evenly from everywhere, cannot be told from what is around it.
Statistics furnace(const Material& material) {
  Geometry shapes;
  shapes.add({0, 0, 0}, 1, material);
  shapes.add(block({2, -1, 0}, {1, 1, 1}, 30), material);
  const Scene scene(std::move(shapes), constant_environment(Colour(1)), {.eye = {1, 0.5F, 6}, .target = {1, 0, 0}});
  const stein::Accumulator film = rendered(scene, 32, 1, 0, {.max_bounces = 200});
  const stein::Moments moments = film.moments();
  Statistics pixels;
  for (std::size_t i = 0; i < kPixels; ++i) {
    pixels.add(moments.frame().colour[1].at(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth)));
  }
  return pixels;
}

}  // namespace

TEST_CASE("furnace: white surfaces vanish") {
  const Material material = GENERATE(diffuse(Colour(1)), mirror(Colour(1)), glass(Colour(1)));
  const Statistics pixels = furnace(material);
  INFO(pixels.mean() << " +- " << pixels.standard_error());
  CHECK(pixels.agrees_with(1));
  CHECK(pixels.standard_error() < 0.01);
}

TEST_CASE("furnace: a glossy surface is never brighter than what is around it") {
  const Statistics pixels = furnace(coated(Colour(1), GENERATE(0.1F, 0.5F)));
  CHECK(pixels.mean() < 1 + 4 * pixels.standard_error());
  CHECK(pixels.mean() > 0.9);
}

TEST_CASE("all ways to find light agree on a whole scene") {
  const Scene scene = cornell();
  const ImageMean both = image_mean(rendered(scene, 64, 1));
  const ImageMean lights = image_mean(rendered(scene, 64, 2, 0, {.direct_light = DirectLight::kLights}));
  const ImageMean scattered = image_mean(rendered(scene, 64, 3, 0, {.direct_light = DirectLight::kScattered}));
  CHECK(agree(both, lights));
  CHECK(agree(both, scattered));
  CHECK(both.variance < scattered.variance);
}

TEST_CASE("every scene renders: seeds agree, there is noise, and no sample is unusable") {
  const SceneEntry& entry = all_scenes()[GENERATE(range(std::size_t{0}, all_scenes().size()))];
  INFO(entry.name);
  const Scene scene = entry.make();
  const stein::Accumulator a = rendered(scene, 16, 1);
  const stein::Accumulator b = rendered(scene, 16, 2);
  CHECK_FALSE(same_bits(a, b));
  CHECK(a.rejected() + b.rejected() + a.repaired() + b.repaired() == 0);
  CHECK(agree(image_mean(a), image_mean(b)));
  CHECK(image_mean(a).variance > 0);
  CHECK(image_mean(a).mean > 0.05);
}

TEST_CASE("the number of threads changes no bit") {
  const Scene scene = motion();
  const stein::Accumulator one = rendered(scene, 4, 9, 1);
  CHECK(same_bits(one, rendered(scene, 4, 9, 4)));
  CHECK(same_bits(one, rendered(scene, 4, 9, 0)));
}

TEST_CASE("rounds continue where the last one ended, pixel by pixel") {
  const Scene scene = cornell_defocus();
  const std::vector<std::uint32_t> counts = uneven_counts();
  std::vector<std::uint32_t> rest(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) rest[i] = 6 - counts[i];
  stein::Accumulator film = new_film();
  Renderer renderer(scene, kWidth, kHeight, 5);
  renderer.render(counts.data(), film);
  CHECK_FALSE(same_bits(film, rendered(scene, 6, 5)));
  renderer.render(rest.data(), film);
  CHECK(same_bits(film, rendered(scene, 6, 5)));
}

TEST_CASE("uneven counts leave the mean of each pixel as it is") {
  const Scene scene = cornell();
  std::vector<std::uint32_t> counts = uneven_counts();
  for (std::uint32_t& n : counts) n = 8 * (n + 1);
  stein::Accumulator film = new_film();
  Renderer(scene, kWidth, kHeight, 11).render(counts.data(), film);
  CHECK(agree(image_mean(film), image_mean(rendered(scene, 32, 12))));
  const stein::Moments moments = film.moments();
  CHECK(moments.frame().sample_count.at(3, 0) == static_cast<float>(counts[3]));
}

TEST_CASE("adaptive sampling does not move the mean of the image") {
  const Scene scene = cornell();
  constexpr std::uint32_t kSamples = 12;
  Statistics adaptive;
  Statistics uniform;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    uniform.add(image_mean(rendered(scene, kSamples, 100 + seed)).mean);
    stein::Accumulator film = new_film();
    Renderer renderer(scene, kWidth, kHeight, seed);
    std::optional<stein::Moments> moments;
    stein::AdaptiveParams params;
    params.budget = std::int64_t{kPixels} * kSamples;
    const auto render = [&](const std::vector<std::uint32_t>& counts) {
      renderer.render(counts.data(), film);
      return moments.emplace(film.moments()).frame();
    };
    CHECK(stein::denoise_adaptively(kWidth, kHeight, render, params).samples == params.budget);
    adaptive.add(image_mean(film).mean);
  }
  INFO(adaptive.mean() << " +- " << adaptive.standard_error() << ", " << uniform.mean() << " +- "
                       << uniform.standard_error());
  CHECK(uniform.standard_error() < 0.02 * uniform.mean());
  CHECK(adaptive.agrees_with(uniform));
}

TEST_CASE("samples that are handed out are those in the film") {
  const Scene scene = cornell();
  const std::vector<std::uint32_t> counts = uneven_counts();
  const std::size_t channels = sample_channels().size();
  stein::Accumulator film = new_film();
  stein::Accumulator copy = new_film();
  int y = 0;
  Renderer(scene, kWidth, kHeight, 5).render(counts.data(), film, {}, [&](const std::uint32_t* row, const float* s) {
    for (int x = 0; x < kWidth; ++x) {
      REQUIRE(row[x] == counts[static_cast<std::size_t>(y * kWidth + x)]);
      for (std::uint32_t i = 0; i < row[x]; ++i, s += channels) copy.add(x, y, s);
    }
    ++y;
  });
  CHECK(y == kHeight);
  CHECK(same_bits(film, copy));
  stein::Accumulator at_once = new_film();
  Renderer(scene, kWidth, kHeight, 5).render(counts.data(), at_once);
  CHECK(same_bits(film, at_once));
}

TEST_CASE("the channels of a sample: random parameters are in [0, 1), features in their ranges") {
  const Scene scene = motion();
  const std::vector<std::string>& names = sample_channels();
  stein::Accumulator film = new_film();
  const std::vector<std::uint32_t> counts(kPixels, 2);
  std::vector<float> largest(names.size(), -1e9F);
  Renderer(scene, kWidth, kHeight, 5).render(counts.data(), film, {}, [&](const std::uint32_t*, const float* s) {
    for (std::size_t i = 0; i < 2 * kWidth; ++i) {
      for (std::size_t c = 0; c < names.size(); ++c) {
        const float value = s[i * names.size() + c];
        largest[c] = std::max(largest[c], value);
        INFO(names[c]);
        if (names[c].starts_with("random.")) REQUIRE((value >= 0 && value < 1));
        if (names[c].starts_with("normal")) REQUIRE(std::abs(value) <= 1.0001F);
        if (names[c].starts_with("albedo.")) REQUIRE((value >= 0 && value <= 1));
      }
    }
  });
  for (std::size_t c = 0; c < names.size(); ++c) {
    INFO(names[c]);
    CHECK(largest[c] > (names[c].starts_with("random.") ? 0.9F : 0.0F));
  }
}

TEST_CASE("a film without features takes the colour") {
  const Scene scene = spheres();
  stein::Accumulator film(kWidth, kHeight, {.features = {}, .covariances = false});
  Renderer(scene, kWidth, kHeight, 3).render(std::vector<std::uint32_t>(kPixels, 4).data(), film);
  CHECK(film.moments().frame().colour[1].at(9, 9) == rendered(scene, 4, 3).moments().frame().colour[1].at(9, 9));
}

TEST_CASE("films and sizes that do not fit are refused") {
  const Scene scene = spheres();
  const std::vector<std::uint32_t> counts(kPixels, 1);
  Renderer renderer(scene, kWidth, kHeight, 3);
  stein::Accumulator narrow(kWidth - 1, kHeight, {.features = feature_layout()});
  CHECK_THROWS_AS(renderer.render(counts.data(), narrow), stein::Error);
  stein::Accumulator other(kWidth, kHeight, {.features = {{"albedo", 3}}});
  CHECK_THROWS_AS(renderer.render(counts.data(), other), stein::Error);
  CHECK_THROWS_AS(Renderer(scene, 0, 4, 1), stein::Error);
  CHECK_THROWS_AS(make_scene("teapot"), stein::Error);
}

TEST_CASE("progress rises to 1, and cancelling keeps what was finished") {
  const Scene scene = spheres();
  const std::vector<std::uint32_t> counts(kPixels, 2);
  double last = 0;
  stein::Accumulator film = new_film();
  stein::Execution execution = with_threads(1);
  execution.progress = [&last](double done) {
    CHECK(done >= last);
    last = done;
    return true;
  };
  Renderer(scene, kWidth, kHeight, 3).render(counts.data(), film, execution);
  CHECK(last == Approx(1));

  stein::Accumulator part = new_film();
  Renderer renderer(scene, kWidth, kHeight, 3);
  execution.progress = [](double done) { return done < 0.3; };
  CHECK_THROWS_AS(renderer.render(counts.data(), part, execution), stein::Error);
  const stein::Moments moments = part.moments();
  std::vector<std::uint32_t> rest = counts;
  double taken = 0;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const float n = moments.frame().sample_count.at(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth));
    taken += n;
    rest[i] -= static_cast<std::uint32_t>(n);
  }
  CHECK(taken > 0.2 * 2 * kPixels);
  CHECK(taken < 0.6 * 2 * kPixels);
  renderer.render(rest.data(), part);
  CHECK(same_bits(part, film));
}
