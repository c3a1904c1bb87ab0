// SPDX-License-Identifier: Apache-2.0
//
// A binary tree of boxes over anything that has boxes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "shapes.hpp"

namespace pathtracer {

class Bvh {
 public:
  Bvh() = default;
  /// Binned surface area heuristic (Wald 2007).
  explicit Bvh(std::span<const Bounds> boxes);

  /// Calls limit = visit(item, limit) for every item whose box the ray may meet before the distance `limit`, roughly
  /// from near to far. A limit below 0 ends the walk.
  template <class Visit>
  void walk(const Ray& ray, float limit, Visit&& visit) const;

 private:
  // The first child of an inner node follows it.
  struct Node {
    Bounds box;
    std::uint32_t index = 0;  // leaf: its first item in items_; inner: the second child
    std::uint16_t count = 0;  // items of a leaf; 0: inner
    std::uint16_t axis = 0;   // along which the children are apart
  };
  struct Builder;

  static constexpr int kMaxDepth = 64;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

namespace bvh_detail {

// Finite also along an axis: infinities would turn into NaN where the origin lies in the plane of a box.
inline float safe_inverse(float a) {
  constexpr float kSmallest = 1e-12F;
  return 1 / (std::abs(a) < kSmallest ? std::copysign(kSmallest, a) : a);
}

inline bool meets(const Bounds& box, Vec3 origin, Vec3 inverse, float limit) {
  constexpr float kRounding = 1 + 4e-7F;  // a box must not be missed by the error of the arithmetic
  const Vec3 a = (box.low - origin) * inverse;
  const Vec3 b = (box.high - origin) * inverse;
  const Vec3 near = min(a, b);
  const Vec3 far = max(a, b);
  const float enter = std::max({near.x, near.y, near.z, 0.0F});
  const float leave = std::min({far.x, far.y, far.z}) * kRounding;
  return enter <= leave && enter < limit;
}

}  // namespace bvh_detail

template <class Visit>
void Bvh::walk(const Ray& ray, float limit, Visit&& visit) const {
  if (nodes_.empty()) return;
  const Vec3 inverse = {bvh_detail::safe_inverse(ray.direction.x), bvh_detail::safe_inverse(ray.direction.y),
                        bvh_detail::safe_inverse(ray.direction.z)};
  std::array<std::uint32_t, kMaxDepth> waiting{};
  std::size_t waiting_count = 0;
  std::uint32_t current = 0;
  while (true) {
    const Node& node = nodes_[current];
    const bool is_met = bvh_detail::meets(node.box, ray.origin, inverse, limit);
    if (is_met && node.count == 0) {
      const bool second_is_nearer = ray.direction[node.axis] < 0;
      waiting[waiting_count++] = second_is_nearer ? current + 1 : node.index;
      current = second_is_nearer ? node.index : current + 1;
      continue;
    }
    for (std::uint32_t i = 0; is_met && i < node.count; ++i) {
      limit = visit(items_[node.index + i], limit);
      if (limit < 0) return;
    }
    if (waiting_count == 0) return;
    current = waiting[--waiting_count];
  }
}

}  // namespace pathtracer
