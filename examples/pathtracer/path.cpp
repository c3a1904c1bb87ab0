// SPDX-License-Identifier: Apache-2.0
#include "path.hpp"

#include <algorithm>
#include <utility>

#include "sampling.hpp"

namespace pathtracer {
namespace {

constexpr int kSureBounces = 4;  // before paths may end by chance

class PathTracer {
 public:
  PathTracer(const Scene& scene, const Ray& ray, Random& random, const PathSettings& settings)
      : scene_(scene), settings_(settings), random_(random), ray_(ray) {}

  PathSample trace() {
    for (int bounce = 0;; ++bounce) {
      Hit hit;
      if (!scene_.geometry().intersect(ray_, hit)) {
        add_environment();
        break;
      }
      length_ += hit.at.distance;
      const SurfacePoint point = scene_.geometry().surface_point(ray_, hit);
      if (point.light >= 0) add_emission(point);
      const Bsdf bsdf(point, -ray_.direction);
      record_features(point, bsdf);
      if (bounce == settings_.max_bounces) break;
      if (!bsdf.is_specular()) add_direct_light(point, bsdf);
      if (!scatter(point, bsdf) || !survives(bounce)) break;
    }
    return sample_;
  }

 private:
  enum class Recorded { kNothing, kFirst, kBoth };

  /// The weight of a light that a ray met by itself, whose point could have been chosen on it with density `light_pdf`.
  [[nodiscard]] float scattered_weight(float light_pdf) const {
    if (is_specular_ || settings_.direct_light == DirectLight::kScattered) return 1;
    return settings_.direct_light == DirectLight::kLights ? 0.0F : power_heuristic(scatter_pdf_, light_pdf);
  }

  void add_environment() {
    const Colour radiance = scene_.environment().radiance(ray_.direction);
    if (radiance == Colour()) return;
    sample_.colour += throughput_ * radiance * scattered_weight(scene_.lights().environment_pdf(ray_.direction));
  }

  void add_emission(const SurfacePoint& point) {
    if (dot(ray_.direction, point.geometric_normal) >= 0) return;  // its back
    const float pdf = scene_.lights().pdf(point, ray_.origin, ray_.time);
    sample_.colour += throughput_ * point.material->emission * scattered_weight(pdf);
  }

  void record_features(const SurfacePoint& point, const Bsdf& bsdf) {
    if (recorded_ == Recorded::kFirst) {
      sample_.position2 = point.position;
      sample_.normal2 = bsdf.normal();
      recorded_ = Recorded::kBoth;
    }
    if (recorded_ != Recorded::kNothing || bsdf.is_specular()) return;
    recorded_ = Recorded::kFirst;
    sample_.albedo = point.light >= 0 ? Colour() : throughput_ * bsdf.albedo();
    sample_.normal = bsdf.normal();
    sample_.depth = length_;
    sample_.position = point.position;
    is_first_ = true;
  }

  void add_direct_light(const SurfacePoint& point, const Bsdf& bsdf) {
    const Vec2 u = random_.uniform2();
    const bool is_first = std::exchange(is_first_, false);
    if (is_first) sample_.light = u;
    if (settings_.direct_light == DirectLight::kScattered) return;
    const LightSample light = scene_.lights().sample(point.position, ray_.time, u);
    const Colour value = light.pdf > 0 ? bsdf.value_cosine(light.direction) : Colour();
    if (value == Colour()) return;
    constexpr float kShort = 1 - 1e-4F;  // the other half of a rectangle is not in the way
    const Ray shadow = {ray_start(point, light.direction), light.direction, ray_.time};
    if (scene_.geometry().is_occluded(shadow, light.distance * kShort, light.shape)) return;
    if (is_first) sample_.visibility = 1;
    const float weight =
        settings_.direct_light == DirectLight::kLights ? 1.0F : power_heuristic(light.pdf, bsdf.pdf(light.direction));
    sample_.colour += throughput_ * value * light.radiance * (weight / light.pdf);
  }

  bool scatter(const SurfacePoint& point, const Bsdf& bsdf) {
    const Scattered scattered = bsdf.sample(random_);
    if (scattered.weight == Colour()) return false;
    throughput_ *= scattered.weight;
    scatter_pdf_ = scattered.pdf;
    is_specular_ = bsdf.is_specular();
    ray_.origin = ray_start(point, scattered.direction);
    ray_.direction = scattered.direction;
    return true;
  }

  // Russian roulette: dim paths end early, and the others stand for them.
  bool survives(int bounce) {
    if (bounce < kSureBounces) return true;
    const float probability = std::min(largest(throughput_), 1.0F);
    if (random_.uniform() >= probability) return false;
    throughput_ = throughput_ / probability;
    return true;
  }

  const Scene& scene_;
  const PathSettings& settings_;
  Random& random_;
  Ray ray_;
  PathSample sample_;
  Colour throughput_ = Colour(1);
  float length_ = 0;
  float scatter_pdf_ = 0;
  bool is_specular_ = true;  // was the last bounce? The camera counts as such: no point on a light was chosen for it
  bool is_first_ = false;    // is this the surface of the features?
  Recorded recorded_ = Recorded::kNothing;
};

}  // namespace

PathSample trace_path(const Scene& scene, const Ray& ray, Random& random, const PathSettings& settings) {
  return PathTracer(scene, ray, random, settings).trace();
}

}  // namespace pathtracer
