// SPDX-License-Identifier: Apache-2.0
#include "support/half_views.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stein::test {
namespace {

// The bits of round_to_half(value).
std::uint16_t half_bits(float value) {
  int exponent = 0;
  (void)std::frexp(value, &exponent);
  exponent = std::max(exponent, -13);
  const int significand = static_cast<int>(std::ldexp(std::abs(value), 11 - exponent));
  return static_cast<std::uint16_t>(((exponent + 13) << 10) + significand + (std::signbit(value) ? 0x8000 : 0));
}

// Every plane of the frame that filters read.
std::vector<ConstPlaneView*> all_planes(Frame& frame) {
  std::vector<ConstPlaneView*> planes = {&frame.sample_count};
  for (std::size_t c = 0; c < 3; ++c) {
    planes.push_back(&frame.colour[c]);
    planes.push_back(&frame.colour_variance[c]);
  }
  for (Feature& feature : frame.features) {
    for (ConstPlaneView& plane : feature.mean) planes.push_back(&plane);
    for (ConstPlaneView& plane : feature.variance) planes.push_back(&plane);
    for (ConstPlaneView& plane : feature.colour_covariance) planes.push_back(&plane);
  }
  for (ConstPlaneView& plane : frame.colour_covariance) planes.push_back(&plane);
  return planes;
}

}  // namespace

float round_to_half(float value) {
  int exponent = 0;
  (void)std::frexp(value, &exponent);
  exponent = std::max(exponent, -13);
  return static_cast<float>(std::ldexp(std::trunc(std::ldexp(value, 11 - exponent)), exponent - 11));
}

void hold_as_half(Frame& frame, bool is_interleaved, std::vector<std::uint16_t>& memory) {
  const std::vector<ConstPlaneView*> planes = all_planes(frame);
  const auto pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  memory.resize(planes.size() * pixels);
  const std::size_t step = is_interleaved ? planes.size() : 1;
  for (std::size_t p = 0; p < planes.size(); ++p) {
    const std::size_t first = is_interleaved ? p : p * pixels;
    for (std::size_t i = 0; i < pixels; ++i) {
      const int x = static_cast<int>(i) % frame.width;
      memory[first + i * step] = half_bits(planes[p]->at(x, static_cast<int>(i) / frame.width));
    }
    *planes[p] = ConstPlaneView(&memory[first], ScalarType::kFloat16, frame.width, frame.height,
                                static_cast<std::ptrdiff_t>(2 * step));
  }
}

}  // namespace stein::test
