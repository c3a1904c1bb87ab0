// SPDX-License-Identifier: Apache-2.0
//
// Renders a scene into a stein::Accumulator, any number of samples for every pixel, in as many rounds as wanted.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "path.hpp"
#include "scene.hpp"
#include "stein/accumulate.hpp"
#include "stein/execution.hpp"

namespace pathtracer {

/// What a sample consists of: R, G, B, the features of `feature_layout()`, then what only raw samples have: the random
/// parameters and the second surface.
[[nodiscard]] const std::vector<std::string>& sample_channels();
/// The features of a film: albedo, normal, depth, position, visibility.
[[nodiscard]] std::vector<stein::FeatureLayout> feature_layout();

/// Receives the samples of rows 0, 1, ... as stein::exr::SampleWriter::write_row wants them.
using RowSink = std::function<void(const std::uint32_t* counts, const float* samples)>;

class Renderer {
 public:
  /// The scene must outlive this. @throws stein::Error kInvalidArgument for sides outside [1..2^16].
  Renderer(const Scene& scene, int width, int height, std::uint64_t seed, const PathSettings& settings = {});

  /// Adds counts[y * width + x] more samples to each pixel of `film`, continuing where the last round ended: two rounds
  /// of 4 samples give the bits of one of 8, with any number of threads. `film` has the size of the image and either
  /// `feature_layout()` or no features. Of `execution`, threads and progress hold.
  /// @throws stein::Error kInvalidArgument (the film does not fit), kCancelled: what was finished is in the film.
  void render(const std::uint32_t* counts, stein::Accumulator& film, const stein::Execution& execution = {});
  /// The same, also handing out every sample. Rows are rendered one by one.
  void render(const std::uint32_t* counts, stein::Accumulator& film, const stein::Execution& execution,
              const RowSink& sink);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

 private:
  class Round;

  [[nodiscard]] PathSample sample(int x, int y, std::uint32_t index) const;
  void check(const stein::Accumulator& film) const;

  const Scene& scene_;
  PathSettings settings_;
  std::uint64_t seed_;
  int width_;
  int height_;
  std::vector<std::uint32_t> taken_;  // samples so far of each pixel: the index of its next one
};

}  // namespace pathtracer
