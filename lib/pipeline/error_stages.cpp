// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/error_stages.hpp"

#include <algorithm>

#include "pipeline/density_rows.hpp"
#include "pipeline/layers.hpp"
#include "pipeline/relative_risk.hpp"
#include "risk/sure.hpp"

namespace stein {
namespace {

const std::vector<int> kErrorSteps = {1, 2, 4};
constexpr float kSmoothingSigmaScale = 2.0F;  // of the features: each pass weighs edges anew
constexpr int kNoiseMap = 3;                  // after the predictors of the channels
constexpr std::size_t kLines = 4;
constexpr std::size_t kBlocksToTrim = 65536;  // a MiB

}  // namespace

std::vector<int> error_halos() {
  std::vector<int> halos;
  for (const int step : kErrorSteps) halos.push_back(GuidedPass::kRadius * step);
  return halos;
}

ErrorStages::ErrorStages(const Source& source, const LayerSource& layers, const OutlierEnergy& energy,
                         const DenoiseParams& params, const MixtureRows& filtered, const GuideRows& guides,
                         const exec::RowPipelineGeometry& geometry, int slots, DenoiseResult& result)
    : source_(source),
      layers_(layers),
      energy_(energy),
      params_(params),
      filtered_(filtered),
      guides_(guides),
      geometry_(geometry),
      result_(result),
      calibrations_{ErrorCalibration(slots), ErrorCalibration(slots), ErrorCalibration(slots)} {
  const auto blocks = static_cast<std::size_t>((geometry.width + kSumBlock - 1) / kSumBlock);
  for (int c = 0; c < 3; ++c) sums_.emplace_back(blocks * static_cast<std::size_t>(geometry.height), source.memory());
  lines_.assign(static_cast<std::size_t>(slots),
                std::vector<float>(kLines * static_cast<std::size_t>(geometry.tile_width)));
  risks_ = add_ring(3, exec::ring_capacity(geometry, error_halos()));  // until the predictors are smooth
  predictors_ = add_ring(params_.density.rule == DensityRule::kAllSamples ? kNoiseMap + 1 : kNoiseMap,
                         exec::window_between(geometry, error_halos()));
  list_.push_back({"error", 0, 0.1, [this](const Rect& tile, int slot) { assess(tile, slot); }});
  add_passes();
}

MapRows ErrorStages::add_ring(int planes, int rows) {
  rings_.push_back(std::make_unique<exec::RowRing>(planes, geometry_.width, rows, source_.memory()));
  return {rings_.back().get(), planes, -1};
}

void ErrorStages::add_passes() {
  MapRows maps = predictors_;
  for (std::size_t i = 0; i < kErrorSteps.size(); ++i) {
    const GuidedPass pass{PassKernel::kB3Spline, kErrorSteps[i], kSmoothingSigmaScale, 1.0F};
    const MapRows out = add_ring(maps.count, exec::window_between(geometry_, error_halos()));
    const bool is_last = i + 1 == kErrorSteps.size();
    list_.push_back({"smooth error", pass.halo(), 1.0, [this, pass, maps, out, is_last](const Rect& tile, int slot) {
                       run_guided_pass(pass, guides_, geometry_.height, tile, maps, out);
                       if (is_last) collect(tile, slot);
                     }});
    maps = out;
  }
  smooth_predictors_ = maps;
}

void ErrorStages::assess(const Rect& tile, int slot) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    assess_row(tile, y, lines_of(slot));
    finish_layers_row(layers_, energy_, filtered_, params_.strength, tile, y, lines_of(slot), result_.layers);
  }
}

// The mixture of the filtered picture, with what outliers lost, and the input that `strength` says, and its risk.
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
    const float* optimism = filtered_.optimism(y) + tile.x0;  // of relative risks, which have 2 D
    float* F = result_.colour[channel].row(y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      F[i] = strength * filtered[i] + (1.0F - strength) * mean[i];
      const float own = divergence[i] + 0.5F * optimism[i] * (filtered[i] * filtered[i] + kRelativeEpsilon);
      D[i] = strength * own + (1.0F - strength) * variance[i];
    }
    energy_.add_colour(c, y, tile.x0, n, strength, F);
    energy_.add_divergence(c, y, tile.x0, n, strength, D);
    float* risk = risks_.row(c, y) + tile.x0;
    sure_row(F, D, mean, variance, n, risk);
    add_to_means(tile, c, y, F, risk);
    float* predictor = predictors_.row(c, y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      const float weight = 1.0F / (F[i] * F[i] + kRelativeEpsilon);
      risk[i] *= weight;
      predictor[i] = std::max(D[i], 0.0F) * weight;
    }
    if (predictors_.count > kNoiseMap) {
      float* noise = predictors_.row(kNoiseMap, y) + tile.x0;
      if (c == 0) std::fill_n(noise, n, 0.0F);
      add_kept_noise(F, D, n, noise);
    }
  }
}

