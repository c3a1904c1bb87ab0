// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/error_stages.hpp"

#include <algorithm>
#include <numeric>

#include "pipeline/density_rows.hpp"
#include "pipeline/layers.hpp"
#include "pipeline/relative_risk.hpp"
#include "risk/sure.hpp"

namespace stein {
namespace {

const std::vector<int> kErrorSteps = {1, 2, 4};
constexpr float kSmoothingSigmaScale = 2.0F;  // of the features: each pass weighs edges anew
constexpr int kNoiseMap = 3;                  // after the errors of the channels
constexpr std::size_t kLines = 4;

}  // namespace

std::vector<int> error_halos() {
  std::vector<int> halos;
  for (const int step : kErrorSteps) halos.push_back(GuidedPass::kRadius * step);
  return halos;
}

ErrorStages::ErrorStages(const Source& source, const LayerSource& layers, const DenoiseParams& params,
                         const MixtureRows& filtered, const GuideRows& guides,
                         const exec::RowPipelineGeometry& geometry, int ring_rows, int slots, DenoiseResult& result)
    : source_(source),
      layers_(layers),
      params_(params),
      filtered_(filtered),
      guides_(guides),
      geometry_(geometry),
      result_(result),
      ring_rows_(ring_rows),
      relative_errors_(static_cast<std::size_t>((geometry.width + kSumBlock - 1) / kSumBlock) *
                       static_cast<std::size_t>(geometry.height)) {
  lines_.assign(static_cast<std::size_t>(slots),
                std::vector<float>(kLines * static_cast<std::size_t>(geometry.tile_width)));
  raw_errors_ = add_ring(params_.density.rule == DensityRule::kAllSamples ? kNoiseMap + 1 : kNoiseMap);
  list_.push_back({"error", 0, 0.1, [this](const Rect& tile, int slot) { assess(tile, slot); }});
  add_passes();
}

MapRows ErrorStages::add_ring(int planes) {
  rings_.push_back(std::make_unique<exec::RowRing>(planes, geometry_.width, ring_rows_));
  return {rings_.back().get(), planes, -1};
}

void ErrorStages::add_passes() {
  MapRows maps = raw_errors_;
  for (std::size_t i = 0; i < kErrorSteps.size(); ++i) {
    const GuidedPass pass{PassKernel::kB3Spline, kErrorSteps[i], kSmoothingSigmaScale, 1.0F};
    const MapRows out = add_ring(maps.count);
    const bool is_last = i + 1 == kErrorSteps.size();
    list_.push_back({"smooth error", pass.halo(), 1.0, [this, pass, maps, out, is_last](const Rect& tile, int slot) {
                       run_guided_pass(pass, guides_, geometry_.height, tile, maps, out);
                       if (is_last) finish(tile, slot);
                     }});
    maps = out;
  }
  errors_ = maps;
}

void ErrorStages::assess(const Rect& tile, int slot) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    assess_row(tile, y, lines_of(slot));
    finish_layers_row(layers_, filtered_, params_.strength, tile, y, lines_of(slot), result_.layers);
  }
}

// The mixture of the filtered picture and the input that `strength` says, and its risk.
void ErrorStages::assess_row(const Rect& tile, int y, float* lines) {
  const int n = tile.width();
  const auto line = [&](int i) { return lines + i * geometry_.tile_width; };
  float* mean = line(0);
  float* variance = line(1);
  float* D = line(2);
  const float strength = params_.strength;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    source_.input_row(channel, y, tile.x0, n, mean, variance);
    const float* filtered = filtered_.result(c, y) + tile.x0;
    const float* divergence = filtered_.divergence(c, y) + tile.x0;
    float* F = result_.colour[channel].row(y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      F[i] = strength * filtered[i] + (1.0F - strength) * mean[i];
      D[i] = strength * divergence[i] + (1.0F - strength) * variance[i];
    }
    float* risk = raw_errors_.row(c, y) + tile.x0;
    sure_row(F, D, mean, variance, n, risk);
    add_relative_error(tile, y, F, risk);
    if (raw_errors_.count > kNoiseMap) {
      float* noise = raw_errors_.row(kNoiseMap, y) + tile.x0;
      if (c == 0) std::fill_n(noise, n, 0.0F);
      add_kept_noise(F, D, n, noise);
    }
  }
}

void ErrorStages::add_relative_error(const Rect& tile, int y, const float* F, const float* risk) {
  const auto blocks = static_cast<std::size_t>((geometry_.width + kSumBlock - 1) / kSumBlock);
  double* sums = relative_errors_.data() + static_cast<std::size_t>(y) * blocks;
  for (int i = 0; i < tile.width(); ++i) {
    sums[(tile.x0 + i) / kSumBlock] += risk[i] / (static_cast<double>(F[i]) * F[i] + kRelativeEpsilon);
  }
}

double ErrorStages::mean_relative_error() const {
  const double sum = std::accumulate(relative_errors_.begin(), relative_errors_.end(), 0.0);
  return sum / (3.0 * geometry_.width * geometry_.height);
}

void ErrorStages::finish(const Rect& tile, int slot) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int c = 0; c < 3; ++c) {
      std::copy_n(errors_.row(c, y) + tile.x0, tile.width(),
                  result_.error[static_cast<std::size_t>(c)].row(y) + tile.x0);
    }
    density_row(tile, y, lines_of(slot));
  }
}

void ErrorStages::density_row(const Rect& tile, int y, float* lines) {
  float* density = result_.density.row(y) + tile.x0;
  if (params_.density.rule == DensityRule::kAllSamples) {
    all_samples_row(source_, tile, y, errors_.row(kNoiseMap, y) + tile.x0, lines, density);
  } else {
    next_samples_row(source_, params_, result_, tile, y, lines, geometry_.tile_width, density);
  }
}

}  // namespace stein
