// SPDX-License-Identifier: Apache-2.0
#include "rpf/samples.hpp"

#include <memory>
#include <utility>

namespace stein::test {

int SampleImage::channels() const {
  int channels = 3;
  for (const SampleGroup& group : groups) channels += group.channels;
  return channels;
}

SampleSource SampleImage::source() const {
  SampleSource source{width, height, groups, {}};
  source.next_row = [this, y = 0](std::vector<std::uint32_t>& counts, std::vector<float>& samples) mutable {
    counts.clear();
    samples.clear();
    for (int x = 0; x < width; ++x) {
      const std::vector<float>& pixel = pixels[static_cast<std::size_t>(y * width + x)];
      counts.push_back(static_cast<std::uint32_t>(pixel.size() / static_cast<std::size_t>(channels())));
      samples.insert(samples.end(), pixel.begin(), pixel.end());
    }
    ++y;
  };
  return source;
}

SampleImage make_image(int width, int height, int samples, std::vector<SampleGroup> groups, const SampleMaker& make,
                       std::uint64_t seed) {
  SampleImage image{width, height, std::move(groups), {}};
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::vector<float>& pixel = image.pixels.emplace_back();
      for (int i = 0; i < samples; ++i) {
        const std::vector<float> sample = make(x, y, random);
        pixel.insert(pixel.end(), sample.begin(), sample.end());
      }
    }
  }
  return image;
}

SampleImage make_wall(int width, int height, int samples, std::uint64_t seed, int moved) {
  using Kind = SampleGroup::Kind;
  return make_image(
      width, height, samples,
      {{Kind::kFeature, "albedo", 3},
       {Kind::kFeature, "depth", 1},
       {Kind::kFeature, "normal", 3},
       {Kind::kRandom, "random.light", 2},
       {Kind::kRandom, "random.pixel", 2}},
      [width, moved](int x, int y, Random& random) {
        const auto next = [&random] { return static_cast<float>(random.uniform()); };
        const bool is_left = x < width / 2;
        const float u = next();
        const float v = next();
        const float light = 2.0F * u;
        const float albedo = is_left ? 0.2F : 0.8F;
        const float px = next();
        const float py = next();
        const float depth = 3.0F + 0.01F * (static_cast<float>(y + moved) + py);
        return std::vector<float>{albedo * light,
                                  albedo * light,
                                  0.5F * albedo * light,
                                  albedo,
                                  albedo,
                                  0.5F * albedo,
                                  depth,
                                  0.0F,
                                  is_left ? 1.0F : 0.0F,
                                  is_left ? 0.0F : 1.0F,
                                  u,
                                  v,
                                  px,
                                  py};
      },
      seed);
}

FilteredImage filter_image(const SampleImage& image, const RpfParams& params, const Execution& execution,
                           const std::vector<SampleImage>& adjacent) {
  FilteredImage out;
  out.width = image.width;
  const auto size = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3;
  out.colour.resize(size);
  if (params.draws > 0) out.error.resize(size);
  const SampleSource source = image.source();
  std::vector<SampleSource> others;
  for (const SampleImage& other : adjacent) others.push_back(other.source());
  const auto store = [&](const RpfBand& band) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < band.colour[c].height(); ++y) {
        for (int x = 0; x < image.width; ++x) {
          const std::size_t i = static_cast<std::size_t>((band.y + y) * image.width + x) * 3 + c;
          out.colour[i] = band.colour[c].at(x, y);
          if (params.draws > 0) out.error[i] = band.error[c].at(x, y);
        }
      }
    }
  };
  out.report = filter_samples(source, params, execution, store, others);
  return out;
}

}  // namespace stein::test
