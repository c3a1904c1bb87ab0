// SPDX-License-Identifier: Apache-2.0
#include "support/atrous_reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/feature_nlm_reference.hpp"

namespace stein::test {
namespace {

constexpr std::array<double, 5> kSpline = {1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16};

// The features of all pixels as the source gives them, or smoothed.
class Features {
 public:
  Features(const FeatureGuides& guides, const Source& source) : width_(source.frame().width) {
    const Frame& frame = source.frame();
    least_ = guides.min_feature_variance;
    for (std::size_t f = 0; f < frame.features.size(); ++f) {
      Group group;
      group.sigma = guides.sigma_of(frame.features[f].name);
      if (group.sigma == 0) continue;
      group.means.resize(frame.features[f].mean.size(), std::vector<float>(pixels(frame)));
      group.variance.resize(pixels(frame));
      for (int y = 0; y < frame.height; ++y) {
        float* rows[4] = {};
        for (std::size_t k = 0; k < group.means.size(); ++k) rows[k] = &group.means[k][index(0, y)];
        source.feature_row(f, 1.0F, y, 0, width_, rows, &group.variance[index(0, y)]);
      }
      if (guides.smoothing_radius > 0) smooth(source, f, guides.smoothing_radius, group);
      groups_.push_back(std::move(group));
    }
  }
  [[nodiscard]] std::size_t index(int x, int y) const { return pixel_index(width_, x, y); }
  // Sum of D^2 / (2 sigma^2), SBF Eq. 4 and 6.
  [[nodiscard]] double exponent(std::size_t i, std::size_t j) const {
    double sum = 0;
    for (const Group& group : groups_) {
      double squared = 0;
      for (const auto& mean : group.means) squared += std::pow(static_cast<double>(mean[i]) - mean[j], 2);
      const double variance = static_cast<double>(group.variance[i]) + group.variance[j];
      sum += squared / std::max(variance, least_) / (2 * group.sigma * group.sigma);
    }
    return sum;
  }

 private:
  static std::size_t pixels(const Frame& frame) {
    return static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  }
  struct Group {
    double sigma = 0;
    std::vector<std::vector<float>> means;
    std::vector<float> variance;
  };
  static void smooth(const Source& source, std::size_t feature, int radius, Group& group) {
    const FeatureNlmReference reference(source, feature, {radius, 1});
    for (int y = 0; y < source.frame().height; ++y) {
      for (int x = 0; x < source.frame().width; ++x) {
        const std::vector<double> means = reference.means(x, y);
        for (std::size_t k = 0; k < means.size(); ++k)
          group.means[k][pixel_index(source.frame().width, x, y)] = static_cast<float>(means[k]);
      }
    }
  }
  int width_;
  double least_ = 0;
  std::vector<Group> groups_;
};

double weight_of(double exponent) {  // the kernels count less as nothing
  return exponent < 59.5 * std::numbers::ln2 ? std::exp(-exponent) : 0.0;
}

// Mean correlation of taps, from the two-dimensional kernels of white noise: sum k^2 over an image of them.
double correlation_reference(int level) {
  const auto sum_of_squares = [](int levels) {
    constexpr int kSize = 160;
    std::vector<double> image(std::size_t{kSize} * kSize, 0.0);
    image[std::size_t{kSize} * kSize / 2 + kSize / 2] = 1;
    for (int l = 0; l < levels; ++l) {
      std::vector<double> next(image.size(), 0.0);
      for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
          const double v = image[pixel_index(kSize, x, y)];
          for (int t = 0; t < 25 && v != 0; ++t) {
            const int step = 1 << l;
            next[pixel_index(kSize, x + (t % 5 - 2) * step, y + (t / 5 - 2) * step)] +=
                v * kSpline[static_cast<std::size_t>(t % 5)] * kSpline[static_cast<std::size_t>(t / 5)];
          }
        }
      }
      image = next;
    }
    double sum = 0;
    for (const double v : image) sum += v * v;
    return sum;
  };
  const double independent = sum_of_squares(1);
  return (sum_of_squares(level + 1) / sum_of_squares(level) - independent) / (1 - independent);
}

struct Image {
  int width = 0;
  int height = 0;
  std::vector<char> valid;
};

// Calls visit(j, spatial) for the valid taps of pixel (x, y) in the image.
template <class Visit>
void for_each_tap(const Image& image, int x, int y, int step, Visit visit) {
  for (int t = 0; t < 25; ++t) {
    const int px = x + (t % 5 - 2) * step;
    const int py = y + (t / 5 - 2) * step;
    if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
    const std::size_t j = pixel_index(image.width, px, py);
    if (image.valid[j] != 0) {
      visit(j, kSpline[static_cast<std::size_t>(t % 5)] * kSpline[static_cast<std::size_t>(t / 5)]);
    }
  }
}

