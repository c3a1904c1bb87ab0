// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/stages.hpp"

#include <algorithm>
#include <cmath>

#include "risk/sure.hpp"
#include "select/selection.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

// Smoothing of the risk maps: 5x5 taps 1, 2, 4 pixels apart reach 14 pixels at 75 taps, where the paper's sigma_s = 8
// would take 800. Feature sigmas are doubled: each pass weighs edges anew, and three narrow passes would smooth too
// little.
const std::vector<int> kRiskSteps = {1, 2, 4};
const std::vector<int> kWeightSteps = {1, 2};
const std::vector<int> kErrorSteps = {1, 2, 4};
constexpr float kSmoothingSigmaScale = 2.0F;

constexpr float kRelativeEpsilon = 0.01F;  // of relative MSE, SBF sec. 5.2

// Reach of the filter, once for each run of it, and of all passes: the rows that windows must hold on either side.
std::vector<int> all_halos(const FilterSpec& filter, int runs) {
  std::vector<int> all;
  const auto append = [&](const std::vector<int>& halos) { all.insert(all.end(), halos.begin(), halos.end()); };
  for (int r = 0; r < runs; ++r) append(halos(filter));
  for (const std::vector<int>* steps : {&kRiskSteps, &kWeightSteps, &kErrorSteps}) {
    for (const int step : *steps) append({GuidedPass::kRadius * step});
  }
  return all;
}

int draws_of(const DenoiseParams& params, Risk risk) {
  return risk == Risk::kMonteCarlo ? params.monte_carlo.draws : 0;
}

}  // namespace

Stages::Stages(const Source& source, const DenoiseParams& params, Risk risk, const exec::RowPipelineGeometry& geometry,
               int slots, DenoiseResult& result)
    : source_(source),
      params_(params),
      geometry_(geometry),
      result_(result),
      ring_rows_(exec::ring_capacity(geometry, all_halos(params.filter, 1 + draws_of(params, risk)))) {
  add_run(risk, {});
  for (int draw = 0; draw < draws_of(params, risk); ++draw) {
    add_run(risk, Perturbation{params.monte_carlo.seed, draw, params.monte_carlo.step});
  }
  plan(slots);
}

void Stages::add_run(Risk risk, const std::optional<Perturbation>& perturbation) {
  auto run = std::make_unique<Run>();
  if (perturbation) run->perturbed.emplace(source_.perturbed(*perturbation));
  const Source& source = perturbation ? *run->perturbed : source_;
  run->guides.emplace(make_guides(params_.filter, source, ring_rows_));
  const Divergence divergence = risk == Risk::kJoint ? Divergence::kJoint : Divergence::kPlain;
  run->filter = prepare(params_.filter,
                        {source, *run->guides, geometry_.tile_width, geometry_.tile_height, ring_rows_, divergence});
  entries_ = run->filter->candidates() + 1;
  if (entries_ > kMaxEntries) {
    throw Error(ErrorCode::kInvalidArgument, "the filter has " + std::to_string(entries_ - 1) +
                                                 " candidates; at most " + std::to_string(kMaxEntries - 1) +
                                                 " can be chosen from");
  }
  run->candidates = add_ring((entries_ - 1) * CandidateRows::kPlanes);
  runs_.push_back(std::move(run));
}

void Stages::plan(int slots) {
  scratch_.resize(static_cast<std::size_t>(slots));
  constexpr std::size_t kLines = 12;
  lines_.assign(static_cast<std::size_t>(slots),
                std::vector<float>(kLines * static_cast<std::size_t>(geometry_.tile_width)));

  raw_risks_ = add_ring(entries_);
  raw_errors_ = add_ring(3);
  for (std::size_t r = 0; r < runs_.size(); ++r) plan_run(r);
  risks_ = add_passes("smooth risk", raw_risks_, PassKernel::kBox, kRiskSteps, &Stages::pick);
  if (params_.selection == Selection::kBlend) {
    weights_ = add_passes("select", risks_, PassKernel::kB3Spline, kWeightSteps, &Stages::mix);
  } else {
    weights_ = risks_;
    list_.push_back({"select", 0, 0.1, [this](const Rect& tile, int slot) { mix(tile, slot); }});
  }
  errors_ = add_passes("smooth error", raw_errors_, PassKernel::kB3Spline, kErrorSteps, &Stages::finish);
}

