// SPDX-License-Identifier: Apache-2.0
//
// Schemas: tables from channel names to what the channel is, and what its variance is the variance of. A further
// renderer's names are a further table.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stein::exr {

enum class Role : std::uint8_t {
  kNone,  ///< not ours: carried over
  kColour,
  kAlpha,
  kColourVariance,
  kColourCovariance,
  kFeatureMean,
  kFeatureVariance,
  kFeatureCovariance,
  kSampleCount,
  kEarlierResult,  ///< written by an earlier run; says nothing about the next result
  kNoisyColour,    ///< the input of an earlier run
};

// Attributes of the part with the colour.
constexpr const char* kSamplesPerPixel = "samplesPerPixel";          ///< where there is no channel sampleCount
constexpr const char* kDegreesOfFreedom = "stein:degreesOfFreedom";  ///< Frame::degrees_of_freedom, float

enum class VarianceOf : std::uint8_t { kNothing, kMean };

/// Tokens of a pattern, separated by dots: `<C>` is R, G or B; `<feature>` one or more name parts; `<c>` one name part;
/// anything else stands for itself.
struct SchemaEntry {
  std::string_view pattern;
  Role role = Role::kNone;
  VarianceOf variance_of = VarianceOf::kNothing;
};

/// A feature that needs no variance to be recognised, and what is lost without it.
struct KnownFeature {
  std::string_view name;
  std::string_view loss;
};

struct Schema {
  std::span<const SchemaEntry> entries;  ///< the first that matches counts
  std::span<const KnownFeature> features;
  std::span<const std::string_view> main_parts;  ///< usual names of the part that holds the colour

  [[nodiscard]] bool knows_feature(std::string_view name) const;
};

struct Match {
  const SchemaEntry* entry = nullptr;
  std::vector<int> colours;  ///< 0..2, one per `<C>`
  std::string feature;
  std::string component;
};

/// The schema of docs/inputs.md.
[[nodiscard]] const Schema& native_schema();

[[nodiscard]] std::optional<Match> match(const Schema& schema, std::string_view name);

/// The role in words, such as "feature albedo, variance of the mean".
[[nodiscard]] std::string describe(const Match& match);

}  // namespace stein::exr
