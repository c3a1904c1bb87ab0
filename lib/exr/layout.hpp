// SPDX-License-Identifier: Apache-2.0
//
// Which channel of a file is what, under a mapping.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "exr/mapping.hpp"
#include "exr/schema.hpp"
#include "exr/source_file.hpp"

namespace stein::exr {

/// All channels are indices into SourceFile::channels(); -1: the file has none.
struct FeatureLayout {
  std::string name;
  std::vector<int> mean;
  std::vector<int> variance;    ///< empty or one per mean
  std::vector<int> covariance;  ///< empty or [colour * mean.size() + k]
  VarianceOf variance_of = VarianceOf::kMean;
};

struct Layout {
  int main_part = -1;  ///< the part with the colour
  /// Per channel, without the view, qualified by its part where that is not the main one; empty: of another view.
  std::vector<std::string> full_names;
  std::vector<Role> roles;         ///< per channel
  std::vector<std::string> words;  ///< per channel: the role in words, empty for Role::kNone
  std::array<int, 3> colour = {-1, -1, -1};
  std::array<int, 3> variance = {-1, -1, -1};
  VarianceOf variance_of = VarianceOf::kMean;    ///< of the colour
  std::array<int, 3> covariance = {-1, -1, -1};  ///< RG, RB, GB; all or none
  int alpha = -1;
  int sample_count = -1;
  std::vector<FeatureLayout> features;
  std::vector<std::string> missing;  ///< in words; nothing about sample counts
};

/// @throws Error kInvalidFrame for a feature of which the file holds only some planes, or too many channels;
/// kInvalidArgument for maps of channels that the file lacks.
[[nodiscard]] Layout lay_out(const SourceFile& file, const Mapping& mapping);

struct ChannelNames {
  int main_part = -1;             ///< the part that holds the colour (-1: none)
  std::vector<std::string> full;  ///< per channel
};
/// `own`: the channels' names in their parts; empty for those that do not count.
[[nodiscard]] ChannelNames name_channels(const SourceFile& file, const Schema& schema,
                                         const std::vector<std::string>& own);

}  // namespace stein::exr
