// SPDX-License-Identifier: Apache-2.0
#include <hwy/targets.h>

#include <cmath>
#include <limits>

#include "catch.hpp"
#include "select/guided_pass_reference.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

void fill_maps(const Maps& maps, const Frame& frame, std::uint64_t seed) {
  Random random(seed);
  for (int m = 0; m < kMaps; ++m) {
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) maps.ring.row(m, y)[x] = static_cast<float>(random.normal() + m);
    }
  }
}

void run(const GuidedPass& pass, const Setting& setting, const Maps& in, const Maps& out, int tile_width,
         int tile_height) {
  const Frame& frame = setting.frame();
  for (int y = 0; y < frame.height; y += tile_height) {
    for (int x = 0; x < frame.width; x += tile_width) {
      const Rect tile{x, y, std::min(x + tile_width, frame.width), std::min(y + tile_height, frame.height)};
      run_guided_pass(pass, setting.guides, frame.height, tile, in.rows(), out.rows());
    }
  }
}

// Largest deviation of one pass from the reference.
double deviation(const GuidedPass& pass, const Setting& setting, const Maps& in, const Maps& out) {
  double largest = 0;
  for (int y = 0; y < setting.frame().height; ++y) {
    for (int x = 0; x < setting.frame().width; ++x) {
      const std::array<double, kMaps> expected = guided_pass_reference(pass, setting, in, x, y);
      for (int m = 0; m < kMaps; ++m) {
        const double e = expected[static_cast<std::size_t>(m)];
        const double error = std::abs(out.ring.row(m, y)[x] - e) / (1.0 + std::abs(e));
        if (!(error <= largest)) largest = error;  // NaN is the largest of all
      }
    }
  }
  return largest;
}

double deviation_of_pass(const GuidedPass& pass, const Setting& setting, int tile_width, int tile_height) {
  const Maps in(setting.frame());
  const Maps out(setting.frame());
  fill_maps(in, setting.frame(), 17);
  run(pass, setting, in, out, tile_width, tile_height);
  return deviation(pass, setting, in, out);
}

std::vector<GuidedPass> all_passes() {
  std::vector<GuidedPass> passes;
  for (const PassKernel kernel : {PassKernel::kBox, PassKernel::kB3Spline}) {
    for (const int step : {1, 2, 4}) {
      for (const float sigma_scale : {1.0F, 2.0F}) passes.push_back({kernel, step, sigma_scale});
    }
  }
  return passes;
}

void spoil(OwnedFrame& frame) {
  for (int y = 8; y < 21; ++y) {
    for (int x = 14; x < 29; ++x) frame.at("sampleCount", x, y) = 0.0F;  // wider than a pass of step 1 or 2 reaches
  }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.at("R", 0, 0) = nan;
  frame.at("variance.G", 36, 29) = -1.0F;
  frame.at("albedo.R", 5, 5) = nan;
  frame.at("depth.variance.Z", 33, 4) = nan;
}

}  // namespace

TEST_CASE("guided pass: equals the plain double reference for all sizes from 1 to 40") {
  for (int size = 1; size <= 40; ++size) {
    OwnedFrame frame(size, 41 - size, kUsualFeatures);
    fill_random(frame, static_cast<std::uint64_t>(size));
    const Setting setting(frame.frame());
    for (const GuidedPass& pass : all_passes()) {
      INFO("width " << size << ", step " << pass.step << ", sigma scale " << pass.sigma_scale);
      CHECK(deviation_of_pass(pass, setting, 48, 41) < 1e-5);
    }
  }
}

TEST_CASE("guided pass: images of one pixel, one row and one column") {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(57, 1), std::pair(1, 57)}) {
    OwnedFrame frame(width, height, kUsualFeatures);
    fill_random(frame, 3);
    const Setting setting(frame.frame());
    for (const GuidedPass& pass : all_passes()) CHECK(deviation_of_pass(pass, setting, 16, 8) < 1e-5);
  }
}

TEST_CASE("guided pass: invalid pixels have no weight, bad features drop out, and without weight a map stays") {
  OwnedFrame frame(37, 31, kUsualFeatures);
  fill_random(frame, 4);
  spoil(frame);
  const Setting setting(frame.frame());
  for (const GuidedPass& pass : all_passes()) {
    INFO("step " << pass.step << ", sigma scale " << pass.sigma_scale);
    CHECK(deviation_of_pass(pass, setting, 48, 31) < 1e-5);
  }
  const Maps in(frame.frame());
  const Maps out(frame.frame());
  fill_maps(in, frame.frame(), 5);
  run({PassKernel::kBox, 1, 1.0F}, setting, in, out, 48, 31);
  CHECK(out.ring.row(1, 14)[21] == in.ring.row(1, 14)[21]);
  CHECK(out.ring.row(1, 25)[21] != in.ring.row(1, 25)[21]);
}

