// SPDX-License-Identifier: Apache-2.0
#include "exr/layers.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "stein/error.hpp"

namespace stein::exr {
namespace {

constexpr const char* kAll = "all";
constexpr std::array<const char*, 3> kComponents = {".R", ".G", ".B"};

/// Numbers of objects and the like: their averages mean nothing. Cryptomatte keeps such numbers in float channels.
bool holds_numbers(const SourceChannel& channel, const std::string& full_name) {
  std::string name = full_name;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return channel.type == Imf::UINT || name.find("crypto") != std::string::npos;
}

class LayerFinder {
 public:
  LayerFinder(const SourceFile& file, const Layout& layout) : file_(file), layout_(layout) {}

  /// All that are light by their components, and alpha.
  [[nodiscard]] std::vector<LayerLayout> all() const {
    std::vector<LayerLayout> layers;
    std::set<std::string> seen;
    for (std::size_t i = 0; i < layout_.full_names.size(); ++i) {
      const std::string& name = layout_.full_names[i];
      if (name.size() < 3 || name.compare(name.size() - 2, 2, kComponents[0]) != 0) continue;
      const LayerLayout layer = named(name.substr(0, name.size() - 2));
      const auto is_other = [&](int channel) {
        return layout_.roles[static_cast<std::size_t>(channel)] == Role::kNone && fits(channel) &&
               !holds_numbers(at(channel), full_name(channel));
      };
      if (layer.mean.size() == 3 && std::all_of(layer.mean.begin(), layer.mean.end(), is_other) &&
          seen.insert(layer.name).second)
        layers.push_back(layer);
    }
    if (layout_.alpha >= 0) layers.push_back({full_name(layout_.alpha), {layout_.alpha}});
    return layers;
  }

  /// Without channels where there is no such layer.
  [[nodiscard]] LayerLayout named(const std::string& name) const {
    LayerLayout layer{name, {}};
    for (const char* component : kComponents) {
      const int channel = find(name + component);
      if (channel >= 0) layer.mean.push_back(channel);
    }
    if (layer.mean.size() == 3) return layer;
    const int single = find(name);
    layer.mean.clear();
    if (single >= 0) layer.mean.push_back(single);
    return layer;
  }

  [[nodiscard]] LayerLayout wanted(const std::string& name) const {
    LayerLayout layer = named(name);
    if (layer.mean.empty()) {
      fail("it has no layer '" + name + "': neither " + name +
           ".R, .G and .B nor a channel of that name; layers: " + list());
    }
    for (const int channel : layer.mean) {
      const Role role = layout_.roles[static_cast<std::size_t>(channel)];
      if (role != Role::kNone && role != Role::kAlpha && role != Role::kFeatureMean) {
        fail("'" + name + "' is no layer, but " + layout_.words[static_cast<std::size_t>(channel)] +
             "; layers: " + list());
      }
      if (holds_numbers(at(channel), full_name(channel))) {
        fail("layer '" + name + "' holds numbers of objects, whose averages mean nothing; leave it out");
      }
    }
    return layer;
  }

 private:
  [[nodiscard]] const SourceChannel& at(int channel) const {
    return file_.channels()[static_cast<std::size_t>(channel)];
  }
  [[nodiscard]] const std::string& full_name(int channel) const {
    return layout_.full_names[static_cast<std::size_t>(channel)];
  }

  [[nodiscard]] bool fits(int channel) const {
    return !at(channel).subsampled && !file_.is_deep(at(channel).part) &&
           file_.header(at(channel).part).dataWindow() == file_.header(layout_.main_part).dataWindow();
  }

  /// Of the file itself: what is read is also written there.
  [[nodiscard]] int find(const std::string& name) const {
    for (std::size_t i = 0; i < layout_.full_names.size(); ++i) {
      if (layout_.full_names[i] == name && file_.is_own(file_.channels()[i].part)) return static_cast<int>(i);
    }
    return -1;
  }

  [[nodiscard]] std::string list() const {
    std::string names;
    for (const LayerLayout& layer : all()) names += (names.empty() ? "" : ", ") + layer.name;
    return names.empty() ? "none" : names;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::kInvalidArgument, "'" + file_.path() + "': " + what);
  }

  const SourceFile& file_;
  const Layout& layout_;
};

}  // namespace

std::vector<LayerLayout> find_layers(const SourceFile& file, const Layout& layout,
                                     const std::vector<std::string>& names) {
  const LayerFinder finder(file, layout);
  std::vector<LayerLayout> layers;
  const auto add = [&](const LayerLayout& layer) {
    const bool is_new =
        std::none_of(layers.begin(), layers.end(), [&](const LayerLayout& l) { return l.name == layer.name; });
    if (is_new) layers.push_back(layer);
  };
  for (const std::string& name : names) {
    if (name != kAll) {
      add(finder.wanted(name));
      continue;
    }
    for (const LayerLayout& layer : finder.all()) add(layer);
  }
  return layers;
}

}  // namespace stein::exr
