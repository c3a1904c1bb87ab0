// SPDX-License-Identifier: Apache-2.0
#include "metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "metrics/ssim.hpp"
#include "stein/error.hpp"

namespace stein::metrics {
namespace {

constexpr double kRelativeEpsilon = 0.01;
constexpr double kTrimmedFraction = 1e-4;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string size_of(ConstPlaneView plane) {
  return std::to_string(plane.width()) + "x" + std::to_string(plane.height());
}

void check_sizes(const Rgb& image, const Rgb& reference) {
  const ConstPlaneView& first = reference[0];
  for (const Rgb* rgb : {&image, &reference}) {
    for (const ConstPlaneView& plane : *rgb) {
      if (!plane || plane.width() < 1 || plane.height() < 1) {
        throw Error(ErrorCode::kInvalidArgument, "an image to compare lacks a channel or has no pixels");
      }
      if (plane.width() != first.width() || plane.height() != first.height()) {
        throw Error(ErrorCode::kInvalidArgument,
                    "images to compare must have one size: " + size_of(plane) + " against " + size_of(first));
      }
    }
  }
}

// Calls visit(a, b) for each pair of rows of one channel.
template <class Visitor>
void for_each_row(ConstPlaneView a, ConstPlaneView b, Visitor visit) {
  std::vector<float> row_a(static_cast<std::size_t>(a.width()));
  std::vector<float> row_b(row_a.size());
  for (int y = 0; y < a.height(); ++y) {
    a.read_row(y, 0, a.width(), row_a.data());
    b.read_row(y, 0, b.width(), row_b.data());
    visit(row_a, row_b);
  }
}

std::vector<double> relative_errors(const Rgb& image, const Rgb& reference) {
  const auto pixels = static_cast<std::size_t>(reference[0].width()) * static_cast<std::size_t>(reference[0].height());
  std::vector<double> errors(pixels, 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    std::size_t i = 0;
    for_each_row(image[c], reference[c], [&](const std::vector<float>& a, const std::vector<float>& b) {
      for (std::size_t x = 0; x < a.size(); ++x, ++i) {
        const double truth = b[x];
        const double difference = a[x] - truth;
        errors[i] += difference * difference / (truth * truth + kRelativeEpsilon) / 3.0;
      }
    });
  }
  return errors;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Leaves out the largest values, but never a non-finite one: it would look like an ordinary outlier.
double trimmed_mean(std::vector<double> values) {
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    return mean(values);
  }
  const auto dropped = static_cast<std::ptrdiff_t>(std::floor(static_cast<double>(values.size()) * kTrimmedFraction));
  std::nth_element(values.begin(), values.begin() + dropped, values.end(), std::greater<>());
  values.erase(values.begin(), values.begin() + dropped);
  return mean(values);
}

double mean_squared_error(const Rgb& image, const Rgb& reference) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for_each_row(image[c], reference[c], [&](const std::vector<float>& a, const std::vector<float>& b) {
      for (std::size_t x = 0; x < a.size(); ++x) {
        const double difference = static_cast<double>(a[x]) - static_cast<double>(b[x]);
        sum += difference * difference;
      }
    });
  }
  return sum / (3.0 * reference[0].width() * reference[0].height());
}

// Clipping would turn an infinite value into an ordinary white: the figures must show it.
double encode_or_nan(float linear) { return std::isfinite(linear) ? static_cast<double>(encode_srgb(linear)) : kNaN; }

// Fills the encoded mean of the channels of both images; returns the mean squared error of the encoded channels.
double encode(const Rgb& image, const Rgb& reference, GreyImage& grey_image, GreyImage& grey_reference) {
  const int width = reference[0].width();
  const int height = reference[0].height();
  const std::vector<double> zeros(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0);
  grey_image = {width, height, zeros};
  grey_reference = {width, height, zeros};
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    std::size_t i = 0;
    for_each_row(image[c], reference[c], [&](const std::vector<float>& a, const std::vector<float>& b) {
      for (std::size_t x = 0; x < a.size(); ++x, ++i) {
        const double encoded_a = encode_or_nan(a[x]);
        const double encoded_b = encode_or_nan(b[x]);
        grey_image.values[i] += encoded_a / 3.0;
        grey_reference.values[i] += encoded_b / 3.0;
        sum += (encoded_a - encoded_b) * (encoded_a - encoded_b);
      }
    });
  }
  return sum / (3.0 * width * height);
}

}  // namespace

Comparison compare(const Rgb& image, const Rgb& reference) {
  check_sizes(image, reference);
  Comparison result;
  std::vector<double> errors = relative_errors(image, reference);
  result.rel_mse = mean(errors);
  result.trimmed_rel_mse = trimmed_mean(std::move(errors));
  result.mse = mean_squared_error(image, reference);
  GreyImage grey_image;
  GreyImage grey_reference;
  const double encoded_mse = encode(image, reference, grey_image, grey_reference);
  result.psnr = encoded_mse > 0 || std::isnan(encoded_mse) ? -10 * std::log10(encoded_mse)
                                                           : std::numeric_limits<double>::infinity();
  result.ssim = ssim(grey_image, grey_reference);
  return result;
}

Plane relative_error_map(const Rgb& image, const Rgb& reference) {
  check_sizes(image, reference);
  const std::vector<double> errors = relative_errors(image, reference);
  Plane map(reference[0].width(), reference[0].height());
  auto error = errors.begin();
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      map.row(y)[x] = static_cast<float>(*error++);
    }
  }
  return map;
}

float encode_srgb(float linear) noexcept {
  if (!(linear > 0)) {
    return 0;
  }
  if (linear >= 1) {
    return 1;
  }
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

}  // namespace stein::metrics
