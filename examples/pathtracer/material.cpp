// SPDX-License-Identifier: Apache-2.0
#include "material.hpp"

#include <algorithm>
#include <cmath>

#include "ggx.hpp"
#include "sampling.hpp"

namespace pathtracer {
namespace {

// Schlick 1994.
Colour coat_reflectance(Colour front, float cosine) {
  const float c = 1 - std::clamp(cosine, 0.0F, 1.0F);
  const float c2 = c * c;
  return front + (Colour(1) - front) * (c2 * c2 * c);
}

float alpha_of(const Material& material) { return material.roughness * material.roughness; }

// An interpolated normal may face away from a viewer who sees the surface; the true one does not.
Vec3 usable_normal(const SurfacePoint& point, Vec3 to_viewer) {
  const float side = dot(point.geometric_normal, to_viewer) < 0 ? -1.0F : 1.0F;
  const Vec3 normal = point.normal * side;
  constexpr float kGrazing = 1e-3F;
  return dot(normal, to_viewer) > kGrazing ? normal : point.geometric_normal * side;
}

}  // namespace

float dielectric_reflectance(float cosine, float ratio) {
  const float sine2 = ratio * ratio * (1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  const float other = std::sqrt(1 - sine2);
  const float parallel = (cosine - ratio * other) / (cosine + ratio * other);
  const float perpendicular = (ratio * cosine - other) / (ratio * cosine + other);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

Bsdf::Bsdf(const SurfacePoint& point, Vec3 to_viewer)
    : material_(*point.material),
      colour_(material_.colour.at(point.uv)),
      normal_(usable_normal(point, to_viewer)),
      from_front_(dot(point.geometric_normal, to_viewer) >= 0),
      basis_(normal_) {
  geometric_normal_ = from_front_ ? point.geometric_normal : -point.geometric_normal;
  viewer_ = basis_.to_local(to_viewer);
  viewer_.z = std::max(viewer_.z, 1e-6F);
  if (material_.surface == Surface::kGlossy) {
    const Colour coat = coat_reflectance(material_.specular, viewer_.z);
    const float base = mean((Colour(1) - coat) * colour_);
    coat_probability_ = base > 0 ? std::clamp(mean(coat) / (mean(coat) + base), 0.1F, 0.9F) : 1.0F;
  }
}

Colour Bsdf::albedo() const {
  return material_.surface == Surface::kGlossy ? colour_ * (Colour(1) - material_.specular) + material_.specular
                                               : colour_;
}

// Above the shading normal's horizon and on the same side of the true surface.
bool Bsdf::is_reflected(Vec3 to_light, Vec3 local) const { return local.z > 0 && dot(to_light, geometric_normal_) > 0; }

Colour Bsdf::coat_value_cosine(Vec3 local) const {
  const float alpha = alpha_of(material_);
  const Vec3 half = normalised(local + viewer_);
  const float common = ggx::distribution(half, alpha) * ggx::shadowing(viewer_, local, alpha) / (4 * viewer_.z);
  return coat_reflectance(material_.specular, dot(half, viewer_)) * common;
}

float Bsdf::coat_pdf(Vec3 local) const {
  return ggx::reflection_pdf(viewer_, normalised(local + viewer_), alpha_of(material_));
}

// Light crosses the coat twice. Symmetric in both directions, and never more than arrives.
Colour Bsdf::base_value_cosine(Vec3 local) const {
  if (material_.surface == Surface::kDiffuse) return colour_ * (local.z / kPi);
  const Colour in = Colour(1) - coat_reflectance(material_.specular, local.z);
  const Colour out = Colour(1) - coat_reflectance(material_.specular, viewer_.z);
  return colour_ * in * out * (local.z / kPi);
}

Colour Bsdf::value_cosine(Vec3 to_light) const {
  const Vec3 local = basis_.to_local(to_light);
  if (is_specular() || !is_reflected(to_light, local)) return {};
  const Colour base = base_value_cosine(local);
  return material_.surface == Surface::kGlossy ? base + coat_value_cosine(local) : base;
}

float Bsdf::pdf(Vec3 to_light) const {
  const Vec3 local = basis_.to_local(to_light);
  if (is_specular() || !is_reflected(to_light, local)) return 0;
  const float base = local.z / kPi * (1 - coat_probability_);
  return coat_probability_ > 0 ? base + coat_probability_ * coat_pdf(local) : base;
}

Scattered Bsdf::sample_rough(Random& random) const {
  const bool choose_coat = random.uniform() < coat_probability_;
  const Vec2 u = random.uniform2();
  Vec3 local;
  if (choose_coat) {
    const Vec3 half = ggx::sample_visible(viewer_, alpha_of(material_), u);
    local = half * (2 * dot(half, viewer_)) - viewer_;
  } else {
    local = cosine_hemisphere(u);
  }
  Scattered scattered;
  scattered.direction = normalised(basis_.to_world(local));
  scattered.pdf = pdf(scattered.direction);
  if (scattered.pdf > 0) scattered.weight = value_cosine(scattered.direction) / scattered.pdf;
  return scattered;
}

// Refraction also changes radiance by the square of the index; it is left out, as what enters leaves again and no light
// is inside.
Scattered Bsdf::sample_glass(Random& random) const {
  const float ratio = from_front_ ? 1 / material_.refraction : material_.refraction;
  const float cosine = std::min(viewer_.z, 1.0F);
  if (random.uniform() < dielectric_reflectance(cosine, ratio)) {
    return {basis_.to_world({-viewer_.x, -viewer_.y, viewer_.z}), colour_, 0};
  }
  const float depth = std::sqrt(std::max(0.0F, 1 - ratio * ratio * (1 - cosine * cosine)));
  return {normalised(basis_.to_world({-viewer_.x * ratio, -viewer_.y * ratio, -depth})), colour_, 0};
}

Scattered Bsdf::sample(Random& random) const {
  switch (material_.surface) {
    case Surface::kMirror:
      return {basis_.to_world({-viewer_.x, -viewer_.y, viewer_.z}), colour_, 0};
    case Surface::kGlass:
      return sample_glass(random);
    case Surface::kDiffuse:
    case Surface::kGlossy:
      break;
  }
  return sample_rough(random);
}

}  // namespace pathtracer
