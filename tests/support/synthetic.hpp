// SPDX-License-Identifier: Apache-2.0
//
// Frames made by code, with the memory behind them, and filters run on them without the pipeline.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "filters/filter.hpp"
#include "stein/filters.hpp"
#include "stein/frame.hpp"

namespace stein::test {

/// Deterministic random numbers in [0, 1), the same on every platform (standard distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ULL + 1) {}
  double uniform();
  double normal();

 private:
  std::uint64_t state_;
};

struct FeatureShape {
  std::string name;
  int channels = 1;
};

/// A frame that owns its planes. Planes are found by name ("R", "variance.G", "normal.X", "normal.variance.X",
/// "sampleCount", "covariance.R.G", "covariance.R.normal.X").
class OwnedFrame {
 public:
  OwnedFrame(int width, int height, const std::vector<FeatureShape>& features, bool has_covariances = true);
  OwnedFrame(const OwnedFrame&) = delete;
  OwnedFrame& operator=(const OwnedFrame&) = delete;

  [[nodiscard]] const Frame& frame() const { return frame_; }
  [[nodiscard]] Frame& frame() { return frame_; }
  Plane& plane(const std::string& name);
  float& at(const std::string& name, int x, int y) { return plane(name).row(y)[x]; }
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  ConstPlaneView add(const std::string& name, float value);
  void add_covariances();

  Frame frame_;
  std::deque<std::pair<std::string, Plane>> planes_;
};

inline const std::vector<FeatureShape> kUsualFeatures = {{"normal", 3}, {"albedo", 3}, {"depth", 1}};

/// Random but plausible: a few regions with different features, texture, noise in everything, 8 samples per pixel.
void fill_random(OwnedFrame& target, std::uint64_t seed);

/// target(x, y) = source(f(x, y)) for all planes; sizes must agree.
template <class Map>
void copy_mapped(OwnedFrame& source, OwnedFrame& target, Map map) {
  for (const std::string& name : source.names()) {
    for (int y = 0; y < target.frame().height; ++y) {
      for (int x = 0; x < target.frame().width; ++x) {
        const auto [sx, sy] = map(x, y);
        target.at(name, x, y) = source.at(name, sx, sy);
      }
    }
  }
}

/// What a filter gave: planes[candidate][channel].
struct BankResult {
  std::vector<std::array<Plane, 3>> result;
  std::vector<std::array<Plane, 3>> divergence;  ///< empty where the filter does not know its derivative
  int halo = 0;
};

/// Runs a filter over the whole frame in tiles, in one thread.
struct RunOptions {
  int tile_width = 64;
  int tile_height = 32;
  Divergence divergence = Divergence::kJoint;
  std::optional<Perturbation> perturbation = std::nullopt;
  bool counts = false;
};
BankResult run_filter(const FilterSpec& spec, const Frame& frame, const RunOptions& options = {});

/// The same with the divergence from one run on perturbed input: D = b (F' - F) / step.
BankResult run_with_draw(const FilterSpec& spec, const Frame& frame, const Perturbation& draw);

}  // namespace stein::test
