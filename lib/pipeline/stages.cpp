// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/stages.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/density_rows.hpp"
#include "pipeline/relative_risk.hpp"
#include "risk/sure.hpp"
#include "select/selection.hpp"

namespace stein {
namespace {

// Smoothing of the risk maps: 5x5 taps 1, 2, 4 pixels apart reach 14 pixels at 75 taps, where the paper's sigma_s = 8
// would take 800. Feature sigmas are doubled: each pass weighs edges anew, and three narrow passes would smooth too
// little.
const std::vector<int> kRiskSteps = {1, 2, 4};
const std::vector<int> kWeightSteps = {1, 2};
const std::vector<int> kErrorSteps = {1, 2, 4};
constexpr float kSmoothingSigmaScale = 2.0F;
constexpr int kNoiseMap = 3;  // after the errors of the channels

}  // namespace

int window_rows(const DenoiseParams& params, Risk risk, const exec::RowPipelineGeometry& geometry) {
  std::vector<int> halos = run_halos(params, risk);
  for (const std::vector<int>* steps : {&kRiskSteps, &kWeightSteps, &kErrorSteps}) {
    for (const int step : *steps) halos.push_back(GuidedPass::kRadius * step);
  }
  return exec::ring_capacity(geometry, halos);
}

Stages::Stages(const Source& source, const DenoiseParams& params, FilterRuns& runs, const Survey* prior,
               Surveyor& surveyor, const exec::RowPipelineGeometry& geometry, int ring_rows, int slots,
               DenoiseResult& result)
    : source_(source),
      params_(params),
      runs_(runs),
      geometry_(geometry),
      result_(result),
      ring_rows_(ring_rows),
      entries_(runs.entries()),
      surveyor_(prior == nullptr ? &surveyor : nullptr),
      weighs_evidence_(prior != nullptr),
      baseline_(prior != nullptr ? prior->best : 0),
      relative_errors_(static_cast<std::size_t>((geometry.width + kSumBlock - 1) / kSumBlock) *
                       static_cast<std::size_t>(geometry.height)) {
  for (std::size_t e = 0; prior != nullptr && e < prior->mean_risk.size(); ++e)
    prior_.push_back(prior->mean_risk[e] - prior->mean_risk[static_cast<std::size_t>(baseline_)]);
  constexpr std::size_t lines = kRelativeRiskLines + kMaxEntries;
  lines_.assign(static_cast<std::size_t>(slots),
                std::vector<float>(lines * static_cast<std::size_t>(geometry.tile_width)));
  plan();
}

void Stages::plan() {
  const int others = entries_ - 1;
  differences_ = add_ring(others + 1);
  choices_ = add_ring(entries_);
  raw_errors_ = add_ring(params_.density.rule == DensityRule::kAllSamples ? kNoiseMap + 1 : kNoiseMap);
  runs_.add_stages(
      {}, [this](const Rect& tile, int slot) { compare(tile, slot); }, list_);
  add_risk_passes();
  if (params_.selection == Selection::kEvidence) {
    weights_ = add_passes("select", choices_, kWeightSteps, &Stages::mix);
  } else {
    weights_ = choices_;
    list_.push_back({"select", 0, 0.1, [this](const Rect& tile, int slot) { mix(tile, slot); }});
  }
  errors_ = add_passes("smooth error", raw_errors_, kErrorSteps, &Stages::finish);
}

// The differences of the risks through all passes, and their squares through the last one: how much they vary around a
// pixel. Box weights are the widest for their taps; that several passes leave a faint grid around isolated values does
// not matter where only the order of the results counts.
void Stages::add_risk_passes() {
  const int others = entries_ - 1;
  const std::vector<float> overlaps = overlap_factors(PassKernel::kBox, kRiskSteps);
  MapRows maps = {differences_.ring, others, others};
  for (std::size_t i = 0; i < kRiskSteps.size(); ++i) {
    const GuidedPass pass{PassKernel::kBox, kRiskSteps[i], kSmoothingSigmaScale, overlaps[i]};
    const bool is_last = i + 1 == kRiskSteps.size();
    const bool is_next_to_last = i + 2 == kRiskSteps.size();
    const bool has_squares = is_last || is_next_to_last;
    MapRows out = add_ring(has_squares ? 2 * others + 1 : others + 1);
    out.count = maps.count;
    out.inverse_count = has_squares ? 2 * others : others;
    if (is_next_to_last) squares_ = out;
    add_pass("smooth risk", pass, maps, out,
             is_last                               ? &Stages::pick
             : is_next_to_last && weighs_evidence_ ? &Stages::square
                                                   : nullptr);
    if (is_next_to_last && weighs_evidence_) out.count = 2 * others;
    maps = out;
  }
  evidence_ = maps;
}

MapRows Stages::add_ring(int planes) {
  rings_.push_back(std::make_unique<exec::RowRing>(planes, geometry_.width, ring_rows_));
  return {rings_.back().get(), planes, -1};
}

void Stages::add_pass(const std::string& name, const GuidedPass& pass, MapRows in, MapRows out, TileStep then) {
  list_.push_back({name, pass.halo(), 1.0, [this, pass, in, out, then](const Rect& tile, int slot) {
                     run_guided_pass(pass, runs_.guides(), geometry_.height, tile, in, out);
                     if (then != nullptr) (this->*then)(tile, slot);
                   }});
}

MapRows Stages::add_passes(const std::string& name, MapRows maps, const std::vector<int>& steps, TileStep then) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const MapRows out = add_ring(maps.count);
    add_pass(name, {PassKernel::kB3Spline, steps[i], kSmoothingSigmaScale, 1.0F}, maps, out,
             i + 1 == steps.size() ? then : nullptr);
    maps = out;
  }
  return maps;
}

