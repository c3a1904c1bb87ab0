// SPDX-License-Identifier: Apache-2.0
#include "exr/sample_layers.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "exr/component_order.hpp"
#include "exr/schema.hpp"
#include "stein/error.hpp"

namespace stein::exr {
namespace {

constexpr std::size_t kLongestName = 255;  // of OpenEXR
constexpr std::size_t kMostChannels = 4;   // of a feature

using Kind = SampleLayer::Kind;
using Components = std::map<std::string, std::string, ComponentOrder>;  // to full names

bool is_random(const std::string& feature) { return feature == "random" || feature.rfind("random.", 0) == 0; }

/// As in files of planes, a feature's alpha is no guide.
bool is_alpha(const std::string& component) { return component == "A" || component == "a"; }

SampleLayer colour_layer(const std::string& path, const std::vector<std::string>& names) {
  SampleLayer colour{Kind::kColour, {}, {"R", "G", "B"}};
  for (const std::string& name : colour.channels) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string list;
    for (const std::string& known : names) list += (list.empty() ? "" : ", ") + known;
    throw Error(ErrorCode::kInvalidFrame, "'" + path + "': its samples have no channel " + name +
                                              "; they need R, G, B, but have " + (list.empty() ? "no channels" : list));
  }
  return colour;
}

SampleLayer feature_layer(const std::string& path, const std::string& name, const Components& components) {
  SampleLayer layer{is_random(name) ? Kind::kRandom : Kind::kFeature, name, {}};
  for (const auto& component : components) layer.channels.push_back(component.second);
  if (layer.kind == Kind::kFeature && layer.channels.size() > kMostChannels) {
    throw Error(ErrorCode::kInvalidFrame, "'" + path + "': feature " + name + " has " +
                                              std::to_string(layer.channels.size()) + " channels; 1 to 4 are possible");
  }
  return layer;
}

}  // namespace

std::vector<SampleLayer> sample_layers(const std::string& path, const std::vector<std::string>& names) {
  std::map<std::string, Components> features;
  std::vector<SampleLayer> layers = {colour_layer(path, names)};
  std::vector<SampleLayer> others;
  for (const std::string& name : names) {
    const auto found = match(native_schema(), name);
    const Role role = found ? found->entry->role : Role::kNone;
    if (role == Role::kFeatureMean && (is_random(found->feature) || !is_alpha(found->component))) {
      features[found->feature].emplace(found->component, name);
    } else if (role != Role::kColour) {
      others.push_back({Kind::kOther, name, {name}});
    }
  }
  for (const Kind kind : {Kind::kFeature, Kind::kRandom}) {
    for (const auto& [name, components] : features) {
      if (is_random(name) == (kind == Kind::kRandom)) layers.push_back(feature_layer(path, name, components));
    }
  }
  layers.insert(layers.end(), others.begin(), others.end());
  return layers;
}

void check_channel_names(const std::string& action, const std::vector<std::string>& names) {
  const auto fail = [&](const std::string& why) { throw Error(ErrorCode::kInvalidArgument, action + ": " + why); };
  if (names.empty()) fail("no channels are given");
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty() || name.size() > kLongestName) fail("a channel's name must have 1 to 255 characters");
    if (!seen.insert(name).second) fail("channel " + name + " is given twice");
  }
}

std::vector<std::string> all_channels(const std::vector<SampleLayer>& layers) {
  std::vector<std::string> names;
  for (const SampleLayer& layer : layers) names.insert(names.end(), layer.channels.begin(), layer.channels.end());
  return names;
}

}  // namespace stein::exr
