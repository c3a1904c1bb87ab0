// SPDX-License-Identifier: Apache-2.0
#include "exr/layout.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "exr/component_order.hpp"
#include "exr/views.hpp"

namespace stein::exr {
namespace {

/// A channel for one purpose: of several, the one whose row of the schema comes first.
struct Slot {
  int channel = -1;
  const SchemaEntry* by = nullptr;
};

struct Planes {
  Slot mean;
  Slot variance;
  std::array<Slot, 3> covariance;
};

bool has_variance(const Planes& planes) { return planes.variance.channel >= 0; }

using Layer = std::map<std::string, Planes, ComponentOrder>;  // by component

constexpr const char* kColourMap = "colour";
constexpr const char* kSamplesMap = "samples";

class LayoutBuilder {
 public:
  LayoutBuilder(const SourceFile& file, const Mapping& mapping)
      : file_(file), mapping_(mapping), schema_(*mapping.schema) {}

  Layout build() {
    ChannelNames names = name_channels(file_, schema_, names_in_view(file_, mapping_.view));
    layout_.main_part = names.main_part;
    layout_.full_names = std::move(names.full);
    layout_.roles.assign(file_.channels().size(), Role::kNone);
    layout_.words.resize(file_.channels().size());
    for (const PlaneMap& map : mapping_.maps) apply(map);
    for (std::size_t i = 0; i < file_.channels().size(); ++i) assign(i);
    for (std::size_t c = 0; c < 3; ++c) {
      layout_.colour[c] = colour_[c].channel;
      layout_.variance[c] = variance_[c].channel;
    }
    for (const KnownFeature& known : schema_.features) {
      const auto layer = layers_.find(std::string(known.name));
      if (layer == layers_.end() || !add_feature(layer->first, layer->second)) {
        note("no " + std::string(known.name) + ": " + std::string(known.loss));
      }
    }
    for (const auto& [name, layer] : layers_) {
      if (!schema_.knows_feature(name)) add_feature(name, layer);
    }
    settle_covariances();
    return std::move(layout_);
  }

 private:
  void note(const std::string& words) { layout_.missing.push_back(words); }

  void set_role(int channel, Role role, const std::string& words) {
    if (channel < 0) return;
    layout_.roles[static_cast<std::size_t>(channel)] = role;
    layout_.words[static_cast<std::size_t>(channel)] = words;
  }

  [[nodiscard]] VarianceOf kind(VarianceOf stated) const {
    return mapping_.variance_of == VarianceOf::kAsStated ? stated : mapping_.variance_of;
  }

  [[nodiscard]] bool is_mapped(const std::string& plane) const {
    return std::any_of(mapping_.maps.begin(), mapping_.maps.end(), [&](const PlaneMap& m) { return m.plane == plane; });
  }

  /// Whether the caller gave a colour with variances of its own, so that the file's covariances are of another one.
  [[nodiscard]] bool has_other_colour() const {
    return std::any_of(mapping_.maps.begin(), mapping_.maps.end(),
                       [](const PlaneMap& m) { return m.plane == kColourMap && !m.variance.empty(); });
  }

  [[nodiscard]] int find(const std::string& name, const PlaneMap& map) const {
    const auto found = std::find(layout_.full_names.begin(), layout_.full_names.end(), name);
    if (found != layout_.full_names.end()) return static_cast<int>(found - layout_.full_names.begin());
    std::string list;
    for (const std::string& known : layout_.full_names) {
      if (!known.empty()) list += (list.empty() ? "" : ", ") + known;
    }
    throw Error(ErrorCode::kInvalidArgument, "'" + file_.path() + "': it has no channel " + name + " for " + map.plane +
                                                 ", as the map says; it has " + list);
  }

  /// What the caller says stands above every schema.
  void apply(const PlaneMap& map) {
    static constexpr SchemaEntry kMapped{"", Role::kNone, VarianceOf::kMean};
    const bool is_colour = map.plane == kColourMap;
    for (std::size_t k = 0; k < map.mean.size(); ++k) {
      const int mean = find(map.mean[k], map);
      mapped_.insert(mean);
      if (map.plane == kSamplesMap) {
        layout_.sample_count = mean;
        set_role(mean, Role::kSampleCount, "samples per pixel");
        continue;
      }
      Planes& planes = layers_[map.plane][std::to_string(k)];
      (is_colour ? colour_[k] : planes.mean) = {mean, &kMapped};
      if (is_colour) set_role(mean, Role::kColour, "colour, mean");
      if (is_colour && k == 0) layout_.main_part = file_.channels()[static_cast<std::size_t>(mean)].part;
      if (map.variance.empty()) continue;
      const int variance = find(map.variance[k], map);
      mapped_.insert(variance);
      (is_colour ? variance_[k] : planes.variance) = {variance, &kMapped};
      if (is_colour) layout_.variance_of = kind(VarianceOf::kMean);
      if (is_colour) set_role(variance, Role::kColourVariance, "colour, variance" + words_of(layout_.variance_of));
    }
    if (is_colour) layers_.erase(map.plane);
  }

  void take(Slot& slot, const Match& found, int channel) {
    if (slot.channel >= 0 && slot.by <= found.entry) {
      set_role(channel, Role::kNone, "");
      return;
    }
    set_role(slot.channel, Role::kNone, "");
    slot = {channel, found.entry};
  }

