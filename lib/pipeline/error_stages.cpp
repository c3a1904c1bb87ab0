// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/error_stages.hpp"

#include <algorithm>

#include "pipeline/density_rows.hpp"
#include "pipeline/layers.hpp"
#include "pipeline/mean_error.hpp"
#include "pipeline/relative_risk.hpp"
#include "pipeline/surroundings.hpp"
#include "risk/sure.hpp"

namespace stein {
namespace {

constexpr std::array kErrorSteps = {1, 2, 4};
// What the last pass is behind the first stage, its ring still has.
static_assert(kSurroundings <= GuidedPass::kRadius * kErrorSteps.back());
constexpr float kSmoothingSigmaScale = 2.0F;  // of the features: each pass weighs edges anew
constexpr int kNoiseMap = 3;                  // after the predictors of the channels
constexpr int kLikelyErrors = 3;              // after the risks
constexpr float kErrorsAround = 3.0F;         // that a relative error is relative to at least
constexpr std::size_t kLines = 6;             // tiles are wide enough for 5 to hold one that goes beyond
constexpr int kArea = 32;  // px: the units of the means' standard errors, wide enough for neighbours that err together
constexpr int kBlocksOfArea = kArea / kSumBlock;
static_assert(kArea % kSumBlock == 0);

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
      blocks_((geometry.width + kSumBlock - 1) / kSumBlock),
      result_(result),
      calibrations_(3, ErrorCalibration(slots, std::int64_t{geometry.width} * geometry.height)) {
  for (int c = 0; c < 3; ++c) sums_.emplace_back(row_start(geometry.height), source.memory());
  lines_.assign(static_cast<std::size_t>(slots),
                std::vector<float>(kLines * static_cast<std::size_t>(geometry.tile_width)));
  // Until the predictors are smooth.
  risks_ = add_ring(kLikelyErrors + 3, exec::ring_capacity(geometry, error_halos()));
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

// The mixture of the filtered picture, with what outliers lost, and the input that `strength` t says; its risk; and its
// error if that of the filtered picture is D: t^2 D + 2 t (1 - t) D + (1 - t)^2 v.
void ErrorStages::assess_row(const Rect& tile, int y, float* lines) {
  const int n = tile.width();
  const auto line = [&](int i) { return lines + i * geometry_.tile_width; };
  float* mean = line(0);
  float* variance = line(1);
  float* D = line(2);
  float* own = line(3);
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
      own[i] = divergence[i] + 0.5F * optimism[i] * (filtered[i] * filtered[i] + kRelativeEpsilon);
    }
    energy_.add_colour(c, y, tile.x0, n, strength, F);
    energy_.add_divergence(c, y, tile.x0, n, 1.0F, own);
    float* likely = risks_.row(kLikelyErrors + c, y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      D[i] = strength * own[i] + (1.0F - strength) * variance[i];
      likely[i] = strength * own[i] + (1.0F - strength) * D[i];
    }
    float* risk = risks_.row(c, y) + tile.x0;
    sure_row(F, D, mean, variance, n, risk);
    float* predictor = predictors_.row(c, y) + tile.x0;
    for (int i = 0; i < n; ++i) predictor[i] = std::max(D[i], 0.0F) / (F[i] * F[i] + kRelativeEpsilon);
    if (predictors_.count > kNoiseMap) {
      float* noise = predictors_.row(kNoiseMap, y) + tile.x0;
      if (c == 0) std::fill_n(noise, n, 0.0F);
      add_kept_noise(F, D, n, noise);
    }
  }
}

// The predictors wait in the planes of the error for calibrate().
void ErrorStages::collect(const Rect& tile, int slot) {
  const int n = tile.width();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int c = 0; c < 3; ++c) {
      collect_row(tile, c, y, slot);
      std::copy_n(smooth_predictors_.row(c, y) + tile.x0, n,
                  result_.error[static_cast<std::size_t>(c)].row(y) + tile.x0);
    }
    if (params_.density.rule == DensityRule::kAllSamples) {
      all_samples_row(source_, tile, y, smooth_predictors_.row(kNoiseMap, y) + tile.x0, lines_of(slot),
                      result_.density.row(y) + tile.x0);
    }
  }
}

// Sums of pixels that were measured: of a filled one there is nothing that its value could be compared with.
void ErrorStages::collect_row(const Rect& tile, int channel, int y, int slot) {
  const int n = tile.width();
  float* weight = lines_of(slot);
  float* relative_risk = weight + geometry_.tile_width;
  float* relative_likely = relative_risk + geometry_.tile_width;
  float* scratch = relative_likely + geometry_.tile_width;
  const auto c = static_cast<std::size_t>(channel);
  const float* F = result_.colour[c].row(y) + tile.x0;
  const float* risk = risks_.row(channel, y) + tile.x0;
  const float* likely = risks_.row(kLikelyErrors + channel, y) + tile.x0;
  weigh_row(tile, channel, y, weight, scratch);
  Sums* sums = sums_[c].data() + row_start(y);
  for (int i = 0; i < n; ++i) {
    const float square = F[i] * F[i] + kRelativeEpsilon;
    relative_risk[i] = risk[i] / square;
    relative_likely[i] = likely[i] / square;
    if (weight[i] == 0.0F) continue;
    Sums& block = sums[(tile.x0 + i) / kSumBlock];
    block.risk += risk[i];
    block.likely += likely[i];
    block.relative_risk += static_cast<double>(weight[i]) * relative_risk[i];
    block.relative_likely += static_cast<double>(weight[i]) * relative_likely[i];
  }
  calibrations_[c].add(slot, smooth_predictors_.row(channel, y) + tile.x0, relative_risk, relative_likely, weight, n);
}

