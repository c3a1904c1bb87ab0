// SPDX-License-Identifier: Apache-2.0
#include "exr/convert_variance.hpp"

#include <algorithm>
#include <cmath>

namespace stein::exr {
namespace {

using Rows = std::array<std::vector<float>, 3>;

/// v becomes the variance of the mean.
void to_mean(VarianceOf variance_of, const std::vector<float>& mean, const std::vector<float>& n,
             std::vector<float>& v) {
  for (std::size_t x = 0; x < v.size(); ++x) {
    if (variance_of == VarianceOf::kSample && n[x] > 0) v[x] /= n[x];
    if (variance_of == VarianceOf::kSecondMoment) {
      // Rounding can leave a difference just below 0; NaN has to stay.
      const float spread = v[x] - mean[x] * mean[x];
      v[x] = n[x] <= 1 || spread < 0 ? 0 : spread / (n[x] - 1);
    }
  }
}

float dot_row(const std::array<float, 9>& matrix, std::size_t row, const Rows& vector, std::size_t x) {
  return matrix[3 * row] * vector[0][x] + matrix[3 * row + 1] * vector[1][x] + matrix[3 * row + 2] * vector[2][x];
}

void transform(const std::array<float, 9>& matrix, Rows& values) {
  for (std::size_t x = 0; x < values[0].size(); ++x) {
    const std::array<float, 3> result = {dot_row(matrix, 0, values, x), dot_row(matrix, 1, values, x),
                                         dot_row(matrix, 2, values, x)};
    for (std::size_t c = 0; c < 3; ++c) values[c][x] = result[c];
  }
}

class ColourConversion {
 public:
  ColourConversion(const Frame& frame, const Schema& schema, VarianceOf variance_of, const ColourSpace& space)
      : frame_(frame), schema_(schema), variance_of_(variance_of), space_(space) {
    const auto width = static_cast<std::size_t>(frame.width);
    for (std::size_t c = 0; c < 3; ++c) {
      mean_[c].resize(width);
      variance_[c].resize(width);
    }
    counts_.assign(width, frame.uniform_sample_count);
  }

  const Rows& row(int y) {
    for (std::size_t c = 0; c < 3; ++c) {
      frame_.colour[c].read_row(y, 0, frame_.width, mean_[c].data());
      frame_.colour_variance[c].read_row(y, 0, frame_.width, variance_[c].data());
    }
    if (frame_.sample_count) frame_.sample_count.read_row(y, 0, frame_.width, counts_.data());
    const bool is_xyz = schema_.variance_space == VarianceSpace::kXyz;
    if (is_xyz) transform(space_.to_xyz, mean_);
    for (std::size_t c = 0; c < 3; ++c) to_mean(variance_of_, mean_[c], counts_, variance_[c]);
    if (schema_.zero_variance_is_unknown) fill_unknown(y, is_xyz);
    if (is_xyz) take_as_correlated();
    return variance_;
  }

 private:
  /// Without covariances of X, Y and Z: as if there were one random factor for all three.
  void take_as_correlated() {
    for (auto& row : variance_) {
      for (float& v : row) v = std::sqrt(v);
    }
    transform(space_.from_xyz, variance_);
    for (auto& row : variance_) {
      for (float& v : row) v *= v;
    }
  }

  void fill_unknown(int y, bool is_xyz) {
    for (std::size_t x = 0; x < counts_.size(); ++x) {
      if (variance_[0][x] != 0 || variance_[1][x] != 0 || variance_[2][x] != 0) continue;
      std::array<float, 3> rgb = {};
      for (std::size_t c = 0; c < 3; ++c) rgb[c] = spread_around(c, static_cast<int>(x), y);
      for (std::size_t c = 0; c < 3; ++c) variance_[c][x] = is_xyz ? in_xyz(rgb, c) : rgb[c];
    }
  }

