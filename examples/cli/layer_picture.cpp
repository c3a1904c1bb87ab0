// SPDX-License-Identifier: Apache-2.0
#include "layer_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "metrics/metrics.hpp"
#include "plane_statistics.hpp"
#include "scale_bar.hpp"
#include "stein/error.hpp"

namespace stein::cli {
namespace {

bool has_word(const std::string& name, const char* word) { return name.find(word) != std::string::npos; }

LayerKind kind_of(const std::string& name, const std::vector<std::string>& components) {
  if (has_word(name, "choice")) {
    return LayerKind::kChoice;
  }
  const bool describes_noise = has_word(name, "variance") || has_word(name, "error");  // covariance, too
  if (components.size() != 3 || describes_noise) {
    return LayerKind::kScalar;
  }
  return components[0].back() == 'R' ? LayerKind::kColour : LayerKind::kVector;
}

std::uint8_t quantise(double encoded) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(encoded, 0.0, 1.0)));
}

// Calls colour_of(values) for each pixel with finite values and marks the others.
template <class ColourOf>
Picture paint(const std::vector<ConstPlaneView>& planes, ColourOf colour_of) {
  Picture picture(planes[0].width(), planes[0].height());
  std::array<float, 3> values{};
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      bool finite = true;
      for (std::size_t c = 0; c < planes.size(); ++c) {
        values[c] = planes[c].at(x, y);
        finite = finite && std::isfinite(values[c]);
      }
      picture.at(x, y) = finite ? colour_of(values) : kNonFinite;
    }
  }
  return picture;
}

std::vector<ConstPlaneView> views(const exr::NamedPlanes& planes) {
  std::vector<ConstPlaneView> result;
  for (const Plane& plane : planes.planes) {
    result.push_back(plane.view());
  }
  return result;
}

// One for all three channels, so that directions keep their proportions.
ValueRange vector_range(const exr::NamedPlanes& planes) {
  constexpr double kUnit = 1.01;  // unit vectors after rounding to half
  ValueRange result = quantile_range(planes.planes[0].view());
  bool unit = true;
  for (const Plane& plane : planes.planes) {
    const ValueRange range = quantile_range(plane.view());
    const PlaneStatistics extent = statistics(plane.view());
    result = {std::min(result.low, range.low), std::max(result.high, range.high)};
    unit = unit && extent.minimum >= -kUnit && extent.maximum <= kUnit;
  }
  return unit ? ValueRange{-1, 1} : display_range(result);
}

}  // namespace

std::optional<exr::NamedPlanes> read_if_present(const std::string& path, const std::vector<std::string>& names) {
  try {
    return exr::read_planes(path, names);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kInvalidFrame) {
      throw;
    }
    return std::nullopt;  // no such channels
  }
}

Layer find_layer(const std::string& path, const std::string& name) {
  if (name.empty()) {
    return {LayerKind::kColour, exr::read_planes(path)};
  }
  const std::vector<std::vector<std::string>> conventions = {{".R", ".G", ".B"}, {".X", ".Y", ".Z"}, {".V"}, {".Z"}};
  for (const std::vector<std::string>& components : conventions) {
    std::vector<std::string> channels;
    channels.reserve(components.size());
    for (const std::string& component : components) {
      channels.push_back(name + component);
    }
    if (std::optional<exr::NamedPlanes> planes = read_if_present(path, channels)) {
      return {kind_of(name, components), std::move(*planes)};
    }
  }
  return {kind_of(name, {name}), exr::read_planes(path, {name})};
}

Picture colour_picture(const exr::NamedPlanes& planes, double stops) {
  const double gain = std::exp2(stops);
  const std::array<float, 9>& matrix = planes.to_rec709;
  return paint(views(planes), [&](const std::array<float, 3>& rgb) {
    std::array<std::uint8_t, 3> encoded{};
    for (std::size_t c = 0; c < 3; ++c) {
      const float linear = matrix[3 * c] * rgb[0] + matrix[3 * c + 1] * rgb[1] + matrix[3 * c + 2] * rgb[2];
      encoded[c] = quantise(metrics::encode_srgb(static_cast<float>(gain * linear)));
    }
    return Pixel{encoded[0], encoded[1], encoded[2]};
  });
}

Picture vector_picture(const exr::NamedPlanes& planes, std::optional<ValueRange> range) {
  const ValueRange scale = range ? *range : vector_range(planes);
  return paint(views(planes), [&](const std::array<float, 3>& v) {
    return Pixel{quantise(scale.normalise(v[0])), quantise(scale.normalise(v[1])), quantise(scale.normalise(v[2]))};
  });
}

Picture choice_picture(ConstPlaneView choice) {
  const double highest = statistics(choice).maximum;
  const int last = std::isfinite(highest) ? static_cast<int>(std::clamp(highest, 0.0, 99.0)) : 0;
  Picture picture = paint({choice}, [](const std::array<float, 3>& v) {
    return v[0] < 0 ? kNonFinite : category_colour(static_cast<int>(std::lround(v[0])));
  });
  return with_category_key(std::move(picture), last);
}

Picture scalar_picture(ConstPlaneView plane, std::optional<ValueRange> range) {
  const ValueRange scale = range ? *range : display_range(quantile_range(plane));
  Picture picture = paint({plane}, [&](const std::array<float, 3>& v) { return false_colour(scale.normalise(v[0])); });
  return with_scale_bar(std::move(picture), scale);
}

Plane channel_mean(const exr::NamedPlanes& planes) {
  Plane mean(planes.planes[0].width(), planes.planes[0].height());
  const auto count = static_cast<float>(planes.planes.size());
  for (const Plane& plane : planes.planes) {
    for (int y = 0; y < mean.height(); ++y) {
      for (int x = 0; x < mean.width(); ++x) {
        mean.row(y)[x] += plane.row(y)[x] / count;
      }
    }
  }
  return mean;
}

}  // namespace stein::cli