AtrousLevel first_level(const Source& source, const Features& features, Image& image) {
  AtrousLevel level;
  const std::size_t pixels = pixel_index(image.width, 0, image.height);
  image.valid.resize(pixels);
  std::vector<double> noise(pixels, 0.0);
  for (auto& plane : level.colour) plane.resize(pixels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::size_t i = features.index(x, y);
      float value = 0;
      source.mask_row(y, x, 1, &value);
      image.valid[i] = value != 0 ? 1 : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        source.colour_row(c, y, x, 1, &value);
        level.colour[c][i] = value;
        source.variance_row(c, y, x, 1, &value);
        noise[i] += value;
      }
    }
  }
  level.noise = noise;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::size_t i = features.index(x, y);
      double sum = 0;
      double total = 0;
      for_each_tap(image, x, y, 1, [&](std::size_t j, double spatial) {
        const double w = spatial * weight_of(features.exponent(i, j));
        sum += w * noise[j];
        total += w;
      });
      if (total > 0) level.noise[i] = sum / total;
    }
  }
  return level;
}

struct Sums {
  double weight = 0;
  std::array<double, 3> colour{};
  double noise = 0;
  double noise2 = 0;
};

double distance2(const AtrousLevel& level, std::size_t i, const std::array<double, 3>& colour) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += std::pow(level.colour[c][i] - colour[c], 2);
  return sum;
}

class Step {
 public:
  Step(const AtrousSureParams& params, const Features& features, const Image& image, int index)
      : params_(params),
        features_(features),
        image_(image),
        index_(index),
        correlation_(correlation_reference(index)) {}

  void pixel(int x, int y, AtrousLevel& level, AtrousLevel& next) const {
    const std::size_t i = features_.index(x, y);
    Sums sums;
    std::vector<std::pair<std::size_t, double>> taps;
    for_each_tap(image_, x, y, 1 << index_, [&](std::size_t j, double spatial) {
      taps.emplace_back(j, spatial * weight_of(exponent(level, i, j)));
      const double w = taps.back().second;
      sums.weight += w;
      for (std::size_t c = 0; c < 3; ++c) sums.colour[c] += w * level.colour[c][j];
      sums.noise += w * level.noise[j];
      sums.noise2 += w * w * level.noise[j];
    });
    next.noise[i] = level.noise[i];
    for (std::size_t c = 0; c < 3; ++c) next.colour[c][i] = level.colour[c][i];
    if (sums.weight <= 0) return;
    std::array<double, 3> mean{};
    for (std::size_t c = 0; c < 3; ++c) {
      mean[c] = next.colour[c][i] = sums.colour[c] / sums.weight;
      level.detail[c][i] = level.colour[c][i] - mean[c];
    }
    const double common = sums.noise / sums.weight;
    const double independent = sums.noise2 / (sums.weight * sums.weight);
    next.noise[i] = independent + correlation_ * (common - independent);
    for (const auto& [j, w] : taps) level.energy[i] += w / sums.weight * distance2(level, j, mean);
    level.noise_energy[i] = std::max(common - next.noise[i], 0.0);
    level.detail_weight[i] = image_.valid[i] != 0 ? weight(level.energy[i], level.noise_energy[i]) : 0.0;
  }

 private:
  [[nodiscard]] double exponent(const AtrousLevel& level, std::size_t i, std::size_t j) const {
    const double sum = features_.exponent(i, j) / std::pow(0.64, index_);
    if (params_.value_sigma == 0 || image_.valid[i] == 0) return sum;
    const double squared = distance2(level, i, {level.colour[0][j], level.colour[1][j], level.colour[2][j]});
    const double noise = level.noise[i] + std::min(level.noise[i], level.noise[j]);
    const double sigma = params_.value_sigma;
    return sum + squared / std::max(noise, 1e-30) / (2 * sigma * sigma);
  }
  [[nodiscard]] double weight(double energy, double noise) const {
    if (params_.fixed_weight) return *params_.fixed_weight;
    return std::max(1.0 - params_.noise_margin * noise / std::max(energy, 1e-30), 0.0);
  }

  const AtrousSureParams& params_;
  const Features& features_;
  const Image& image_;
  int index_;
  double correlation_;
};

}  // namespace

std::vector<AtrousLevel> atrous_reference(const AtrousSureParams& params, const Source& source) {
  const Features features(params.guides, source);
  Image image{source.frame().width, source.frame().height, {}};
  std::vector<AtrousLevel> levels = {first_level(source, features, image)};
  for (int l = 0; l < params.levels; ++l) {
    const std::size_t pixels = image.valid.size();
    AtrousLevel& level = levels.back();
    for (auto* plane : {&level.energy, &level.noise_energy, &level.detail_weight}) plane->resize(pixels, 0.0);
    for (auto& plane : level.detail) plane.resize(pixels, 0.0);
    AtrousLevel next;
    next.noise.resize(pixels);
    for (auto& plane : next.colour) plane.resize(pixels);
    const Step step(params, features, image, l);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) step.pixel(x, y, level, next);
    }
    levels.push_back(std::move(next));
  }
  return levels;
}

std::array<std::vector<double>, 3> atrous_result(const AtrousSureParams& params,
                                                 const std::vector<AtrousLevel>& levels) {
  std::array<std::vector<double>, 3> result = levels.back().colour;
  for (std::size_t l = 0; l + 1 < levels.size(); ++l) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < result[c].size(); ++i) {
        double w = levels[l].detail_weight[i];
        if (params.weight_steps > 0) w = std::round(w * params.weight_steps) / params.weight_steps;
        result[c][i] += w * levels[l].detail[c][i];
      }
    }
  }
  return result;
}

}  // namespace stein::test
