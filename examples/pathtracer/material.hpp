// SPDX-License-Identifier: Apache-2.0
//
// Materials, and how a surface scatters light at one point.
#pragma once

#include "random.hpp"
#include "texture.hpp"
#include "vec3.hpp"

namespace pathtracer {

enum class Surface {
  kDiffuse,  ///< Lambert
  kGlossy,   ///< a rough reflecting coat (GGX) over a diffuse base; with a black base a metal
  kMirror,
  kGlass,  ///< smooth; closed, solid objects only
};

struct Material {
  Surface surface = Surface::kDiffuse;
  Texture colour{Colour(0.7F)};     ///< reflectance of diffuse surfaces and bases, tint of mirrors and glass
  Colour specular = Colour(0.04F);  ///< glossy: reflectance of the coat seen from the front
  float roughness = 0.3F;           ///< glossy: [0.03, 1], the square root of GGX's alpha
  float refraction = 1.5F;          ///< glass: index
  Colour emission{};                ///< radiance, on the front side only

  [[nodiscard]] bool is_emitter() const { return emission != Colour(); }
  [[nodiscard]] bool is_specular() const { return surface == Surface::kMirror || surface == Surface::kGlass; }
};

/// A point of a surface, seen by a ray.
struct SurfacePoint {
  Vec3 position;
  Vec3 geometric_normal;  ///< of the front side
  Vec3 normal;            ///< interpolated, on the same side
  Vec2 uv;
  const Material* material = nullptr;
  int light = -1;  ///< index of the light that the shape is, -1: none
};

struct Scattered {
  Vec3 direction;
  Colour weight;  ///< value * cosine / pdf; 0: absorbed
  float pdf = 0;  ///< per solid angle; meaningless for mirrors and glass, which have one direction
};

/// The reflection and transmission of one point towards a viewer. All directions point away from the surface.
class Bsdf {
 public:
  Bsdf(const SurfacePoint& point, Vec3 to_viewer);

  /// Value times cosine towards a light. 0 for mirrors and glass.
  [[nodiscard]] Colour value_cosine(Vec3 to_light) const;
  /// The density with which `sample` chooses that direction.
  [[nodiscard]] float pdf(Vec3 to_light) const;
  [[nodiscard]] Scattered sample(Random& random) const;

  [[nodiscard]] bool is_specular() const { return material_.is_specular(); }
  [[nodiscard]] Colour albedo() const;                   ///< about the part of the light that is scattered
  [[nodiscard]] Vec3 normal() const { return normal_; }  ///< on the viewer's side

 private:
  [[nodiscard]] bool is_reflected(Vec3 to_light, Vec3 local) const;
  [[nodiscard]] Colour coat_value_cosine(Vec3 local) const;
  [[nodiscard]] float coat_pdf(Vec3 local) const;
  [[nodiscard]] Colour base_value_cosine(Vec3 local) const;
  [[nodiscard]] Scattered sample_rough(Random& random) const;
  [[nodiscard]] Scattered sample_glass(Random& random) const;

  const Material& material_;
  Colour colour_;
  Vec3 geometric_normal_;  // on the viewer's side
  Vec3 normal_;            // on the viewer's side
  bool from_front_;
  Basis basis_;
  Vec3 viewer_;                 // local
  float coat_probability_ = 0;  // of sampling the coat rather than the base
};

/// The part of unpolarised light that a smooth boundary reflects; `ratio` = index of this side / of the other.
[[nodiscard]] float dielectric_reflectance(float cosine, float ratio);

}  // namespace pathtracer
