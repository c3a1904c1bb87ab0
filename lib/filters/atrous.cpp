// SPDX-License-Identifier: Apache-2.0
//
// Edge-avoiding à-trous filter, plain and with shrunk details. SURE-À-Trous: Kim, Moon, Yoon, "SURE-based À-Trous
// Wavelet Filter for Interactive Monte Carlo Rendering", 2016.
//
// Where this differs from the paper, and what its gaps were filled with: docs/filters/atrous.md.
#include "filters/atrous.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "filters/filter.hpp"
#include "kernels/atrous.hpp"
#include "kernels/guided_smooth.hpp"

namespace stein {
namespace {

constexpr int kRadius = kernels::kAtrousTaps / 2;
constexpr int kSmoothingHalo = 2;  // of the variances
constexpr std::array<float, kernels::kAtrousTaps> kSpline = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};
constexpr float kFeatureSigmaFall = 0.8F;  // of all feature sigmas from level to level
constexpr float kMostNoise = 1e30F;
constexpr int kNoisePlane = 3;  // of a level's planes, after the colour
constexpr int kFirstLayerPlane = kNoisePlane + 1;

// What the two filters differ in.
struct Detail {
  float fixed_weight = 0;  // below 0: by SURE
  float margin = 1;
  int weight_steps = 0;
  bool has_plain = false;  // the last level's means are candidate 1
};

// Pass 0 reads the frame: colours, and the noise, smoothed along the features. Pass 1 + i goes from level i to the
// next.
class Atrous final : public PreparedFilter {
 public:
  Atrous(const AtrousParams& params, const Detail& detail, const FilterContext& context)
      : source_(context.source),
        guides_(context.guides),
        layers_(context.layers),
        detail_(detail),
        levels_(params.levels),
        value_factor_(params.value_sigma > 0.0F
                          ? static_cast<float>(std::numbers::log2e / (2.0 * params.value_sigma * params.value_sigma))
                          : 0.0F),
        layout_(context.tile_width, context.tile_height, kSmoothingHalo) {
    for (int i = 0; i < levels_; ++i) {
      const int layers = layers_ != nullptr ? layers_->channels() : 0;
      rings_.emplace_back(kFirstLayerPlane + layers, source_.frame().width, context.window_rows, source_.memory());
      correlations_.push_back(static_cast<float>(tap_correlation(i)));
    }
  }

  [[nodiscard]] int candidates() const noexcept override { return detail_.has_plain ? 2 : 1; }

  void run(int pass, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    if (pass == 0) {
      read(tile, scratch.tile);
      read_layers(tile, out.layers());
    } else {
      run_level(pass - 1, tile, scratch.layers, out);
    }
  }

 private:
  [[nodiscard]] bool has_row(int y) const noexcept { return y >= 0 && y < source_.frame().height; }

  void read(const Rect& tile, exec::TilePlanes& planes) const {
    const Frame& frame = source_.frame();
    for (int y = tile.y0; y < tile.y1; ++y) {
      float* colour[3];
      for (int c = 0; c < 3; ++c) colour[c] = rings_[0].row(c, y) + tile.x0;
      source_.colour_rows(y, tile.x0, tile.width(), colour);
    }
    planes.reserve(layout_, 2);
    load_tile(tile, frame.width, frame.height, planes, 0, 2, [&](int y, int x, int n, float* const* rows) {
      std::fill_n(rows[0], n, 0.0F);
      for (std::size_t c = 0; c < 3; ++c) {
        source_.variance_row(c, y, x, n, rows[1]);
        for (int i = 0; i < n; ++i) rows[0][i] = std::min(rows[0][i] + rows[1][i], kMostNoise);
      }
    });
    for (int y = 0; y < tile.height(); ++y) smooth_noise(tile, y, planes);
  }

