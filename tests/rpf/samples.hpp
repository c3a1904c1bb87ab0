// SPDX-License-Identifier: Apache-2.0
//
// Samples made by code.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "stein/rpf.hpp"
#include "support/synthetic.hpp"

namespace stein::test {

/// All samples of an image in memory.
struct SampleImage {
  int width = 0;
  int height = 0;
  std::vector<SampleGroup> groups;
  std::vector<std::vector<float>> pixels;  ///< values of each pixel's samples, one after the other

  [[nodiscard]] int channels() const;
  [[nodiscard]] std::vector<float>& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
  /// From the top again with each call.
  [[nodiscard]] SampleSource source() const;
};

using SampleMaker = std::function<std::vector<float>(int x, int y, Random& random)>;

/// `samples` in each pixel, each made by `make`.
[[nodiscard]] SampleImage make_image(int width, int height, int samples, std::vector<SampleGroup> groups,
                                     const SampleMaker& make, std::uint64_t seed = 7);

/// A wall of two materials, lit with noise that depends on random.light; features normal, albedo and depth,
/// position within the pixel. `moved`: how
/// many pixels up the wall has gone.
[[nodiscard]] SampleImage make_wall(int width, int height, int samples, std::uint64_t seed = 7, int moved = 0);

struct FilteredImage {
  int width = 0;
  std::vector<float> colour;  ///< pixel by pixel, three
  std::vector<float> error;   ///< likewise, or empty
  RpfReport report;
  [[nodiscard]] float at(int x, int y, int channel) const {
    return colour[static_cast<std::size_t>((y * width + x) * 3 + channel)];
  }
};

/// How to run with so many threads.
[[nodiscard]] inline Execution on_threads(int threads) {
  Execution execution;
  execution.threads = threads;
  return execution;
}

[[nodiscard]] FilteredImage filter_image(const SampleImage& image, const RpfParams& params,
                                         const Execution& execution = on_threads(1),
                                         const std::vector<SampleImage>& adjacent = {});

}  // namespace stein::test
