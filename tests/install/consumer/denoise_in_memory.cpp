// SPDX-License-Identifier: Apache-2.0
//
// A project out of tree: denoises a small noisy grey image in memory and sees that its error falls.
#include <cstddef>
#include <cstdio>
#include <random>
#include <stein/denoise.hpp>
#include <vector>

namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 16;
constexpr float kGrey = 0.5F;
constexpr float kDeviation = 0.1F;  // of the mean

double squared_error(float value) { return (value - kGrey) * (value - kGrey); }

}  // namespace

int main() {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(kGrey, kDeviation);
  std::vector<float> rgb(std::size_t{3} * kWidth * kHeight);
  for (float& v : rgb) v = noise(random);
  const std::vector<float> variance(std::size_t{kWidth} * kHeight, kDeviation * kDeviation);

  stein::Frame frame;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.uniform_sample_count = 8;
  for (std::size_t c = 0; c < 3; ++c) {
    frame.colour[c] = stein::ConstPlaneView(rgb.data() + c, kWidth, kHeight, 3 * sizeof(float));
    frame.colour_variance[c] = stein::ConstPlaneView(variance.data(), kWidth, kHeight);
  }
  const stein::DenoiseResult result = stein::denoise(frame);

  double before = 0;
  double after = 0;
  for (const float v : rgb) before += squared_error(v);
  for (const stein::Plane& plane : result.colour) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) after += squared_error(plane.row(y)[x]);
    }
  }
  std::printf("sum of squared errors: %g before, %g after\n", before, after);
  return after < 0.5 * before && result.report.candidates.size() > 1 ? 0 : 1;
}