// Relative risks, clipped, minus that of the baseline.
void Stages::compare(const Rect& tile, int slot) {
  if (surveyor_ != nullptr) {
    for (const Rect& part : surveyor_->parts(tile)) surveyor_->add(part, slot);
  }
  const int n = tile.width();
  const std::ptrdiff_t pitch = geometry_.tile_width;
  float* lines = lines_of(slot);
  float* risks[kMaxEntries];
  for (int e = 0; e < entries_; ++e) risks[e] = lines + (kRelativeRiskLines + e) * pitch;
  for (int y = tile.y0; y < tile.y1; ++y) {
    relative_risk_rows(source_, runs_.candidates(), entries_, runs_.common_candidate(), tile, y, lines, pitch, risks);
    for (int e = 0; e < entries_; ++e) {
      for (int i = 0; i < n; ++i) risks[e][i] = std::clamp(risks[e][i], -kRiskLimit, kRiskLimit);
    }
    int map = 0;
    for (int e = 0; e < entries_; ++e) {
      if (e == baseline_) continue;
      float* difference = differences_.row(map++, y) + tile.x0;
      for (int i = 0; i < n; ++i) difference[i] = risks[e][i] - risks[baseline_][i];
    }
    std::fill_n(differences_.row(map, y) + tile.x0, n, 1.0F);  // each is the mean of one pixel
  }
}

void Stages::square(const Rect& tile, int /*slot*/) {
  const int others = entries_ - 1;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int m = 0; m < others; ++m) {
      const float* difference = differences_.row(m, y) + tile.x0;
      float* squared = squares_.row(others + m, y) + tile.x0;
      for (int i = 0; i < tile.width(); ++i) squared[i] = difference[i] * difference[i];
    }
  }
}

