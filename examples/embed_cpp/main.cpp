// SPDX-License-Identifier: Apache-2.0
//
// A renderer in C++ that denoises a frame with stein. It keeps no variances: the accumulator does. Prints the error
// before and after, and what stein estimated it to be.
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <random>
#include <stein/accumulate.hpp>
#include <stein/denoise.hpp>
#include <stein/error.hpp>

namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 96;
constexpr int kSamples = 8;

// A chequered floor in a soft light.
float albedo(int x, int y) { return (x / 16 + y / 16) % 2 == 1 ? 0.8F : 0.2F; }
float truth(int x, int y) {
  return albedo(x, y) *
         (0.6F + 0.4F * std::sin(0.04F * static_cast<float>(x)) * std::cos(0.05F * static_cast<float>(y)));
}

void render(stein::Accumulator& film) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> noise(0.0F, 2.0F);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int s = 0; s < kSamples; ++s) {
        const float light = truth(x, y) * noise(random);
        const float surface = albedo(x, y);
        const float sample[] = {light, light, light, surface, surface, surface};
        film.add(x, y, sample);
      }
    }
  }
}

// Of the red channel.
template <class Value>
double mean_squared_error(Value value) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) sum += std::pow(static_cast<double>(value(x, y)) - truth(x, y), 2);
  }
  return sum / (kWidth * kHeight);
}

}  // namespace

int main() try {
  stein::Accumulator film(kWidth, kHeight, {.features = {{"albedo", 3}}});
  render(film);
  const stein::Moments moments = film.moments();

  stein::DenoiseParams params;
  params.filters = {stein::CrossBilateralParams{}};
  double progress = 0;
  params.execution.progress = [&](double done) {  // where a program would look whether somebody pressed "cancel"
    progress = done;
    return true;
  };
  const stein::DenoiseResult result = stein::denoise(moments.frame(), params);

  const double before = mean_squared_error([&](int x, int y) { return moments.frame().colour[0].at(x, y); });
  const double after = mean_squared_error([&](int x, int y) { return result.colour[0].row(y)[x]; });
  std::printf("mean squared error: %.3g before, %.3g after\n", before, after);
  std::printf("estimated to remain: %.3g\n", result.report.mean_error[0]);
  for (const std::string& warning : result.report.warnings) std::printf("warning: %s\n", warning.c_str());
  return progress > 0.99 && after < 0.2 * before ? 0 : 1;
} catch (const stein::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