// The passes of one run of the filter. Its last one goes on with what needs nothing but the tile itself.
void Stages::plan_run(std::size_t index) {
  Run& run = *runs_[index];
  list_.push_back({"prepare", 0, 0.5, [&run](const Rect& tile, int /*slot*/) { run.guides->prepare(tile); }});
  const std::vector<int> passes = halos(params_.filter);
  for (std::size_t p = 0; p < passes.size(); ++p) {
    const bool is_last = p + 1 == passes.size();
    list_.push_back({index == 0 ? "filter" : "draw", passes[p], 15.0 / static_cast<double>(passes.size()),
                     [this, &run, index, p, is_last](const Rect& tile, int slot) {
                       const auto s = static_cast<std::size_t>(slot);
                       run.filter->run(static_cast<int>(p), tile, scratch_[s], CandidateRows(*run.candidates.ring));
                       if (is_last && index > 0) add_draw(run, tile, lines_[s].data());
                       if (is_last && index + 1 == runs_.size()) estimate_risk(tile, slot);
                     }});
  }
}

// Monte Carlo SURE: D = b (F(y + step b) - F(y)) / step, mean over the draws. With b of the joint covariance of colour
// and features its expectation is the sum of both derivative terms of Joint SURE Eq. 2.
void Stages::add_draw(const Run& draw, const Rect& tile, float* lines) {
  const int n = tile.width();
  const float factor = 1.0F / (params_.monte_carlo.step * static_cast<float>(params_.monte_carlo.draws));
  const bool is_first = &draw == runs_[1].get();
  const CandidateRows base(*runs_[0]->candidates.ring);
  const CandidateRows moved(*draw.candidates.ring);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int c = 0; c < 3; ++c) {
      float* b = lines;
      draw.perturbed->direction_row(static_cast<std::size_t>(c), y, tile.x0, n, b);
      for (int k = 0; k + 1 < entries_; ++k) {
        const float* F = base.result(k, c, y) + tile.x0;
        const float* F_moved = moved.result(k, c, y) + tile.x0;
        float* D = base.divergence(k, c, y) + tile.x0;
        for (int i = 0; i < n; ++i) D[i] = (is_first ? 0.0F : D[i]) + factor * b[i] * (F_moved[i] - F[i]);
      }
    }
  }
}

MapRows Stages::add_ring(int planes) {
  rings_.push_back(std::make_unique<exec::RowRing>(planes, geometry_.width, ring_rows_));
  return {rings_.back().get(), planes};
}

MapRows Stages::add_passes(const std::string& name, MapRows maps, PassKernel kernel, const std::vector<int>& steps,
                           TileStep then) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const GuidedPass pass{kernel, steps[i], kSmoothingSigmaScale};
    const MapRows out = add_ring(maps.count);
    const TileStep last = i + 1 == steps.size() ? then : nullptr;
    list_.push_back({name, pass.halo(), 1.0, [this, pass, maps, out, last](const Rect& tile, int slot) {
                       run_guided_pass(pass, *runs_[0]->guides, geometry_.height, tile, maps, out);
                       if (last != nullptr) (this->*last)(tile, slot);
                     }});
    maps = out;
  }
  return maps;
}

void Stages::estimate_risk(const Rect& tile, int slot) {
  for (int y = tile.y0; y < tile.y1; ++y) risk_row(tile, y, lines_[static_cast<std::size_t>(slot)].data());
}