// The entry that is best by what is known: local evidence, as far as it goes beyond its standard error, before that of
// the image.
void Stages::pick(const Rect& tile, int /*slot*/) {
  const int n = tile.width();
  const int others = entries_ - 1;
  float* maps[kMaxEntries];
  for (int y = tile.y0; y < tile.y1; ++y) {
    int m = 0;
    for (int e = 0; e < entries_; ++e) {
      maps[e] = choices_.row(e, y) + tile.x0;
      if (e == baseline_) {
        std::fill_n(maps[e], n, 0.0F);
        continue;
      }
      const float* mean = evidence_.row(m, y) + tile.x0;
      if (weighs_evidence_) {
        const float* inverse_count = evidence_.row(evidence_.inverse_count, y) + tile.x0;
        shrink_row(mean, evidence_.row(others + m, y) + tile.x0, inverse_count, prior_[static_cast<std::size_t>(e)], n,
                   maps[e]);
      } else {
        std::copy_n(mean, n, maps[e]);
      }
      ++m;
    }
    argmin_row(maps, entries_, n);
  }
}

void Stages::mix(const Rect& tile, int slot) {
  const float* maps[kMaxEntries];
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int e = 0; e < entries_; ++e) maps[e] = weights_.row(e, y) + tile.x0;
    largest_row(maps, entries_, tile.width(), result_.choice.row(y) + tile.x0);
    mix_row(tile, y, lines_of(slot));
  }
}

// The mixture of the entries, then of that and the input as `strength` says, and its own risk: for given weights F and
// D of a mixture are the mixtures of F and D.
void Stages::mix_row(const Rect& tile, int y, float* lines) {
  const int n = tile.width();
  const auto line = [&](int i) { return lines + i * geometry_.tile_width; };
  float* mean = line(0);
  float* variance = line(1);
  float* F = line(2);
  float* D = line(3);
  const CandidateRows rows = runs_.candidates();
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    source_.input_row(channel, y, tile.x0, n, mean, variance);
    source_.colour_row(channel, y, tile.x0, n, F);
    source_.variance_row(channel, y, tile.x0, n, D);
    const float* input_weight = weights_.row(0, y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      F[i] *= input_weight[i];
      D[i] *= input_weight[i];
    }
    for (int k = 0; k + 1 < entries_; ++k) {
      const float* w = weights_.row(k + 1, y) + tile.x0;
      const float* Fk = rows.result(k, c, y) + tile.x0;
      const float* Dk = rows.divergence(k, c, y) + tile.x0;
      for (int i = 0; i < n; ++i) {
        F[i] += w[i] * Fk[i];
        D[i] += w[i] * Dk[i];
      }
    }
    const float strength = params_.strength;
    for (int i = 0; i < n; ++i) {
      F[i] = strength * F[i] + (1.0F - strength) * mean[i];
      D[i] = strength * D[i] + (1.0F - strength) * variance[i];
    }
    std::copy_n(F, n, result_.colour[channel].row(y) + tile.x0);
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

void Stages::add_relative_error(const Rect& tile, int y, const float* F, const float* risk) {
  const auto blocks = static_cast<std::size_t>((geometry_.width + kSumBlock - 1) / kSumBlock);
  double* sums = relative_errors_.data() + static_cast<std::size_t>(y) * blocks;
  for (int i = 0; i < tile.width(); ++i) {
    sums[(tile.x0 + i) / kSumBlock] += risk[i] / (static_cast<double>(F[i]) * F[i] + kRelativeEpsilon);
  }
}

double Stages::mean_relative_error() const {
  const double sum = std::accumulate(relative_errors_.begin(), relative_errors_.end(), 0.0);
  return sum / (3.0 * geometry_.width * geometry_.height);
}

void Stages::finish(const Rect& tile, int slot) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int c = 0; c < 3; ++c) {
      std::copy_n(errors_.row(c, y) + tile.x0, tile.width(),
                  result_.error[static_cast<std::size_t>(c)].row(y) + tile.x0);
    }
    density_row(tile, y, lines_of(slot));
  }
}

void Stages::density_row(const Rect& tile, int y, float* lines) {
  float* density = result_.density.row(y) + tile.x0;
  if (params_.density.rule == DensityRule::kAllSamples) {
    all_samples_row(source_, tile, y, errors_.row(kNoiseMap, y) + tile.x0, lines, density);
  } else {
    next_samples_row(source_, params_, result_, tile, y, lines, geometry_.tile_width, density);
  }
}

}  // namespace stein
