// SPDX-License-Identifier: Apache-2.0
#include "lights.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sampling.hpp"

namespace pathtracer {
namespace {

float area(const Triangle& t) { return length(cross(t.edge1, t.edge2)) / 2; }

float area(const Geometry& geometry, std::uint32_t shape) {
  if (geometry.is_triangle(shape)) return area(geometry.triangle(shape));
  const float radius = geometry.sphere(shape).radius;
  return 4 * kPi * radius * radius;
}

// 1 - cosine of the half angle under which a sphere is seen; 0 from within, where it sheds no light.
float visible_cone(const Sphere& s, Vec3 to_centre) {
  const float sine2 = s.radius * s.radius / dot(to_centre, to_centre);
  return sine2 < 1 ? sine2 / (1 + std::sqrt(1 - sine2)) : 0.0F;
}

}  // namespace

Lights::Lights(Geometry& geometry, const Environment& environment) : geometry_(&geometry), environment_(&environment) {
  std::vector<float> power;
  for (std::uint32_t shape = 0; shape < geometry.shape_count(); ++shape) {
    const Material& material = geometry.material(shape);
    if (!material.is_emitter()) continue;
    geometry.set_light(shape, static_cast<int>(shapes_.size()));
    shapes_.push_back(shape);
    power.push_back(kPi * mean(material.emission) * area(geometry, shape));
  }
  float total = 0;
  for (const float p : power) total += p;
  // What the environment sends to a point cannot be told from what it sends to the scene: it gets half of the samples.
  if (!environment.is_black()) {
    power.push_back(power.empty() ? 1 : total);
    total += power.back();
  }
  float sum = 0;
  for (const float p : power) upper_.push_back((sum += p) / total);
  if (!upper_.empty()) upper_.back() = 1;
}

// Leaves in `u` what is left of its randomness.
std::size_t Lights::choose(float& u) const {
  const auto at = std::upper_bound(upper_.begin(), upper_.end() - 1, u);
  const auto light = static_cast<std::size_t>(at - upper_.begin());
  const float below = light > 0 ? upper_[light - 1] : 0;
  u = std::clamp((u - below) / (upper_[light] - below), 0.0F, 1 - 0x1p-24F);
  return light;
}

LightSample Lights::sample_triangle(const Triangle& t, Vec3 from, float time, Vec2 u) const {
  const Vec2 w = uniform_triangle(u);
  const Vec3 way = t.corner + t.motion * time + t.edge1 * w.x + t.edge2 * w.y - from;
  const float distance = length(way);
  const Vec3 direction = way / distance;
  const Vec3 normal = cross(t.edge1, t.edge2);  // twice the area long
  const float facing = -dot(direction, normal);
  if (!(facing > 0)) return {};
  return {direction, distance, {}, 2 * distance * distance / facing, kNoShape};
}

LightSample Lights::sample_sphere(const Sphere& s, Vec3 from, float time, Vec2 u) const {
  const Vec3 to_centre = s.centre + s.motion * time - from;
  const float cone = visible_cone(s, to_centre);
  if (cone == 0) return {};
  const Vec3 direction = normalised(Basis(normalised(to_centre)).to_world(uniform_cone(u, cone)));
  const float along = dot(to_centre, direction);
  const Vec3 aside = to_centre - direction * along;
  const float half = std::sqrt(std::max(0.0F, s.radius * s.radius - dot(aside, aside)));
  return {direction, along - half, {}, uniform_cone_pdf(cone), kNoShape};
}

LightSample Lights::sample(Vec3 from, float time, Vec2 u) const {
  if (upper_.empty()) return {};
  const std::size_t light = choose(u.x);
  LightSample sample;
  if (light == shapes_.size()) {
    const EnvironmentSample chosen = environment_->sample(u);
    sample = {chosen.direction, kInfinity, chosen.radiance, chosen.pdf, kNoShape};
  } else {
    const std::uint32_t shape = shapes_[light];
    sample = geometry_->is_triangle(shape) ? sample_triangle(geometry_->triangle(shape), from, time, u)
                                           : sample_sphere(geometry_->sphere(shape), from, time, u);
    sample.radiance = geometry_->material(shape).emission;
    sample.shape = shape;
  }
  sample.pdf *= probability(light);
  return sample;
}

float Lights::pdf(const SurfacePoint& point, Vec3 from, float time) const {
  const auto light = static_cast<std::size_t>(point.light);
  const std::uint32_t shape = shapes_[light];
  if (geometry_->is_triangle(shape)) {
    const Vec3 way = point.position - from;
    const float distance2 = dot(way, way);
    const float facing = -dot(way, point.geometric_normal) / std::sqrt(distance2);
    return probability(light) * distance2 / (std::max(facing, 1e-8F) * area(geometry_->triangle(shape)));
  }
  const Sphere& s = geometry_->sphere(shape);
  const float cone = visible_cone(s, s.centre + s.motion * time - from);
  return cone > 0 ? probability(light) * uniform_cone_pdf(cone) : 0;
}

float Lights::environment_pdf(Vec3 direction) const {
  return upper_.size() > shapes_.size() ? probability(shapes_.size()) * environment_->pdf(direction) : 0;
}

}  // namespace pathtracer
