// SPDX-License-Identifier: Apache-2.0
//
// SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
#include "pipeline/choice_stages.hpp"

#include <algorithm>

#include "pipeline/relative_risk.hpp"
#include "select/selection.hpp"

namespace stein {
namespace {

// Smoothing of the risk maps: 5x5 taps 1, 2, 4 pixels apart reach 14 pixels at 75 taps, where the paper's sigma_s = 8
// would take 800. Feature sigmas are doubled: each pass weighs edges anew, and three narrow passes would smooth too
// little.
const std::vector<int> kRiskSteps = {1, 2, 4};
const std::vector<int> kWeightSteps = {1, 2};
constexpr float kSmoothingSigmaScale = 2.0F;

}  // namespace

std::vector<int> choice_halos(Selection selection) {
  std::vector<int> halos;
  for (const int step : kRiskSteps) halos.push_back(GuidedPass::kRadius * step);
  if (selection == Selection::kEvidence) {
    for (const int step : kWeightSteps) halos.push_back(GuidedPass::kRadius * step);
  }
  return halos;
}

ChoiceStages::ChoiceStages(const Source& source, Selection selection, FilterRuns& runs, const Survey* prior,
                           Surveyor& surveyor, const exec::RowPipelineGeometry& geometry, int slots, const Mixture& out)
    : source_(source),
      selection_(selection),
      runs_(runs),
      geometry_(geometry),
      out_(out),
      ring_rows_(exec::window_between(geometry, choice_halos(selection))),
      entries_(runs.entries()),
      surveyor_(prior == nullptr ? &surveyor : nullptr),
      weighs_evidence_(prior != nullptr),
      baseline_(prior != nullptr ? prior->best : 0) {
  for (std::size_t e = 0; prior != nullptr && e < prior->mean_risk.size(); ++e)
    prior_.push_back(prior->mean_risk[e] - prior->mean_risk[static_cast<std::size_t>(baseline_)]);
  constexpr std::size_t lines = std::max(kRelativeRiskLines + kMaxEntries, 2 * kMaxEntries);
  lines_.assign(static_cast<std::size_t>(slots),
                std::vector<float>(lines * static_cast<std::size_t>(geometry.tile_width)));
  plan();
}

void ChoiceStages::plan() {
  const int others = entries_ - 1;
  differences_ = add_ring(others + 1);
  choices_ = add_ring(weighs_evidence_ ? entries_ + 1 : entries_);
  runs_.add_stages(
      {}, [this](const Rect& tile, int slot) { compare(tile, slot); }, list_);
  add_risk_passes();
  if (selection_ == Selection::kEvidence) {
    weights_ = add_passes("select", choices_, kWeightSteps, &ChoiceStages::mix);
  } else {
    weights_ = choices_;
    list_.push_back({"select", 0, 0.1, [this](const Rect& tile, int slot) { mix(tile, slot); }});
  }
}

// The differences of the risks through all passes, and their squares through the last one: how much they vary around a
// pixel. Box weights are the widest for their taps; that several passes leave a faint grid around isolated values does
// not matter where only the order of the results counts.
void ChoiceStages::add_risk_passes() {
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
             is_last                               ? &ChoiceStages::pick
             : is_next_to_last && weighs_evidence_ ? &ChoiceStages::square
                                                   : nullptr);
    if (is_next_to_last && weighs_evidence_) out.count = 2 * others;
    maps = out;
  }
  evidence_ = maps;
}

MapRows ChoiceStages::add_ring(int planes) {
  rings_.push_back(std::make_unique<exec::RowRing>(planes, geometry_.width, ring_rows_, source_.memory()));
  return {rings_.back().get(), planes, -1};
}

void ChoiceStages::add_pass(const std::string& name, const GuidedPass& pass, MapRows in, MapRows out, TileStep then) {
  list_.push_back({name, pass.halo(), 1.0, [this, pass, in, out, then](const Rect& tile, int slot) {
                     run_guided_pass(pass, runs_.guides(), geometry_.height, tile, in, out);
                     if (then != nullptr) (this->*then)(tile, slot);
                   }});
}

MapRows ChoiceStages::add_passes(const std::string& name, MapRows maps, const std::vector<int>& steps, TileStep then) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const MapRows out = add_ring(maps.count);
    add_pass(name, {PassKernel::kB3Spline, steps[i], kSmoothingSigmaScale, 1.0F}, maps, out,
             i + 1 == steps.size() ? then : nullptr);
    maps = out;
  }
  return maps;
}