void ErrorStages::add_to_means(const Rect& tile, int channel, int y, const float* F, const float* risk) {
  const auto blocks = static_cast<std::size_t>((geometry_.width + kSumBlock - 1) / kSumBlock);
  Sums* sums = sums_[static_cast<std::size_t>(channel)].data() + static_cast<std::size_t>(y) * blocks;
  for (int i = 0; i < tile.width(); ++i) {
    Sums& block = sums[(tile.x0 + i) / kSumBlock];
    block.error += risk[i];
    block.relative_error += risk[i] / (static_cast<double>(F[i]) * F[i] + kRelativeEpsilon);
  }
}

// The predictors wait in the planes of the error for calibrate().
void ErrorStages::collect(const Rect& tile, int slot) {
  const int n = tile.width();
  float* mask = lines_of(slot);
  for (int y = tile.y0; y < tile.y1; ++y) {
    source_.mask_row(y, tile.x0, n, mask);
    for (int c = 0; c < 3; ++c) {
      const auto channel = static_cast<std::size_t>(c);
      const float* predictor = smooth_predictors_.row(c, y) + tile.x0;
      calibrations_[channel].add(slot, predictor, risks_.row(c, y) + tile.x0, mask, n);
      std::copy_n(predictor, n, result_.error[channel].row(y) + tile.x0);
    }
    if (params_.density.rule == DensityRule::kAllSamples) {
      all_samples_row(source_, tile, y, smooth_predictors_.row(kNoiseMap, y) + tile.x0, lines_of(slot),
                      result_.density.row(y) + tile.x0);
    }
  }
}

void ErrorStages::calibrate(exec::Runner& runner) {
  for (ErrorCalibration& calibration : calibrations_) calibration.fit();
  report_means();
  const float doubt = add_doubt();
  runner.for_each(geometry_.height, 0.0, [this, doubt](int y, int slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float* F = result_.colour[c].row(y);
      float* error = result_.error[c].row(y);
      for (int x = 0; x < geometry_.width; ++x)
        error[x] = calibrations_[c].error(error[x]) * (F[x] * F[x] + kRelativeEpsilon);
      if (doubt == 0.0F) continue;
      const float* first = first_->error[c].row(y);
      for (int x = 0; x < geometry_.width; ++x) error[x] += doubt * first[x];
    }
    if (params_.density.rule == DensityRule::kAllSamples) return;
    for (int x = 0; x < geometry_.width; x += geometry_.tile_width) {
      const Rect part{x, y, std::min(x + geometry_.tile_width, geometry_.width), y + 1};
      next_samples_row(source_, params_, result_, part, y, lines_of(slot), geometry_.tile_width,
                       result_.density.row(y) + x);
    }
  });
}

// Adds to the means; returns how many times the first pass's error comes to a pixel's own.
float ErrorStages::add_doubt() {
  if (first_ == nullptr || first_->mean_relative_error <= 0) return 0;
  DenoiseReport& report = result_.report;
  const double gain = std::max(first_->mean_relative_error - report.mean_relative_error, 0.0);
  const double doubt = params_.strength * second_weight_ * gain / first_->mean_relative_error;
  for (std::size_t c = 0; c < 3; ++c) report.mean_error[c] += doubt * first_->mean_error[c];
  report.mean_relative_error += doubt * first_->mean_relative_error;
  return static_cast<float>(doubt);
}

void ErrorStages::report_means() {
  const double pixels = static_cast<double>(geometry_.width) * geometry_.height;
  double relative = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    double error = 0;
    for (std::size_t i = 0; i < sums_[c].size(); ++i) {
      if (i % kBlocksToTrim == 0 && source_.memory() != nullptr) source_.memory()->trim();
      error += sums_[c][i].error;
      relative += sums_[c][i].relative_error;
    }
    result_.report.mean_error[c] = error / pixels;
  }
  result_.report.mean_relative_error = relative / (3.0 * pixels);
}

}  // namespace stein
