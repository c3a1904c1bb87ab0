// SPDX-License-Identifier: Apache-2.0
//
// Adaptive against uniform sampling with the same number of samples, on the scenes of the path tracer. Prints the table
// of docs/quality.md.
#include "stein/adaptive.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "metrics/metrics.hpp"
#include "renderer.hpp"
#include "scene.hpp"
#include "stein/accumulate.hpp"
#include "stein/denoise.hpp"

namespace {

struct Settings {
  int width = 192;
  int height = 144;
  int seeds = 4;
  std::uint32_t reference_samples = 1024;
};

constexpr std::array<std::uint32_t, 4> kSamples = {8, 16, 32, 64};
constexpr std::uint64_t kReferenceSeed = 1000;  // of no image that is measured

// Relative MSE, mean over the seeds.
struct Errors {
  double input = 0;  // unfiltered, uniform
  double uniform = 0;
  double adaptive = 0;
};

stein::metrics::Rgb rgb(const std::array<stein::Plane, 3>& planes) {
  return {planes[0].view(), planes[1].view(), planes[2].view()};
}

// A renderer with its film.
class Render {
 public:
  Render(const pathtracer::Scene& scene, const Settings& settings, std::uint64_t seed, bool has_features)
      : renderer_(scene, settings.width, settings.height, seed),
        film_(settings.width, settings.height, layout(has_features)) {}

  stein::Frame add(const std::vector<std::uint32_t>& counts) {
    renderer_.render(counts.data(), film_);
    return moments_.emplace(film_.moments()).frame();
  }
  stein::Frame add_everywhere(std::uint32_t samples) {
    const auto pixels = static_cast<std::size_t>(film_.width()) * static_cast<std::size_t>(film_.height());
    return add(std::vector<std::uint32_t>(pixels, samples));
  }

 private:
  static stein::SampleLayout layout(bool has_features) {
    stein::SampleLayout layout;
    if (has_features) layout.features = pathtracer::feature_layout();
    return layout;
  }

  pathtracer::Renderer renderer_;
  stein::Accumulator film_;
  std::optional<stein::Moments> moments_;
};

std::array<Errors, kSamples.size()> measure(const pathtracer::Scene& scene, const stein::metrics::Rgb& reference,
                                            const Settings& settings) {
  std::array<Errors, kSamples.size()> errors;
  const auto error_of = [&](const stein::metrics::Rgb& image) {
    return stein::metrics::compare(image, reference).rel_mse / settings.seeds;
  };
  for (int s = 1; s <= settings.seeds; ++s) {
    const auto seed = static_cast<std::uint64_t>(s);
    Render uniform(scene, settings, seed, true);
    std::uint32_t taken = 0;
    for (std::size_t i = 0; i < kSamples.size(); ++i) {
      const stein::Frame frame = uniform.add_everywhere(kSamples[i] - taken);
      taken = kSamples[i];
      errors[i].input += error_of(frame.colour);
      stein::AdaptiveParams params;
      params.denoise.filters = {stein::CrossBilateralParams{}};  // as in the table of docs/quality.md
      errors[i].uniform += error_of(rgb(stein::denoise(frame, params.denoise).colour));

      Render adaptive(scene, settings, seed, true);
      params.budget = std::int64_t{settings.width} * settings.height * kSamples[i];
      const stein::AdaptiveResult result = stein::denoise_adaptively(
          settings.width, settings.height,
          [&](const std::vector<std::uint32_t>& counts) { return adaptive.add(counts); }, params);
      errors[i].adaptive += error_of(rgb(result.result.colour));
    }
  }
  return errors;
}

// The reference's own error falls as 1/n, like that of the input.
double reference_error(const std::array<Errors, kSamples.size()>& errors, const Settings& settings) {
  return errors.back().input * kSamples.back() / (kSamples.back() + settings.reference_samples);
}

void print_tables(const Settings& settings) {
  std::printf(
      "| scene, samples | input | uniform | adaptive | adaptive / uniform | times the samples |\n"
      "|---|---|---|---|---|---|\n");
  std::array<double, kSamples.size()> log_ratios{};
  double worst = 0;
  std::size_t scenes = 0;
  for (const pathtracer::SceneEntry& entry : pathtracer::all_scenes()) {
    const pathtracer::Scene scene = pathtracer::make_scene(entry.name);
    Render reference_render(scene, settings, kReferenceSeed, false);
    const stein::Frame reference = reference_render.add_everywhere(settings.reference_samples);
    const auto errors = measure(scene, reference.colour, settings);
    const double offset = reference_error(errors, settings);
    for (std::size_t i = 0; i < kSamples.size(); ++i) {
      const Errors& e = errors[i];
      const double ratio = (e.adaptive - offset) / (e.uniform - offset);
      std::printf("| %s %u | %.5f | %.5f | %.5f | %.2f | %.1f |\n", std::string(entry.name).c_str(), kSamples[i],
                  e.input - offset, e.uniform - offset, e.adaptive - offset, ratio,
                  (e.input - offset) / (e.adaptive - offset));
      log_ratios[i] += std::log(ratio);
      worst = std::max(worst, ratio);
    }
    std::fflush(stdout);
    ++scenes;
  }
  std::printf("\nadaptive / uniform, geometric means:");
  for (std::size_t i = 0; i < kSamples.size(); ++i)
    std::printf(" %u: %.3f", kSamples[i], std::exp(log_ratios[i] / static_cast<double>(scenes)));
  std::printf("; worst %.3f\n", worst);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 1 && argc != 5) {
    std::fprintf(stderr, "usage: stein_adaptive_quality [WIDTH HEIGHT SEEDS REFERENCE_SAMPLES]\n");
    return 2;
  }
  try {
    Settings settings;
    if (argc == 5) {
      settings.width = std::stoi(argv[1]);
      settings.height = std::stoi(argv[2]);
      settings.seeds = std::stoi(argv[3]);
      settings.reference_samples = static_cast<std::uint32_t>(std::stoul(argv[4]));
    }
    print_tables(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stein_adaptive_quality: %s\n", error.what());
    return 1;
  }
  return 0;
}
