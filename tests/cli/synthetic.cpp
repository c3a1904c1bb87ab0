// SPDX-License-Identifier: Apache-2.0
#include "synthetic.hpp"

#include <cstddef>
#include <random>
#include <utility>

#include "stein/error.hpp"
#include "stein/exr.hpp"

float& Channels::at(const std::string& name, int x, int y) {
  return values.at(name).at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(x));
}

Channels noisy_image(int width, int height, unsigned seed) {
  Channels image{width, height, {}};
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::mt19937 random(seed);
  const auto noisy = [&](const std::string& mean, const std::string& variance, float left, float right,
                         float amplitude) {
    std::vector<float>& means = image.values[mean];
    means.resize(pixels);
    image.values[variance].assign(pixels, amplitude * amplitude / 12);
    for (std::size_t i = 0; i < pixels; ++i) {
      const bool is_left = 2 * (i % static_cast<std::size_t>(width)) < static_cast<std::size_t>(width);
      const float uniform = static_cast<float>(random() % 10000) / 10000.0F - 0.5F;
      means[i] = (is_left ? left : right) + amplitude * uniform;
    }
  };
  noisy("R", "variance.R", 0.2F, 0.8F, 0.3F);
  noisy("G", "variance.G", 0.3F, 0.6F, 0.3F);
  noisy("B", "variance.B", 0.4F, 0.4F, 0.3F);
  noisy("normal.X", "normal.variance.X", -1.0F, 0.0F, 0.0F);
  noisy("normal.Y", "normal.variance.Y", 0.0F, 0.0F, 0.0F);
  noisy("normal.Z", "normal.variance.Z", 0.0F, 1.0F, 0.0F);
  noisy("albedo.R", "albedo.variance.R", 0.2F, 0.8F, 0.02F);
  noisy("albedo.G", "albedo.variance.G", 0.3F, 0.6F, 0.02F);
  noisy("albedo.B", "albedo.variance.B", 0.4F, 0.4F, 0.02F);
  image.values["sampleCount"].assign(pixels, 8);
  image.values["id.Z"].assign(pixels, 42);
  return image;
}

Channels flat_image(int width, int height, float value) {
  Channels image{width, height, {}};
  for (const char* name : {"R", "G", "B"}) {
    image.values[name].assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value);
  }
  return image;
}

void write(const std::string& path, const Channels& image) {
  std::vector<std::pair<std::string, stein::ConstPlaneView>> planes;
  for (const auto& [name, values] : image.values) {
    planes.emplace_back(name, stein::ConstPlaneView(values.data(), image.width, image.height));
  }
  stein::exr::write_planes(path, planes);
}

bool has_channel(const std::string& path, const std::string& name) {
  try {
    static_cast<void>(stein::exr::read_planes(path, {name}));
    return true;
  } catch (const stein::Error& error) {
    if (error.code() != stein::ErrorCode::kInvalidFrame) {
      throw;
    }
    return false;
  }
}

std::vector<float> read_channel(const std::string& path, const std::string& name) {
  const stein::exr::NamedPlanes planes = stein::exr::read_planes(path, {name});
  const stein::Plane& plane = planes.planes.at(0);
  std::vector<float> values;
  for (int y = 0; y < plane.height(); ++y) {
    values.insert(values.end(), plane.row(y), plane.row(y) + plane.width());
  }
  return values;
}
