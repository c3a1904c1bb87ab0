// SPDX-License-Identifier: Apache-2.0
#include "layers/split.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stein::test {

SplitFrame::SplitFrame(int width, int height, std::uint64_t seed) : owned_(width, height, kUsualFeatures) {
  fill_random(owned_, seed);
  for (const char* name : {"variance.R", "variance.G", "variance.B"}) {  // as large as the noise: filters are chosen
    for (int y = 0; y < height; ++y) std::fill_n(owned_.plane(name).row(y), width, 0.09F);
  }
}

void SplitFrame::add(const std::string& name, std::size_t channels) {
  Layer layer{name, {}};
  for (std::size_t c = 0; c < channels; ++c) {
    planes_.emplace_back(frame().width, frame().height);
    layer.mean.push_back(planes_.back().view());
  }
  frame().layers.push_back(std::move(layer));
}

void SplitFrame::add_parts(std::uint64_t seed) {
  for (const char* name : {"key", "fill", "rim"}) add(name, 3);
  Random random(seed);
  for (int y = 0; y < frame().height; ++y) {
    for (int x = 0; x < frame().width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float whole = frame().colour[c].at(x, y);
        const float key = whole * static_cast<float>(1.4 * random.uniform());
        const float fill = (whole - key) * static_cast<float>(random.uniform());
        plane("key", c).row(y)[x] = key;
        plane("fill", c).row(y)[x] = fill;
        plane("rim", c).row(y)[x] = whole - key - fill;
      }
    }
  }
}

void SplitFrame::add_copy(const std::string& name) {
  add(name, 3);
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame().height; ++y) frame().colour[c].read_row(y, 0, frame().width, plane(name, c).row(y));
  }
}

void SplitFrame::add_constant(const std::string& name, float value) {
  add(name, 1);
  for (int y = 0; y < frame().height; ++y) std::fill_n(plane(name, 0).row(y), frame().width, value);
}

Plane& SplitFrame::plane(const std::string& layer, std::size_t channel) {
  std::size_t at = channel;
  for (const Layer& each : frame().layers) {
    if (each.name == layer) break;
    at += each.mean.size();
  }
  return planes_.at(at);
}

// Noise of 0.3 that happens to average to nearly 0 leaves rounding of what was averaged.
constexpr double kDark = 0.1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double error_of_sum(const DenoiseResult& result, std::size_t first) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < result.colour[c].height(); ++y) {
      for (int x = 0; x < result.colour[c].width(); ++x) {
        const double whole = result.colour[c].row(y)[x];
        double sum = 0;
        double size = std::abs(whole);
        for (std::size_t l = first; l < first + 3; ++l) {
          const double part = result.layers.at(l).mean.at(c).row(y)[x];
          sum += part;
          size = std::max(size, std::abs(part));
        }
        const double error = std::abs(sum - whole) / std::max(size, kDark);
        largest = std::max(largest, std::isnan(error) ? kInfinity : error);
      }
    }
  }
  return largest;
}

std::vector<std::vector<FilterSpec>> layer_filters() {
  std::vector<FilterSpec> specs;
  for (const std::string_view name : filter_names()) specs.push_back(make_filter(name));
  CrossBilateralParams with_range;
  with_range.range_sigma = 0.5F;
  specs.emplace_back(with_range);
  AdaptiveOrderParams taylor;
  taylor.error = OrderError::kTaylor;
  specs.emplace_back(taylor);
  AtrousSureParams with_plain;
  with_plain.plain = true;
  specs.emplace_back(with_plain);
  AdaptiveOrderParams without_colour_weights;
  without_colour_weights.range_sigmas.clear();
  specs.emplace_back(without_colour_weights);
  for (FilterSpec& spec : specs) {
    std::visit(
        [](auto& params) {
          if constexpr (requires { params.window_radius; }) params.window_radius = 5;
        },
        spec);
  }
  std::vector<std::vector<FilterSpec>> all;
  for (const FilterSpec& spec : specs) all.push_back({spec});
  all.push_back({specs.front(), AtrousParams{}});
  return all;
}

}  // namespace stein::test