  void assign(std::size_t index) {
    const SourceChannel& channel = file_.channels()[index];
    const int at = static_cast<int>(index);
    const bool holds_planes = !file_.is_deep(channel.part) && !layout_.full_names[index].empty();
    if (!holds_planes || mapped_.count(at) > 0) return;
    const auto found = match(schema_, layout_.full_names[index], mapping_.bindings);
    if (!found || !names_seen_.insert(layout_.full_names[index]).second) return;
    const Role role = found->entry->role;
    const VarianceOf of = kind(found->entry->variance_of);
    const auto colour = found->colours.empty() ? 0 : static_cast<std::size_t>(found->colours[0]);
    const bool is_of_feature =
        role == Role::kFeatureMean || role == Role::kFeatureVariance || role == Role::kFeatureCovariance;
    const bool is_covariance = role == Role::kFeatureCovariance || role == Role::kColourCovariance;
    if (is_covariance && has_other_colour()) return;
    if (is_of_feature) {
      if (!is_mapped(found->feature)) assign_feature(*found, of, at);
      return;
    }
    const bool is_in_main = channel.part == layout_.main_part;
    if (is_mapped(role == Role::kColour ? kColourMap : role == Role::kSampleCount ? kSamplesMap : "")) return;
    set_role(at, role, describe(*found, of));
    if (role == Role::kColour && is_in_main) take(colour_[colour], *found, at);
    if (role == Role::kColourVariance &&
        !(variance_[colour].channel >= 0 && mapped_.count(variance_[colour].channel))) {
      take(variance_[colour], *found, at);
      layout_.variance_of = of;
    }
    if (role == Role::kColourCovariance) {
      layout_.covariance[static_cast<std::size_t>(found->colours[0] + found->colours[1] - 1)] = at;
    }
    if (role == Role::kAlpha && is_in_main) layout_.alpha = at;
    if (role == Role::kSampleCount) layout_.sample_count = at;
  }

  /// Means and variances get their roles once it is known which layers are features.
  void assign_feature(const Match& found, VarianceOf of, int channel) {
    Planes& planes = layers_[found.feature][found.component];
    if (found.entry->role == Role::kFeatureMean) take(planes.mean, found, channel);
    if (found.entry->role == Role::kFeatureVariance) {
      take(planes.variance, found, channel);
    }
    if (found.entry->role == Role::kFeatureCovariance) {
      set_role(channel, found.entry->role, describe(found, of));
      planes.covariance[static_cast<std::size_t>(found.colours[0])] = {channel, found.entry};
    }
  }

  bool add_feature(const std::string& name, const Layer& layer) {
    std::vector<std::pair<std::string, Planes>> parts;
    for (const auto& [component, planes] : layer) {
      const bool is_alpha = component == "A" || component == "a";
      if (planes.mean.channel >= 0 && (!is_alpha || has_variance(planes))) parts.emplace_back(component, planes);
    }
    const auto noisy = std::count_if(parts.begin(), parts.end(), [](const auto& p) { return has_variance(p.second); });
    if (parts.empty() || (noisy == 0 && !schema_.knows_feature(name) && !is_mapped(name))) return false;
    const auto count = static_cast<std::ptrdiff_t>(parts.size());
    if (count > 4) fail("feature " + name + " has " + std::to_string(count) + " channels; 1 to 4 are possible");
    FeatureLayout feature{name, {}, {}, {}, VarianceOf::kMean};
    for (const auto& [component, planes] : parts) {
      feature.mean.push_back(planes.mean.channel);
      set_role(planes.mean.channel, Role::kFeatureMean, "feature " + name + ", mean");
      if (noisy == 0) continue;
      if (!has_variance(planes)) {
        fail_without_variance(name, component);
      }
      feature.variance_of = kind(planes.variance.by->variance_of);
      feature.variance.push_back(planes.variance.channel);
      set_role(planes.variance.channel, Role::kFeatureVariance,
               "feature " + name + ", variance" + words_of(feature.variance_of));
    }
    if (noisy == 0) {
      note("no variance of feature " + name + " (" + name +
           ".variance.*): it is taken as free of noise, and what noise it has stays in "
           "the image");
    }
    for (std::size_t colour = 0; colour < 3; ++colour) {
      for (const auto& part : parts) feature.covariance.push_back(part.second.covariance[colour].channel);
    }
    layout_.features.push_back(std::move(feature));
    return true;
  }

  void settle_covariances() {
    const auto absent = [](int channel) { return channel < 0; };
    bool any = false;
    std::string without;
    for (FeatureLayout& feature : layout_.features) {
      if (std::any_of(feature.covariance.begin(), feature.covariance.end(), absent)) {
        feature.covariance.clear();
        without += (without.empty() ? "" : ", ") + feature.name;
      } else {
        any = true;
      }
    }
    if (!layout_.features.empty() && !any) {
      note("no covariances of colour and features (covariance.<R|G|B>.<feature>.*): risk is plain SURE");
    } else if (!without.empty()) {
      note("no covariances of the colour with " + without + ": their part of the risk is that of plain SURE");
    }
    if (std::any_of(layout_.covariance.begin(), layout_.covariance.end(), absent)) {
      layout_.covariance = {-1, -1, -1};
      note("no covariances of the colour channels (covariance.R.G, R.B, G.B): their noise is taken as independent");
    }
  }

  [[noreturn]] void fail_without_variance(const std::string& feature, const std::string& component) const {
    std::string plane = feature;
    plane.append(".variance.").append(component);
    fail("feature " + feature + " has variances, but no " + plane +
         "; write the variance of all of its channels or of none");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::kInvalidFrame, "'" + file_.path() + "': " + what);
  }

  const SourceFile& file_;
  const Mapping& mapping_;
  const Schema& schema_;
  Layout layout_;
  std::array<Slot, 3> colour_;
  std::array<Slot, 3> variance_;
  std::set<int> mapped_;  // channels
  std::set<std::string> names_seen_;
  std::map<std::string, Layer> layers_;
};

}  // namespace

Layout lay_out(const SourceFile& file, const Mapping& mapping) { return LayoutBuilder(file, mapping).build(); }

}  // namespace stein::exr