TEST_CASE("guided pass: any set of features guides as in the reference") {
  const std::vector<std::vector<FeatureShape>> sets = {
      {}, {{"depth", 1}}, {{"a", 1}, {"b", 2}, {"c", 3}, {"d", 4}}, {{"normal", 3}, {"position", 3}}};
  for (const auto& features : sets) {
    OwnedFrame frame(29, 23, features);
    fill_random(frame, 6);
    const Setting setting(frame.frame());
    for (const GuidedPass& pass : all_passes()) CHECK(deviation_of_pass(pass, setting, 16, 23) < 1e-5);
  }
}

TEST_CASE("guided pass: tiles of any size give identical bits") {
  OwnedFrame frame(75, 37, kUsualFeatures);
  fill_random(frame, 7);
  spoil(frame);
  const Setting setting(frame.frame());
  const Maps in(frame.frame());
  fill_maps(in, frame.frame(), 8);
  for (const GuidedPass& pass : all_passes()) {
    const Maps whole(frame.frame());
    run(pass, setting, in, whole, 80, 37);
    for (const auto& [width, height] : {std::pair(16, 1), std::pair(32, 5), std::pair(48, 37)}) {
      const Maps tiled(frame.frame());
      run(pass, setting, in, tiled, width, height);
      int different = 0;
      for (int m = 0; m < kMaps; ++m) {
        for (int y = 0; y < 37; ++y) {
          for (int x = 0; x < 75; ++x) different += whole.ring.row(m, y)[x] != tiled.ring.row(m, y)[x] ? 1 : 0;
        }
      }
      CHECK(different == 0);
    }
  }
}

TEST_CASE("guided pass: a chain of passes reads what the one before left beside the image without harm") {
  OwnedFrame frame(41, 25, kUsualFeatures);
  fill_random(frame, 9);
  spoil(frame);
  const Setting setting(frame.frame());
  const Maps first(frame.frame());
  const Maps second(frame.frame());
  const Maps third(frame.frame());
  fill_maps(first, frame.frame(), 10);
  run({PassKernel::kBox, 1, 2.0F}, setting, first, second, 16, 4);
  const GuidedPass last{PassKernel::kBox, 4, 2.0F};
  run(last, setting, second, third, 16, 4);
  CHECK(deviation(last, setting, second, third) < 1e-5);
}

TEST_CASE("guided pass: a constant stays") {
  OwnedFrame frame(45, 30, kUsualFeatures);
  fill_random(frame, 11);
  spoil(frame);
  const Setting setting(frame.frame());
  const Maps in(frame.frame());
  const Maps out(frame.frame());
  for (int m = 0; m < kMaps; ++m) {
    for (int y = 0; y < 30; ++y) std::fill_n(in.ring.row(m, y), 45, 0.3F * static_cast<float>(m - 1));
  }
  for (const GuidedPass& pass : all_passes()) {
    run(pass, setting, in, out, 16, 16);
    for (int m = 0; m < kMaps; ++m) {
      for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 45; ++x) CHECK(out.ring.row(m, y)[x] == Approx(0.3 * (m - 1)).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("guided pass: the edge of a feature stops it, and without one it does not stop") {
  for (const bool has_edge : {true, false}) {
    OwnedFrame frame(40, 20, kUsualFeatures);
    for (int y = 0; y < 20; ++y) {
      for (int x = 20; x < 40; ++x) frame.at("depth.Z", x, y) = has_edge ? 5.0F : 0.5F;
    }
    const Setting setting(frame.frame());
    const Maps in(frame.frame());
    const Maps out(frame.frame());
    for (int y = 0; y < 20; ++y) std::fill_n(in.ring.row(0, y) + 20, 20, 1.0F);
    for (const GuidedPass& pass : all_passes()) {
      run(pass, setting, in, out, 48, 20);
      for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 40; ++x) {
          if (has_edge) CHECK(out.ring.row(0, y)[x] == Approx(x < 20 ? 0.0 : 1.0).margin(1e-5));
        }
        if (!has_edge) CHECK(out.ring.row(0, y)[20 - pass.step] > 0.05F);
      }
    }
  }
}

TEST_CASE("guided pass: all instruction sets of this machine agree with the reference") {
  OwnedFrame frame(37, 31, kUsualFeatures);
  fill_random(frame, 12);
  spoil(frame);
  const Setting setting(frame.frame());
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    const double box = deviation_of_pass({PassKernel::kBox, 2, 2.0F}, setting, 16, 31);
    const double spline = deviation_of_pass({PassKernel::kB3Spline, 4, 1.0F}, setting, 16, 31);
    hwy::SetSupportedTargetsForTest(0);
    INFO(hwy::TargetName(targets & -targets));
    CHECK(box < 1e-5);
    CHECK(spline < 1e-5);
  }
}

}  // namespace stein::test
