// SPDX-License-Identifier: Apache-2.0
#include "false_colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <vector>

#include "metrics/metrics.hpp"

namespace stein::cli {
namespace {

std::uint8_t encode(double linear) {
  return static_cast<std::uint8_t>(std::lround(255 * metrics::encode_srgb(static_cast<float>(linear))));
}

// Björn Ottosson: A perceptual color space for image processing (2020). Hue in turns.
Pixel from_oklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(2 * std::numbers::pi * hue);
  const double b = chroma * std::sin(2 * std::numbers::pi * hue);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {encode(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encode(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encode(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

}  // namespace

Pixel false_colour(double t) {
  t = std::clamp(t, 0.0, 1.0);
  // The chroma stays within what sRGB can show along this path.
  constexpr double kVioletHue = 0.78;
  constexpr double kYellowHue = 1.30;  // by way of red
  return from_oklch(0.17 + 0.78 * t, 0.04 + 0.06 * t + 0.09 * std::sin(std::numbers::pi * t),
                    std::lerp(kVioletHue, kYellowHue, t));
}

Pixel category_colour(int index) {
  static constexpr std::array<Pixel, 10> kColours = {{{150, 150, 150},
                                                      {38, 70, 160},
                                                      {80, 165, 225},
                                                      {20, 130, 110},
                                                      {130, 200, 80},
                                                      {245, 220, 70},
                                                      {240, 145, 40},
                                                      {205, 50, 45},
                                                      {110, 50, 30},
                                                      {235, 190, 180}}};
  return kColours[static_cast<std::size_t>(std::max(index, 0)) % kColours.size()];
}

ValueRange quantile_range(ConstPlaneView plane) {
  std::vector<float> values;
  std::vector<float> row(static_cast<std::size_t>(plane.width()));
  for (int y = 0; y < plane.height(); ++y) {
    plane.read_row(y, 0, plane.width(), row.data());
    std::copy_if(row.begin(), row.end(), std::back_inserter(values), [](float v) { return std::isfinite(v); });
  }
  if (values.empty()) {
    return {0, 0};
  }
  const auto quantile = [&values](double fraction) -> double {
    const auto nth = values.begin() + std::lround(fraction * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  };
  const double low = quantile(0.01);
  return {low, quantile(0.99)};
}

ValueRange display_range(ValueRange range) {
  if (range.low > 0 && range.low < 0.25 * range.high) {
    range.low = 0;
  }
  if (!(range.high > range.low)) {  // the step must survive rounding next to a large value
    range.high = range.low + std::max(1.0, std::abs(range.low));
  }
  return range;
}

}  // namespace stein::cli
