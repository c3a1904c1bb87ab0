// SPDX-License-Identifier: Apache-2.0
#include "scenes/scenes.hpp"

#include "stein/error.hpp"

namespace pathtracer {

const std::vector<SceneEntry>& all_scenes() {
  static const std::vector<SceneEntry> scenes = {
      {"cornell", "a box with coloured walls, a metal and a glass ball", cornell},
      {"cornell-defocus", "the box with a row of balls, seen through a wide lens", cornell_defocus},
      {"spheres", "coloured balls, a mirror among them, and their soft shadows", spheres},
      {"tea-table", "glazed teapot and cups on a wooden table", tea_table},
      {"motion", "billiard balls, some of them rolling while the shutter is open", motion},
      {"colonnade", "sun in a colonnade of textured stone", colonnade},
  };
  return scenes;
}

Scene make_scene(const std::string& name) {
  std::string names;
  for (const SceneEntry& entry : all_scenes()) {
    if (name == entry.name) return entry.make();
    names += std::string(names.empty() ? "" : ", ") + entry.name;
  }
  throw stein::Error(stein::ErrorCode::kInvalidArgument, "there is no scene '" + name + "'; there are: " + names);
}

}  // namespace pathtracer
