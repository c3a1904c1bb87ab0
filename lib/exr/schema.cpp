// SPDX-License-Identifier: Apache-2.0
#include "exr/schema.hpp"

#include <algorithm>
#include <array>

namespace stein::exr {
namespace {

constexpr std::array kNativeEntries = {
    SchemaEntry{"<C>", Role::kColour},
    SchemaEntry{"A", Role::kAlpha},
    SchemaEntry{"sampleCount", Role::kSampleCount},
    SchemaEntry{"variance.<C>", Role::kColourVariance, VarianceOf::kMean},
    SchemaEntry{"covariance.<C>.<C>", Role::kColourCovariance, VarianceOf::kMean},
    SchemaEntry{"covariance.<C>.<feature>.<c>", Role::kFeatureCovariance, VarianceOf::kMean},
    SchemaEntry{"error.<c>", Role::kEarlierResult},
    SchemaEntry{"choice.<c>", Role::kEarlierResult},
    SchemaEntry{"density.<c>", Role::kEarlierResult},
    SchemaEntry{"noisy.<C>", Role::kNoisyColour},
    SchemaEntry{"<feature>.variance.<c>", Role::kFeatureVariance, VarianceOf::kMean},
    SchemaEntry{"<feature>.<c>", Role::kFeatureMean},
};

constexpr std::array kNativeFeatures = {
    KnownFeature{"albedo", "textures guide nothing"},
    KnownFeature{"normal", "creases of the geometry guide nothing"},
    KnownFeature{"depth", "edges between near and far guide nothing"},
    KnownFeature{"position", "places in the scene guide nothing"},
    KnownFeature{"visibility", "edges of shadows guide nothing"},
};

constexpr std::array<std::string_view, 11> kMainParts = {"",       "rgba", "RGBA", "rgb",      "RGB",  "beauty",
                                                         "Beauty", "C",    "main", "Combined", "color"};

std::vector<std::string_view> split(std::string_view name) {
  std::vector<std::string_view> tokens;
  std::size_t begin = 0;
  for (std::size_t dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.', begin)) {
    tokens.push_back(name.substr(begin, dot - begin));
    begin = dot + 1;
  }
  tokens.push_back(name.substr(begin));
  return tokens;
}

bool match_token(std::string_view pattern, std::string_view token, Match& result) {
  if (pattern == "<C>") {
    const std::size_t index = std::string_view("RGB").find(token);
    if (token.size() != 1 || index == std::string_view::npos) return false;
    result.colours.push_back(static_cast<int>(index));
    return true;
  }
  if (pattern == "<c>") {
    result.component = token;
    return !token.empty();
  }
  return pattern == token;
}

std::optional<Match> match_entry(const SchemaEntry& entry, const std::vector<std::string_view>& tokens) {
  const std::vector<std::string_view> pattern = split(entry.pattern);
  if (tokens.size() < pattern.size()) return std::nullopt;
  Match result;
  result.entry = &entry;
  std::size_t next = 0;
  for (const std::string_view item : pattern) {
    if (item == "<feature>") {
      // It alone can take more than one name part, so it takes all that the others leave.
      const std::size_t last = next + tokens.size() - pattern.size();
      for (; next <= last; ++next) {
        if (tokens[next].empty()) return std::nullopt;
        result.feature.append(result.feature.empty() ? "" : ".").append(tokens[next]);
      }
    } else if (!match_token(item, tokens[next++], result)) {
      return std::nullopt;
    }
  }
  if (next != tokens.size()) return std::nullopt;
  if (entry.role == Role::kColourCovariance && result.colours[0] == result.colours[1]) return std::nullopt;
  return result;
}

}  // namespace

bool Schema::knows_feature(std::string_view name) const {
  return std::any_of(features.begin(), features.end(), [&](const KnownFeature& known) { return known.name == name; });
}

const Schema& native_schema() {
  static constexpr Schema kSchema{kNativeEntries, kNativeFeatures, kMainParts};
  return kSchema;
}

std::optional<Match> match(const Schema& schema, std::string_view name) {
  const std::vector<std::string_view> tokens = split(name);
  for (const SchemaEntry& entry : schema.entries) {
    if (std::optional<Match> found = match_entry(entry, tokens)) return found;
  }
  return std::nullopt;
}

std::string describe(const Match& match) {
  const std::string of = match.entry->variance_of == VarianceOf::kMean ? " of the mean" : "";
  switch (match.entry->role) {
    case Role::kColour:
      return "colour, mean";
    case Role::kAlpha:
      return "alpha";
    case Role::kColourVariance:
      return "colour, variance" + of;
    case Role::kColourCovariance:
      return "colour, covariance" + of;
    case Role::kFeatureMean:
      return "feature " + match.feature + ", mean";
    case Role::kFeatureVariance:
      return "feature " + match.feature + ", variance" + of;
    case Role::kFeatureCovariance:
      return "feature " + match.feature + ", covariance" + of + " with the colour";
    case Role::kSampleCount:
      return "samples per pixel";
    case Role::kEarlierResult:
      return "earlier result, replaced on writing";
    case Role::kNoisyColour:
      return "noisy colour of an earlier run";
    case Role::kNone:
      break;
  }
  return {};
}

}  // namespace stein::exr
