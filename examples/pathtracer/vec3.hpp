// SPDX-License-Identifier: Apache-2.0
//
// Three floats: points, directions, colours.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pathtracer {

constexpr float kPi = std::numbers::pi_v<float>;

struct Vec2 {
  float x = 0;
  float y = 0;
};

struct Vec3 {
  float x = 0;
  float y = 0;
  float z = 0;

  constexpr Vec3() = default;
  constexpr Vec3(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Vec3(float all) : x(all), y(all), z(all) {}

  [[nodiscard]] constexpr float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr Vec3& operator+=(Vec3 b) { return *this = Vec3(x + b.x, y + b.y, z + b.z); }
  constexpr Vec3& operator*=(Vec3 b) { return *this = Vec3(x * b.x, y * b.y, z * b.z); }
  friend constexpr bool operator==(Vec3, Vec3) = default;
};

using Colour = Vec3;  // linear Rec. 709

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(float s, Vec3 a) { return a * s; }
constexpr Vec3 operator/(Vec3 a, float s) { return a * (1 / s); }

constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalised(Vec3 a) { return a / length(a); }

constexpr Vec3 lerp(Vec3 a, Vec3 b, float t) { return a * (1 - t) + b * t; }
constexpr float largest(Vec3 a) { return std::max({a.x, a.y, a.z}); }
constexpr float mean(Vec3 a) { return (a.x + a.y + a.z) / 3; }
constexpr Vec3 min(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
constexpr Vec3 max(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

/// Three orthonormal axes of which z is given.
class Basis {
 public:
  explicit Basis(Vec3 z) : z_(z) {
    const Vec3 other = std::abs(z.x) > 0.7F ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    x_ = normalised(cross(other, z));
    y_ = cross(z, x_);
  }
  [[nodiscard]] Vec3 to_world(Vec3 a) const { return x_ * a.x + y_ * a.y + z_ * a.z; }
  [[nodiscard]] Vec3 to_local(Vec3 a) const { return {dot(a, x_), dot(a, y_), dot(a, z_)}; }

 private:
  Vec3 x_, y_, z_;
};

}  // namespace pathtracer
