// SPDX-License-Identifier: Apache-2.0
#include "exr/layout.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "exr/component_order.hpp"

namespace stein::exr {
namespace {

struct Planes {
  int mean = -1;
  int variance = -1;
  std::array<int, 3> covariance = {-1, -1, -1};
};

bool has_variance(const Planes& planes) { return planes.variance >= 0; }

using Layer = std::map<std::string, Planes, ComponentOrder>;  // by component

class LayoutBuilder {
 public:
  LayoutBuilder(const SourceFile& file, const Schema& schema) : file_(file), schema_(schema) {}

  Layout build() {
    layout_.main_part = find_main_part(file_, schema_);
    layout_.full_names = full_names(file_, schema_, layout_.main_part);
    layout_.roles.assign(file_.channels().size(), Role::kNone);
    layout_.words.resize(file_.channels().size());
    for (std::size_t i = 0; i < file_.channels().size(); ++i) assign(i);
    for (const KnownFeature& known : schema_.features) {
      const auto layer = layers_.find(std::string(known.name));
      if (layer == layers_.end() || !add_feature(layer->first, layer->second)) {
        note("no " + std::string(known.name) + ": " + std::string(known.loss));
      }
    }
    for (const auto& [name, layer] : layers_) {
      if (!schema_.knows_feature(name) && !add_feature(name, layer)) add_extra_layer(name, layer);
    }
    settle_covariances();
    return std::move(layout_);
  }

 private:
  void note(const std::string& words) { layout_.missing.push_back(words); }

  /// Deep parts hold no planes, and another view (the other eye of a stereo pair) is another image.
  [[nodiscard]] bool takes_part(int part) const {
    if (file_.is_deep(part)) return false;
    const auto view = [&](int p) { return file_.header(p).hasView() ? file_.header(p).view() : std::string(); };
    return layout_.main_part < 0 || view(part).empty() || view(part) == view(layout_.main_part);
  }

  void set_role(int channel, Role role, const std::string& words) {
    if (channel < 0) return;
    layout_.roles[static_cast<std::size_t>(channel)] = role;
    layout_.words[static_cast<std::size_t>(channel)] = words;
  }

  void assign(std::size_t index) {
    const SourceChannel& channel = file_.channels()[index];
    if (!takes_part(channel.part)) return;
    const auto found = match(schema_, layout_.full_names[index]);
    if (!found || !names_seen_.insert(layout_.full_names[index]).second) return;
    const Role role = found->entry->role;
    const int at = static_cast<int>(index);
    const auto colour = found->colours.empty() ? 0 : static_cast<std::size_t>(found->colours[0]);
    // Means and variances get their roles once it is known which layers are features.
    if (role != Role::kFeatureMean && role != Role::kFeatureVariance) set_role(at, role, describe(*found));
    if (role == Role::kColour && channel.part == layout_.main_part) layout_.colour[colour] = at;
    if (role == Role::kColourVariance) layout_.variance[colour] = at;
    if (role == Role::kColourCovariance) {
      layout_.covariance[static_cast<std::size_t>(found->colours[0] + found->colours[1] - 1)] = at;
    }
    if (role == Role::kAlpha && channel.part == layout_.main_part) layout_.alpha = at;
    if (role == Role::kSampleCount) layout_.sample_count = at;
    if (role == Role::kFeatureMean) layers_[found->feature][found->component].mean = at;
    if (role == Role::kFeatureVariance) layers_[found->feature][found->component].variance = at;
    if (role == Role::kFeatureCovariance) layers_[found->feature][found->component].covariance[colour] = at;
  }

  bool add_feature(const std::string& name, const Layer& layer) {
    std::vector<std::pair<std::string, Planes>> parts;
    for (const auto& [component, planes] : layer) {
      const bool is_alpha = component == "A" || component == "a";
      if (planes.mean >= 0 && (!is_alpha || has_variance(planes))) parts.emplace_back(component, planes);
    }
    const auto noisy = std::count_if(parts.begin(), parts.end(), [](const auto& p) { return has_variance(p.second); });
    if (parts.empty() || (noisy == 0 && !schema_.knows_feature(name))) return false;
    const auto count = static_cast<std::ptrdiff_t>(parts.size());
    if (count > 4) fail("feature " + name + " has " + std::to_string(count) + " channels; 1 to 4 are possible");
    FeatureLayout feature{name, {}, {}, {}};
    for (const auto& [component, planes] : parts) {
      feature.mean.push_back(planes.mean);
      set_role(planes.mean, Role::kFeatureMean, "feature " + name + ", mean");
      if (noisy == 0) continue;
      if (!has_variance(planes)) {
        fail_without_variance(name, component);
      }
      feature.variance.push_back(planes.variance);
      set_role(planes.variance, Role::kFeatureVariance, "feature " + name + ", variance of the mean");
    }
    if (noisy == 0) {
      note("no variance of feature " + name + " (" + name + ".variance.*): it is taken as free of noise");
    }
    for (std::size_t colour = 0; colour < 3; ++colour) {
      for (const auto& part : parts) feature.covariance.push_back(part.second.covariance[colour]);
    }
    layout_.features.push_back(std::move(feature));
    return true;
  }

  void add_extra_layer(const std::string& name, const Layer& layer) {
    LayerLayout extra{name, {}};
    for (std::size_t colour = 0; colour < 3; ++colour) {
      const auto found = layer.find(std::string(1, "RGB"[colour]));
      if (found == layer.end() || found->second.mean < 0) return;
      extra.mean[colour] = found->second.mean;
    }
    layout_.extra_layers.push_back(std::move(extra));
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
  const Schema& schema_;
  Layout layout_;
  std::set<std::string> names_seen_;
  std::map<std::string, Layer> layers_;
};

}  // namespace

Layout lay_out(const SourceFile& file, const Schema& schema) { return LayoutBuilder(file, schema).build(); }

}  // namespace stein::exr
