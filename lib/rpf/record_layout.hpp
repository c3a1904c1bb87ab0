// SPDX-License-Identifier: Apache-2.0
//
// What is kept of a sample, and in which order.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "stein/rpf.hpp"

namespace stein::rpf {

/// The columns of a record: features, colour, position in the image, random parameters, and zeros up to a multiple of
/// 4. The order makes all that a sample may depend on neighbours of each other.
struct RecordLayout {
  int features = 0;
  int randoms = 0;
  int stride = 0;                  ///< columns with the padding
  int source_channels = 0;         ///< floats of a sample as the source gives it
  std::vector<int> feature_from;   ///< channel of the source, per feature column
  std::vector<int> random_from;    ///< per random column, without the first bounce's direction
  std::vector<bool> is_location;   ///< per feature column: varies over any surface
  std::vector<bool> is_clustered;  ///< per feature column: rejects neighbours
  std::array<int, 2> pixel_from = {-1, -1};
  std::array<int, 3> position_from = {-1, -1, -1};  ///< of the first and of the second hit, where the direction between
  std::array<int, 3> position2_from = {-1, -1, -1};  ///< them stands in for the light's random parameters
  std::vector<std::string> feature_names;
  std::vector<std::string> random_names;

  [[nodiscard]] int colour() const noexcept { return features; }
  [[nodiscard]] int position() const noexcept { return features + 3; }
  [[nodiscard]] int random() const noexcept { return features + 5; }
  [[nodiscard]] int columns() const noexcept { return features + 5 + randoms; }
  [[nodiscard]] bool has_first_bounce() const noexcept { return position2_from[0] >= 0; }
};

/// @throws Error kInvalidArgument (names that the source does not have), kInvalidFrame (a group without channels).
[[nodiscard]] RecordLayout make_layout(const SampleSource& source, const RpfParams& params);

}  // namespace stein::rpf