  /// A variance that the way back from X, Y, Z turns into that of R, G, B.
  [[nodiscard]] float in_xyz(const std::array<float, 3>& rgb, std::size_t row) const {
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += space_.to_xyz[3 * row + c] * std::sqrt(rgb[c]);
    return sum * sum;
  }

  /// The squared median difference from the 3x3 pixels around, which for Gaussian noise is 0.91 times its variance. Of
  /// the pixels that are unknown, too, where there are two of them: others see something else, such as a surface.
  [[nodiscard]] float spread_around(std::size_t channel, int x, int y) const {
    std::array<float, 8> unknown{};
    std::array<float, 8> all{};
    std::size_t unknown_count = 0;
    std::size_t count = 0;
    const ConstPlaneView& plane = frame_.colour[channel];
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame_.height - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, frame_.width - 1); ++u) {
        const float difference = std::abs(plane.at(u, v) - plane.at(x, y));
        if ((u == x && v == y) || !std::isfinite(difference)) continue;
        all[count++] = difference;
        if (is_unknown(u, v)) unknown[unknown_count++] = difference;
      }
    }
    const float middle = unknown_count >= 2 ? median(unknown, unknown_count) : median(all, count);
    return middle * middle;
  }

  [[nodiscard]] bool is_unknown(int x, int y) const {
    const auto& v = frame_.colour_variance;
    return std::all_of(v.begin(), v.end(), [x, y](const ConstPlaneView& plane) { return plane.at(x, y) == 0; });
  }

  static float median(std::array<float, 8>& values, std::size_t count) {
    if (count == 0) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
  }

  const Frame& frame_;
  const Schema& schema_;
  VarianceOf variance_of_;
  const ColourSpace& space_;
  Rows mean_;
  Rows variance_;
  std::vector<float> counts_;
};

}  // namespace

void convert_colour_variance(Frame& frame, const Schema& schema, VarianceOf variance_of, const ColourSpace& space,
                             Memory* memory, std::vector<Plane>& planes_made) {
  if (!frame.colour_variance[0]) return;
  if (!needs_samples(variance_of) && schema.variance_space == VarianceSpace::kRgb && !schema.zero_variance_is_unknown) {
    return;
  }
  std::array<Plane, 3> planes;
  for (Plane& plane : planes) plane = Plane(frame.width, frame.height, memory);
  ColourConversion conversion(frame, schema, variance_of, space);
  for (int y = 0; y < frame.height; ++y) {
    const Rows& row = conversion.row(y);
    if (memory != nullptr) memory->trim();
    for (std::size_t c = 0; c < 3; ++c) std::copy(row[c].begin(), row[c].end(), planes[c].row(y));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    planes_made.push_back(std::move(planes[c]));
    frame.colour_variance[c] = planes_made.back().view();
  }
}

void convert_feature_variance(const Frame& frame, Feature& feature, VarianceOf variance_of, Memory* memory,
                              std::vector<Plane>& planes_made) {
  if (!needs_samples(variance_of)) return;
  const auto width = static_cast<std::size_t>(frame.width);
  std::vector<float> mean(width);
  std::vector<float> variance(width);
  std::vector<float> counts(width, frame.uniform_sample_count);
  for (std::size_t k = 0; k < feature.variance.size(); ++k) {
    Plane plane(frame.width, frame.height, memory);
    for (int y = 0; y < frame.height; ++y) {
      if (memory != nullptr) memory->trim();
      feature.mean[k].read_row(y, 0, frame.width, mean.data());
      feature.variance[k].read_row(y, 0, frame.width, variance.data());
      if (frame.sample_count) frame.sample_count.read_row(y, 0, frame.width, counts.data());
      to_mean(variance_of, mean, counts, variance);
      std::copy(variance.begin(), variance.end(), plane.row(y));
    }
    planes_made.push_back(std::move(plane));
    feature.variance[k] = planes_made.back().view();
  }
}

}  // namespace stein::exr