// Relative risk of every entry: SURE (SBF Eq. 2) of each channel over F^2 + 0.01, mean over the channels. F is the same
// for all entries, that of a fairly wide candidate (sigma_s = 4 in both banks of the paper): weights of their own would
// favour entries that are too bright, and a noisy F correlates with the risk it weighs.
void Stages::risk_row(const Rect& tile, int y, float* lines) {
  const int n = tile.width();
  const auto line = [&](int i) { return lines + i * geometry_.tile_width; };
  float* mean = line(0);
  float* variance = line(1);
  float* colour = line(2);
  float* own_variance = line(3);
  float* weight = line(4);
  float* risk = line(5);
  const CandidateRows rows(*runs_[0]->candidates.ring);
  for (int e = 0; e < entries_; ++e) std::fill_n(raw_risks_.row(e, y) + tile.x0, n, 0.0F);
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    source_.input_row(channel, y, tile.x0, n, mean, variance);
    source_.colour_row(channel, y, tile.x0, n, colour);
    source_.variance_row(channel, y, tile.x0, n, own_variance);
    const float* common = rows.result(2 * (entries_ - 1) / 3, c, y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      weight[i] = 1.0F / (3.0F * (common[i] * common[i] + kRelativeEpsilon));
    }
    for (int e = 0; e < entries_; ++e) {
      const float* F = e == 0 ? colour : rows.result(e - 1, c, y) + tile.x0;
      const float* D = e == 0 ? own_variance : rows.divergence(e - 1, c, y) + tile.x0;
      sure_row(F, D, mean, variance, n, risk);
      float* sum = raw_risks_.row(e, y) + tile.x0;
      for (int i = 0; i < n; ++i) sum[i] += risk[i] * weight[i];
    }
  }
  for (int e = 0; e < entries_; ++e) {
    float* sum = raw_risks_.row(e, y) + tile.x0;
    for (int i = 0; i < n; ++i) sum[i] = std::clamp(sum[i], -kRiskLimit, kRiskLimit);
  }
}

void Stages::pick(const Rect& tile, int /*slot*/) {
  float* maps[kMaxEntries];
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int e = 0; e < entries_; ++e) maps[e] = risks_.row(e, y) + tile.x0;
    argmin_row(maps, entries_, tile.width());
  }
}

void Stages::mix(const Rect& tile, int slot) {
  const float* maps[kMaxEntries];
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int e = 0; e < entries_; ++e) maps[e] = weights_.row(e, y) + tile.x0;
    largest_row(maps, entries_, tile.width(), result_.choice.row(y) + tile.x0);
    mix_row(tile, y, lines_[static_cast<std::size_t>(slot)].data());
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
  const CandidateRows rows(*runs_[0]->candidates.ring);
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
    sure_row(F, D, mean, variance, n, raw_errors_.row(c, y) + tile.x0);
  }
}

void Stages::finish(const Rect& tile, int slot) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int c = 0; c < 3; ++c) {
      std::copy_n(errors_.row(c, y) + tile.x0, tile.width(),
                  result_.error[static_cast<std::size_t>(c)].row(y) + tile.x0);
    }
    density_row(tile, y, lines_[static_cast<std::size_t>(slot)].data());
  }
}

// SBF Eq. 9, before normalisation: S = (SURE + sigma^2) / (I^2 + eps), with the mean over the channels of the estimated
// error and of the per-sample variance, and I the luminance of the result. Sums below 0 count as 0.
void Stages::density_row(const Rect& tile, int y, float* lines) {
  const int n = tile.width();
  const auto line = [&](int i) { return lines + i * geometry_.tile_width; };
  float* count = line(0);
  float* mean = line(1);
  float* variance = line(2);
  float* luminance = line(3);
  float* density = result_.density.row(y) + tile.x0;
  sample_count_row(source_.frame(), y, tile.x0, n, count);
  std::fill_n(luminance, n, 0.0F);
  std::fill_n(density, n, 0.0F);
  for (std::size_t c = 0; c < 3; ++c) {
    source_.input_row(c, y, tile.x0, n, mean, variance);
    const float* error = result_.error[c].row(y) + tile.x0;
    const float* F = result_.colour[c].row(y) + tile.x0;
    for (int i = 0; i < n; ++i) {
      const float sample_variance = variance[i] > 0.0F ? variance[i] * count[i] : 0.0F;
      density[i] += (error[i] + sample_variance) / 3.0F;
      luminance[i] += params_.luminance_weights[c] * F[i];
    }
  }
  const float epsilon = params_.density.epsilon;
  for (int i = 0; i < n; ++i) density[i] = std::max(density[i], 0.0F) / (luminance[i] * luminance[i] + epsilon);
}

}  // namespace stein