  void read_layers(const Rect& tile, int channels) const {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int k = 0; k < channels; ++k)
        layers_->row(k, y, tile.x0, tile.width(), rings_[0].row(kFirstLayerPlane + k, y) + tile.x0);
    }
  }

  // Sample variances of few samples are too noisy to tell noise from edges.
  void smooth_noise(const Rect& tile, int y, const exec::TilePlanes& planes) const {
    kernels::GuidedSmoothRow row;
    row.centre = guides_.feature_row(tile.x0, tile.y0 + y);
    row.centre_map[0] = planes.row(0, y);
    row.maps = 1;
    row.count = tile.width();
    row.result[0] = rings_[0].row(kNoisePlane, tile.y0 + y) + tile.x0;
    for (std::size_t r = 0; r < kSpline.size(); ++r) {
      const int dy = static_cast<int>(r) - kSmoothingHalo;
      if (!has_row(tile.y0 + y + dy)) continue;
      row.around[row.rows] = guides_.feature_row(tile.x0, tile.y0 + y + dy);
      row.map[row.rows][0] = planes.row(0, y + dy);
      for (std::size_t t = 0; t < kSpline.size(); ++t) {
        row.spatial[row.rows][t] = kSpline[r] * kSpline[t];
      }
      ++row.rows;
    }
    kernels::guided_smooth_row(row);
  }

  void run_level(int level, const Rect& tile, LayerPointers& layers, const CandidateRows& out) const {
    kernels::AtrousRow row;
    row.layers = layers.reserve(out.layers(), kernels::kAtrousTaps + 1, 2, kernels::atrous_layer_scratch(out.layers()));
    row.step = 1 << level;
    row.count = tile.width();
    row.value_factor = value_factor_;
    row.correlation = correlations_[static_cast<std::size_t>(level)];
    row.fixed_weight = detail_.fixed_weight;
    row.margin = detail_.margin;
    row.weight_steps = detail_.weight_steps;
    row.is_first = level == 0;
    row.is_last = level + 1 == levels_;
    for (int y = tile.y0; y < tile.y1; ++y) {
      set_source(level, tile.x0, y, row);
      for (int c = 0; c < 3; ++c) {
        row.result[c] = out.result(0, c, y) + tile.x0;
        row.next_colour[c] = means_row(level, c, y, out, tile.x0);
      }
      if (!row.is_last) row.next_noise = next(level).row(kNoisePlane, y) + tile.x0;
      set_layers(level, tile.x0, y, row.is_last, layers, out);
      kernels::atrous_row(row);
    }
  }

  // Where the level's means go: to the next one, or from the last one to the plain candidate.
  [[nodiscard]] float* means_row(int level, int c, int y, const CandidateRows& out, int x) const {
    if (level + 1 < levels_) return next(level).row(c, y) + x;
    return detail_.has_plain ? out.result(1, c, y) + x : nullptr;
  }

  void set_source(int level, int x, int y, kernels::AtrousRow& row) const {
    const exec::RowRing& ring = rings_[static_cast<std::size_t>(level)];
    row.centre = guides_.feature_row(x, y);
    row.centre.distance_scale = static_cast<float>(std::pow(kFeatureSigmaFall, -2 * level));
    row.centre_noise = ring.row(kNoisePlane, y) + x;
    for (int c = 0; c < 3; ++c) row.centre_colour[c] = ring.row(c, y) + x;
    row.rows = 0;
    for (std::size_t r = 0; r < kSpline.size(); ++r) {
      const int source_y = y + (static_cast<int>(r) - kRadius) * row.step;
      if (!has_row(source_y)) continue;
      row.around[row.rows] = guides_.feature_row(x, source_y);
      row.noise[row.rows] = ring.row(kNoisePlane, source_y) + x;
      for (int c = 0; c < 3; ++c) row.colour[row.rows][c] = ring.row(c, source_y) + x;
      row.spline[row.rows] = kSpline[r];
      ++row.rows;
    }
  }

  void set_layers(int level, int x, int y, bool is_last, LayerPointers& layers, const CandidateRows& out) const {
    const exec::RowRing& ring = rings_[static_cast<std::size_t>(level)];
    const auto count = static_cast<std::size_t>(out.layers());
    for (std::size_t k = 0; k < count; ++k) {
      const int plane = kFirstLayerPlane + static_cast<int>(k);
      std::size_t row = 0;
      for (int r = 0; r < kernels::kAtrousTaps; ++r) {
        const int source_y = y + (r - kRadius) * (1 << level);
        if (has_row(source_y)) layers.set_value(row++ * count + k, ring.row(plane, source_y) + x);
      }
      layers.set_value(kernels::kAtrousTaps * count + k, ring.row(plane, y) + x);
      if (!is_last) layers.set_result(count + k, next(level).row(plane, y) + x);
    }
    layers.set_results(out, is_last ? candidates() : 1, x, y);
  }

  [[nodiscard]] const exec::RowRing& next(int level) const { return rings_[static_cast<std::size_t>(level) + 1]; }

  const Source& source_;
  const GuideRows& guides_;
  const LayerSource* layers_;
  Detail detail_;
  int levels_;
  float value_factor_;
  exec::TileLayout layout_;
  std::vector<exec::RowRing> rings_;  // of each level
  std::vector<float> correlations_;
};

AtrousParams plain(const AtrousSureParams& params) { return {params.levels, params.value_sigma, params.guides}; }

}  // namespace

double tap_correlation(int level) {
  std::vector<double> kernel = {1.0};  // of the level's image: in each direction, of the noise of the frame
  const auto variance = [&] {
    double sum = 0;
    for (const double k : kernel) sum += k * k;
    return sum * sum;  // both directions
  };
  double before = 1;
  for (int i = 0; i <= level; ++i) {
    before = variance();
    const std::size_t step = std::size_t{1} << i;
    std::vector<double> wider(kernel.size() + (kSpline.size() - 1) * step, 0.0);
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      for (std::size_t t = 0; t < kSpline.size(); ++t) wider[k + t * step] += kernel[k] * kSpline[t];
    }
    kernel = std::move(wider);
  }
  double squares = 0;
  for (const double h : kSpline) squares += h * h;
  const double independent = squares * squares;
  return (variance() / before - independent) / (1.0 - independent);
}

std::vector<int> halos(const AtrousParams& params) {
  std::vector<int> all = {kSmoothingHalo};
  for (int i = 0; i < params.levels; ++i) all.push_back(kRadius << i);
  return all;
}

GuideRows make_guides(const AtrousParams& params, const Source& source, const GuideWindow& window) {
  return {source, params.guides, 0.0F, window};
}

std::unique_ptr<PreparedFilter> prepare(const AtrousParams& params, const FilterContext& context) {
  return std::make_unique<Atrous>(params, Detail{}, context);
}

std::vector<int> halos(const AtrousSureParams& params) { return halos(plain(params)); }

GuideRows make_guides(const AtrousSureParams& params, const Source& source, const GuideWindow& window) {
  return make_guides(plain(params), source, window);
}

std::unique_ptr<PreparedFilter> prepare(const AtrousSureParams& params, const FilterContext& context) {
  const Detail detail{params.fixed_weight.value_or(-1.0F), params.noise_margin, params.weight_steps, params.plain};
  return std::make_unique<Atrous>(plain(params), detail, context);
}

}  // namespace stein