// How much an error relative to F^2 + 0.01 counts: as if it were relative to 3 d where that is more, d the error that
// is likely around. relMSE is relative to the square of the truth, which is F^2 give or take that error: at the rims of
// lamps, where F is now and then too dark by more than it has, F^2 alone would have a few pixels count many times. The
// pixel's own noise has no say, or those with little of it would count more. 0 of filled pixels.
void ErrorStages::weigh_row(const Rect& tile, int channel, int y, float* weight, float* scratch) {
  const int n = tile.width();
  std::array<const float*, 2 * kSurroundings + 1> rows{};
  int count = 0;
  for (int near = std::max(y - kSurroundings, 0); near <= std::min(y + kSurroundings, geometry_.height - 1); ++near)
    rows[static_cast<std::size_t>(count++)] = risks_.row(kLikelyErrors + channel, near);
  float* around = scratch;
  mean_around_row({rows.data(), count, geometry_.width}, risks_.row(kLikelyErrors + channel, y), tile.x0, n,
                  scratch + geometry_.tile_width, around);
  const float* F = result_.colour[static_cast<std::size_t>(channel)].row(y) + tile.x0;
  source_.mask_row(y, tile.x0, n, weight);
  for (int i = 0; i < n; ++i) {
    const float square = F[i] * F[i] + kRelativeEpsilon;
    weight[i] *= square / std::max(square, kErrorsAround * around[i]);
  }
}

void ErrorStages::calibrate(exec::Runner& runner) {
  const double evidence = report_means();
  for (ErrorCalibration& calibration : calibrations_) calibration.fit(evidence);
  runner.for_each(geometry_.height, 0.0, [this](int y, int slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float* F = result_.colour[c].row(y);
      float* error = result_.error[c].row(y);
      for (int x = 0; x < geometry_.width; ++x)
        error[x] = calibrations_[c].error(error[x]) * (F[x] * F[x] + kRelativeEpsilon);
    }
    if (params_.density.rule == DensityRule::kAllSamples) return;
    for (int x = 0; x < geometry_.width; x += geometry_.tile_width) {
      const Rect part{x, y, std::min(x + geometry_.tile_width, geometry_.width), y + 1};
      next_samples_row(source_, params_, result_, part, y, lines_of(slot), geometry_.tile_width,
                       result_.density.row(y) + x);
    }
  });
}

ErrorStages::Sums ErrorStages::area_sums(std::size_t channel, int column, int row) const {
  Sums area;
  for (int y = row * kArea; y < std::min((row + 1) * kArea, geometry_.height); ++y) {
    for (int b = column * kBlocksOfArea; b < std::min((column + 1) * kBlocksOfArea, blocks_); ++b) {
      const Sums& block = sums_[channel][row_start(y) + static_cast<std::size_t>(b)];
      area.risk += block.risk;
      area.likely += block.likely;
      area.relative_risk += block.relative_risk;
      area.relative_likely += block.relative_likely;
    }
  }
  return area;
}

// Measured pixels of areas in a row of these.
std::vector<double> ErrorStages::area_pixels(int row) const {
  std::vector<float> mask(static_cast<std::size_t>(geometry_.width));
  std::vector<double> pixels(static_cast<std::size_t>((geometry_.width + kArea - 1) / kArea), 0.0);
  for (int y = row * kArea; y < std::min((row + 1) * kArea, geometry_.height); ++y) {
    source_.mask_row(y, 0, geometry_.width, mask.data());
    for (std::size_t x = 0; x < mask.size(); ++x) pixels[x / kArea] += mask[x] != 0.0F ? 1.0 : 0.0;
  }
  return pixels;
}

// Returns how far the relative error goes from what is likely to its risk.
double ErrorStages::report_means() {
  std::array<MeanError, 3> errors;
  MeanError relative_error;
  for (int row = 0; row * kArea < geometry_.height; ++row) {
    const std::vector<double> pixels = area_pixels(row);
    if (source_.memory() != nullptr) source_.memory()->trim();
    for (int column = 0; column * kArea < geometry_.width; ++column) {
      const double count = pixels[static_cast<std::size_t>(column)];
      Sums all;
      for (std::size_t c = 0; c < 3; ++c) {
        const Sums area = area_sums(c, column, row);
        errors[c].add(area.risk, area.likely, count);
        all.relative_risk += area.relative_risk;
        all.relative_likely += area.relative_likely;
      }
      relative_error.add(all.relative_risk, all.relative_likely, 3.0 * count);
    }
  }
  for (std::size_t c = 0; c < 3; ++c) result_.report.mean_error[c] = errors[c].mean();
  result_.report.mean_relative_error = relative_error.mean();
  return relative_error.evidence();
}

}  // namespace stein
