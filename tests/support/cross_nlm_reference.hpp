// SPDX-License-Identifier: Apache-2.0
//
// Cross non-local means as the equations say, in double, one pixel and one sigma_r at a time.
#pragma once

#include <array>
#include <vector>

#include "support/cross_bilateral_reference.hpp"

namespace stein::test {

class CrossNlmReference {
 public:
  CrossNlmReference(const CrossNlmParams& params, const Source& source);

  /// SBF Eq. 10 and 5, with either distance.
  [[nodiscard]] std::array<double, 3> result(double sigma_r, int x, int y, const Nudge& nudge = {}) const;

  /// The sources in the pixel's window with their weights. An infinite sigma_r: by their guides alone.
  struct Neighbour {
    int x = 0;
    int y = 0;
    double weight = 0;
    std::array<double, 3> colour{};
  };
  [[nodiscard]] std::vector<Neighbour> neighbours(double sigma_r, int x, int y, const Nudge& nudge = {}) const;

  /// Joint SURE Eq. 2 by central differences of result().
  [[nodiscard]] std::array<double, 3> divergence(double sigma_r, int x, int y, Divergence divergence) const;

 private:
  struct Pixel {
    std::array<double, 3> colour{};
    std::array<double, 3> blurred{};
    double noise = 0;  ///< variance of `blurred`, sum over the channels
    bool is_source = false;
  };
  [[nodiscard]] const Pixel* source_at(const std::vector<Pixel>& pixels, int x, int y) const;
  void blur(std::vector<Pixel>& pixels, int x, int y) const;
  [[nodiscard]] double patch_distance(const std::vector<Pixel>& pixels, int xi, int yi, int xj, int yj) const;

  const CrossNlmParams& params_;
  const Source& source_;
  int width_;
  int height_;
  std::vector<Pixel> pixels_;
};

}  // namespace stein::test
