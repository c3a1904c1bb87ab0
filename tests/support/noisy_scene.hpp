// SPDX-License-Identifier: Apache-2.0
//
// A synthetic scene whose noise is known exactly: Gaussian, with the covariances that a renderer would measure where a
// pixel's samples see one of two surfaces.
#pragma once

#include <array>
#include <vector>

#include "support/synthetic.hpp"

namespace stein::test {

struct NoisySceneParams {
  bool feature_noise = true;  ///< false: features are exact, and only the colour is noisy
  std::uint64_t seed = 1;
};

/// Left half: the rim of a lamp out of focus. Right half: a fine texture. Both are mixtures of two surfaces, which a
/// sample sees with probabilities p and 1 - p, so that colour and features of a pixel err together; and light noise
/// that the three channels share in part.
class NoisyScene {
 public:
  explicit NoisyScene(const NoisySceneParams& params);

  /// New noise on colours and features.
  void draw();

  [[nodiscard]] const Frame& frame() const { return owned_.frame(); }
  [[nodiscard]] int width() const { return owned_.frame().width; }
  [[nodiscard]] int height() const { return owned_.frame().height; }
  [[nodiscard]] double truth(std::size_t channel, int x, int y) const { return truth_[channel].row(y)[x]; }

 private:
  struct Channel {
    Plane* mean = nullptr;
    Plane* variance = nullptr;
    std::array<Plane*, 3> covariance{};  // with the colour channels; of colours only those that come before
  };
  void describe(int x, int y);

  NoisySceneParams params_;
  OwnedFrame owned_;
  Random random_;
  std::vector<Channel> channels_;  // R, G, B, then those of the features
  std::array<Plane, 3> truth_;
  std::vector<Plane> mean_;  // of each channel
  Plane mixing_;             // standard deviation of p's estimate: sqrt(p (1 - p) / n)
};

}  // namespace stein::test