// Relative risks, clipped, minus that of the baseline.
void ChoiceStages::compare(const Rect& tile, int slot) {
  if (surveyor_ != nullptr) {
    for (const Rect& part : surveyor_->parts(tile, 0)) surveyor_->add(part, slot);
  }
  const int n = tile.width();
  const float limit = runs_.risk_limit();
  const std::ptrdiff_t pitch = geometry_.tile_width;
  float* lines = lines_of(slot);
  float* risks[kMaxEntries];
  for (int e = 0; e < entries_; ++e) risks[e] = lines + (kRelativeRiskLines + e) * pitch;
  for (int y = tile.y0; y < tile.y1; ++y) {
    relative_risk_rows(source_, runs_.candidates(), entries_, runs_.common_candidate(), tile, y, lines, pitch, risks);
    for (int e = 0; e < entries_; ++e) {
      for (int i = 0; i < n; ++i) risks[e][i] = std::clamp(risks[e][i], -limit, limit);
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

void ChoiceStages::square(const Rect& tile, int /*slot*/) {
  const int others = entries_ - 1;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int m = 0; m < others; ++m) {
      const float* difference = differences_.row(m, y) + tile.x0;
      float* squared = squares_.row(others + m, y) + tile.x0;
      for (int i = 0; i < tile.width(); ++i) squared[i] = difference[i] * difference[i];
    }
  }
}

// The entry that is best by what is known.
void ChoiceStages::pick(const Rect& tile, int slot) {
  const int n = tile.width();
  float* maps[kMaxEntries];
  for (int y = tile.y0; y < tile.y1; ++y) {
    int m = 0;
    for (int e = 0; e < entries_; ++e) {
      maps[e] = choices_.row(e, y) + tile.x0;
      if (e == baseline_) {
        std::fill_n(maps[e], n, 0.0F);
      } else {
        std::copy_n(evidence_.row(m++, y) + tile.x0, n, maps[e]);
      }
    }
    if (weighs_evidence_) weigh(tile, y, maps, lines_of(slot));
    argmin_row(maps, entries_, n);
  }
}

// Local evidence counts as far as it goes beyond its standard error, before that of the image.
void ChoiceStages::weigh(const Rect& tile, int y, float* const* maps, float* lines) {
  const int n = tile.width();
  const int others = entries_ - 1;
  const float* inverse_count = evidence_.row(evidence_.inverse_count, y) + tile.x0;
  float* variances[kMaxEntries];
  float* rivals[kMaxEntries];
  int m = 0;
  for (int e = 0; e < entries_; ++e) {
    const float prior = prior_[static_cast<std::size_t>(e)];
    variances[e] = lines + std::ptrdiff_t{e} * geometry_.tile_width;
    rivals[e] = variances[e] + std::ptrdiff_t{kMaxEntries} * geometry_.tile_width;
    if (e == baseline_) {
      std::fill_n(variances[e], n, 0.0F);
    } else {
      const float* square = evidence_.row(others + m++, y) + tile.x0;
      standard_error_row(maps[e], square, inverse_count, n, variances[e]);
      shrink_row(maps[e], variances[e], prior, n, maps[e]);
    }
    handicap_row(maps[e], variances[e], prior, n, rivals[e]);
  }
  optimism_row(rivals, variances, entries_, n, choices_.row(entries_, y) + tile.x0);
}

void ChoiceStages::mix(const Rect& tile, int /*slot*/) {
  const float* maps[kMaxEntries];
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int e = 0; e < entries_; ++e) maps[e] = weights_.row(e, y) + tile.x0;
    largest_row(maps, entries_, tile.width(), out_.choice->row(y) + tile.x0);
    const CandidateRows candidates = runs_.candidates();
    const auto candidate = [&](int k, int plane) { return candidates.row(k, plane, y) + tile.x0; };
    mix_row(source_, runs_.layers(), candidate, maps, entries_, tile, y, out_.rows);
    float* optimism = out_.rows.optimism(y) + tile.x0;
    if (weighs_evidence_) {
      std::copy_n(weights_.row(entries_, y) + tile.x0, tile.width(), optimism);
    } else {
      std::fill_n(optimism, tile.width(), 0.0F);
    }
  }
}

}  // namespace stein
