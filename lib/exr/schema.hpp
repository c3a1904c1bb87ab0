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

#include "stein/exr.hpp"

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
  kNoise,          ///< describes the noise, but is not used
};

// Attributes of the part with the colour.
constexpr const char* kSamplesPerPixel = "samplesPerPixel";          ///< where there is no channel sampleCount
constexpr const char* kDegreesOfFreedom = "stein:degreesOfFreedom";  ///< Frame::degrees_of_freedom, float

/// Placeholders of a pattern: `<C>` is R, G or B; `<rgb>` the same, or r, g or b; `<X>` X, Y or Z; `<c>` one name part;
/// `<feature>` one or more name parts; `<layer>` and `<image>` one or more that are the same all over the file; `*` any
/// characters but dots. Anything else stands for itself.
struct SchemaEntry {
  std::string_view pattern;
  Role role = Role::kNone;
  VarianceOf variance_of = VarianceOf::kAsStated;  ///< as stated: it is no variance
  std::string_view feature = {};                   ///< its name, where the pattern has no `<feature>`
  std::string_view component = {};                 ///< where the pattern has no placeholder for it
};

/// A feature that needs no variance to be recognised, and what is lost without it.
struct KnownFeature {
  std::string_view name;
  std::string_view loss;
};

/// What the variances of the colour are told in.
enum class VarianceSpace : std::uint8_t { kRgb, kXyz };

struct Schema {
  std::string_view name;      ///< as an option has it
  std::string_view renderer;  ///< in words
  /// A file is of this schema if each pattern (or, of "a|b", one of them) matches one of its channels.
  std::span<const std::string_view> signature;
  std::span<const SchemaEntry> entries;  ///< the first that matches counts
  std::span<const KnownFeature> features;
  std::span<const std::string_view> main_parts;  ///< usual names of the part that holds the colour
  VarianceSpace variance_space = VarianceSpace::kRgb;
  bool zero_variance_is_unknown = false;
  std::string_view samples_attribute = kSamplesPerPixel;
  /// Taken where nothing says how many and all variances are of the mean; 0: the number must be known.
  float assumed_samples = 0;
  std::span<const std::string_view> assumptions = {};  ///< in words
  /// Files that belong together, as endings of their names without ".exr"; the first holds the colour.
  std::span<const std::string_view> companions = {};
  std::string_view without_variance = {};  ///< what to do about it, in words

  [[nodiscard]] bool knows_feature(std::string_view name) const;
};

/// What `<layer>` and `<image>` stand for in a file.
struct Bindings {
  std::string layer;
  std::string image;
};

struct Match {
  const SchemaEntry* entry = nullptr;
  std::vector<int> colours;  ///< 0..2, one per `<C>` and `<X>`
  std::string feature;
  std::string component;
  Bindings bindings;
};

/// All of them, in the order of detection.
[[nodiscard]] std::span<const Schema> schemas();

/// The schema of docs/inputs.md.
[[nodiscard]] const Schema& native_schema();

/// @throws Error kInvalidArgument naming the schemas there are.
[[nodiscard]] std::vector<const Schema*> schemas_named(std::string_view name);

/// Whether a name matches one pattern; empty bindings match anything, and are then filled.
[[nodiscard]] std::optional<Match> match_pattern(std::string_view pattern, std::string_view name,
                                                 const Bindings& bindings = {});

[[nodiscard]] std::optional<Match> match(const Schema& schema, std::string_view name, const Bindings& bindings = {});

/// " of the mean" and the like.
[[nodiscard]] std::string words_of(VarianceOf variance_of);

/// The role in words, such as "feature albedo, variance of the mean".
[[nodiscard]] std::string describe(const Match& match, VarianceOf variance_of);

}  // namespace stein::exr
