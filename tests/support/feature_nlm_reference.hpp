// SPDX-License-Identifier: Apache-2.0
//
// Non-local means of a feature by its own patches (AOS sec. 6) as its description reads, in double, pixel by pixel.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/nlm_taps.hpp"
#include "prefilter/source.hpp"

namespace stein::test {

class FeatureNlmReference {
 public:
  FeatureNlmReference(const Source& source, std::size_t feature, const NlmWindow& window);

  /// The smoothed means of all channels, normalised.
  [[nodiscard]] std::vector<double> means(int x, int y) const;
  /// The derivative of a channel's mean by the pixel's own value, by central differences, cut off at 0 and 1; 0 where
  /// the feature is unusable.
  [[nodiscard]] double kept(int x, int y, std::size_t channel);

 private:
  [[nodiscard]] std::size_t index(int x, int y) const;
  [[nodiscard]] bool is_usable(int x, int y) const;
  void read(const Source& source, std::size_t feature, int x, int y);
  [[nodiscard]] double pair_distance(std::size_t a, std::size_t b) const;
  [[nodiscard]] double patch_distance(int ax, int ay, int bx, int by) const;

  NlmWindow window_;
  int width_;
  int height_;
  std::vector<std::vector<double>> means_;  // [channel][pixel]
  std::vector<double> noise_;
  std::vector<bool> is_usable_;
};

}  // namespace stein::test
