// SPDX-License-Identifier: Apache-2.0
//
// A scene that is ready to be rendered.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "camera.hpp"
#include "environment.hpp"
#include "geometry.hpp"
#include "lights.hpp"

namespace pathtracer {

class Scene {
 public:
  /// `geometry` with all shapes added.
  Scene(Geometry geometry, const Environment& environment, const Camera& camera)
      : parts_(std::make_unique<Parts>(std::move(geometry), environment)), camera_(camera) {}

  [[nodiscard]] const Geometry& geometry() const { return parts_->geometry; }
  [[nodiscard]] const Environment& environment() const { return parts_->environment; }
  [[nodiscard]] const Lights& lights() const { return parts_->lights; }
  [[nodiscard]] const Camera& camera() const { return camera_; }

 private:
  // They refer to each other, so they stay where they are when a scene is moved.
  struct Parts {
    Parts(Geometry shapes, const Environment& far_away) : geometry(std::move(shapes)), environment(far_away) {
      geometry.build_tree();
      lights = Lights(geometry, environment);
    }
    Geometry geometry;
    Environment environment;
    Lights lights;
  };

  std::unique_ptr<Parts> parts_;
  Camera camera_;
};

/// A scene that the program knows.
struct SceneEntry {
  const char* name;
  const char* summary;
  Scene (*make)();
};

[[nodiscard]] const std::vector<SceneEntry>& all_scenes();

/// @throws stein::Error kInvalidArgument listing the names that there are.
[[nodiscard]] Scene make_scene(const std::string& name);

}  // namespace pathtracer
