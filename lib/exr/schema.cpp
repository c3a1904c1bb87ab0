// SPDX-License-Identifier: Apache-2.0
#include "exr/schema.hpp"

#include <algorithm>
#include <set>

#include "stein/error.hpp"

namespace stein::exr {
namespace {

/// Parts between dots, none of them empty.
bool is_parts(std::string_view text) {
  return !text.empty() && text.front() != '.' && text.back() != '.' && text.find("..") == std::string_view::npos;
}

bool is_one_part(std::string_view text) { return !text.empty() && text.find('.') == std::string_view::npos; }

class Matcher {
 public:
  explicit Matcher(const Bindings& bindings) { match_.bindings = bindings; }

  bool run(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern.front() == '*') return wildcard(pattern.substr(1), name);
    if (pattern.front() != '<') {
      return !name.empty() && name.front() == pattern.front() && run(pattern.substr(1), name.substr(1));
    }
    const std::size_t end = pattern.find('>');
    return placeholder(pattern.substr(1, end - 1), pattern.substr(end + 1), name);
  }

  [[nodiscard]] Match result() const { return match_; }

 private:
  bool wildcard(std::string_view rest, std::string_view name) {
    for (std::size_t length = 0; length <= name.size(); ++length) {
      if (run(rest, name.substr(length))) return true;
      if (length < name.size() && name[length] == '.') return false;
    }
    return false;
  }

  bool placeholder(std::string_view what, std::string_view rest, std::string_view name) {
    if (what == "C") return colour("RGB", rest, name);
    if (what == "rgb") return colour("RGB", rest, name) || colour("rgb", rest, name);
    if (what == "X") return colour("XYZ", rest, name);
    if (what == "c") return text(match_.component, is_one_part, rest, name);
    if (what == "feature") return text(match_.feature, is_parts, rest, name);
    std::string& bound = what == "layer" ? match_.bindings.layer : match_.bindings.image;
    if (bound.empty()) return text(bound, is_parts, rest, name);
    return name.substr(0, bound.size()) == bound && run(rest, name.substr(bound.size()));
  }

  bool colour(std::string_view letters, std::string_view rest, std::string_view name) {
    const std::size_t index = name.empty() ? std::string_view::npos : letters.find(name.front());
    if (index == std::string_view::npos) return false;
    match_.colours.push_back(static_cast<int>(index));
    match_.component = name.front();
    if (run(rest, name.substr(1))) return true;
    match_.colours.pop_back();
    return false;
  }

  bool text(std::string& into, bool (*fits)(std::string_view), std::string_view rest, std::string_view name) {
    for (std::size_t length = 1; length <= name.size(); ++length) {
      if (!fits(name.substr(0, length))) continue;
      into = name.substr(0, length);
      if (run(rest, name.substr(length))) return true;
    }
    into.clear();
    return false;
  }

  Match match_;
};

}  // namespace

bool Schema::knows_feature(std::string_view feature) const {
  return std::any_of(features.begin(), features.end(),
                     [&](const KnownFeature& known) { return known.name == feature; });
}

std::vector<const Schema*> schemas_named(std::string_view name) {
  std::vector<const Schema*> found;
  std::set<std::string> names;
  for (const Schema& schema : schemas()) {
    names.emplace(schema.name);
    if (schema.name == name) found.push_back(&schema);
  }
  if (!found.empty()) return found;
  std::string list;
  for (const std::string& known : names) list += (list.empty() ? "" : ", ") + known;
  throw Error(ErrorCode::kInvalidArgument, "there is no preset '" + std::string(name) + "'; there are " + list);
}

std::optional<Match> match_pattern(std::string_view pattern, std::string_view name, const Bindings& bindings) {
  Matcher matcher(bindings);
  if (!matcher.run(pattern, name)) return std::nullopt;
  return matcher.result();
}

std::optional<Match> match(const Schema& schema, std::string_view name, const Bindings& bindings) {
  for (const SchemaEntry& entry : schema.entries) {
    std::optional<Match> found = match_pattern(entry.pattern, name, bindings);
    if (!found) continue;
    if (entry.role == Role::kColourCovariance && found->colours[0] == found->colours[1]) continue;
    found->entry = &entry;
    if (!entry.feature.empty()) found->feature = entry.feature;
    if (!entry.component.empty()) found->component = entry.component;
    return found;
  }
  return std::nullopt;
}

std::string words_of(VarianceOf variance_of) {
  switch (variance_of) {
    case VarianceOf::kMean:
      return " of the mean";
    case VarianceOf::kSample:
      return " of single samples";
    case VarianceOf::kSecondMoment:
      return " from the mean of squares";
    case VarianceOf::kAsStated:
      break;
  }
  return {};
}

std::string describe(const Match& match, VarianceOf variance_of) {
  const std::string of = words_of(variance_of);
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
    case Role::kNoise:
      return "noise, not used";
    case Role::kNone:
      break;
  }
  return {};
}

}  // namespace stein::exr
