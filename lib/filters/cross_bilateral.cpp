// SPDX-License-Identifier: Apache-2.0
//
// Cross-bilateral bank. SBF: Li, Wu, Chuang, "SURE-based Optimization for Adaptive Sampling and Reconstruction", 2012.
//
// Where this differs from the paper: docs/filters/cross_bilateral.md.
//
// symbol        | here                                             | Eq.
// w_ij          | kernels/weights-inl.hpp times ScaleTaps::spatial  | 4
// D(f_i, f_j)   | kernels/weights-inl.hpp, guides from GuideRows    | 6
// F, D          | kernels/cross_bilateral.cpp                       | 5, 7 (= 13); Joint SURE Eq. 2
#include "kernels/cross_bilateral.hpp"

#include <algorithm>
#include <utility>

#include "filters/count_noise.hpp"
#include "filters/filter.hpp"
#include "filters/taps.hpp"

namespace stein {
namespace {

class CrossBilateral final : public PreparedFilter {
 public:
  CrossBilateral(const CrossBilateralParams& params, const FilterContext& context)
      : source_(context.source),
        guides_(context.guides),
        layers_(context.layers),
        divergence_(context.divergence),
        has_counts_(context.counts && context.divergence == Divergence::kJoint),
        has_covariance_(guides_.has_covariance(divergence_)),
        layout_(context.tile_width, context.tile_height, radius_of(params.spatial_sigmas)),
        taps_(params.spatial_sigmas, layout_),
        scales_(static_cast<int>(params.spatial_sigmas.size())),
        counts_(source_, guides_, layout_.max_width) {}

  [[nodiscard]] int candidates() const noexcept override { return scales_; }

  void run(int /*pass*/, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    exec::TilePlanes& planes = scratch.tile;
    const int colour = guides_.planes();
    const int variance = colour + 3;
    const int layer = variance + 3;
    planes.reserve(layout_, layer + out.layers());
    guides_.load(tile, planes);
    load_colour(tile, planes, colour);
    if (out.layers() > 0) load_layers(*layers_, tile, source_.frame(), planes, layer);

    kernels::CrossBilateralRow row;
    row.layers = scratch.layers.reserve(out.layers(), 1, scales_, kernels::cross_bilateral_layer_scratch(out.layers()));
    row.count = tile.width();
    row.taps = taps_.offsets.data();
    row.tap_count = static_cast<int>(taps_.offsets.size());
    row.first_scale = taps_.first_scale.data();
    row.spatial = taps_.spatial.data();
    row.scales = scales_;
    row.has_covariance = has_covariance_;
    float* const lines = scratch.lines.reserve(has_covariance_ ? covariance_floats() + count_floats() : 0);
    for (int y = 0; y < tile.height(); ++y) {
      row.guides = row.centre = guides_.tile_row(planes, y);
      float* own_variance[3];
      for (int c = 0; c < 3; ++c) {
        row.colour[c] = planes.row(colour + c, y);
        row.variance[c] = own_variance[c] = planes.row(variance + c, y);
        for (int s = 0; s < scales_; ++s) {
          row.result[s][c] = out.result(s, c, tile.y0 + y) + tile.x0;
          row.divergence[s][c] = out.divergence(s, c, tile.y0 + y) + tile.x0;
        }
      }
      scratch.layers.set_values(planes, layer, out.layers(), y);
      scratch.layers.set_results(out, scales_, tile.x0, tile.y0 + y);
      const bool has_counts = has_covariance_ && load_covariance(tile, tile.y0 + y, lines, own_variance, row);
      kernels::cross_bilateral_row(row);
      if (has_counts) add_counts(row, lines + covariance_floats());
    }
  }

 private:
  void load_colour(const Rect& tile, exec::TilePlanes& planes, int first_plane) const {
    const Frame& frame = source_.frame();
    load_tile(tile, frame.width, frame.height, planes, first_plane, 3,
              [&](int y, int x, int n, float* const* rows) { source_.colour_rows(y, x, n, rows); });
    for (int y = 0; y < tile.height(); ++y) {
      for (std::size_t c = 0; c < 3; ++c) {
        source_.colour_covariance_row(c, c, tile.y0 + y, tile.x0, tile.width(),
                                      planes.row(first_plane + 3 + static_cast<int>(c), y));
      }
    }
  }

  [[nodiscard]] std::ptrdiff_t covariance_pitch() const noexcept {
    return layout_.max_width + kernels::kMaxLanes;  // rows do not share cache sets
  }
  [[nodiscard]] std::size_t covariance_floats() const noexcept {
    return static_cast<std::size_t>(3 * guides_.channels() * covariance_pitch());
  }

  // Returns whether there are pixels whose noise is a count's.
  bool load_covariance(const Rect& tile, int y, float* lines, float* const* variance,
                       kernels::CrossBilateralRow& row) const {
    const int channels = guides_.channels();
    float* rows[3 * kernels::kMaxGuideChannels];
    for (int k = 0; k < 3 * channels; ++k) {
      rows[k] = lines + k * covariance_pitch();
      row.covariance[k / channels][k % channels] = rows[k];
    }
    guides_.covariance_rows(divergence_, kGuideSlope, y, tile.x0, tile.width(), rows);
    const int tail = (kernels::kMaxLanes - tile.width() % kernels::kMaxLanes) % kernels::kMaxLanes;
    for (int k = 0; k < 3 * channels; ++k) std::fill_n(rows[k] + tile.width(), tail, 0.0F);
    return has_counts_ && split_counts(tile, y, lines + covariance_floats(), rows, variance, row);
  }

  // Scratch of counts, rows of counts_.pitch() floats: covariances of two colour channels, what CountNoise needs, and a
  // bank with an event less.
  static constexpr std::ptrdiff_t kPairs = 3;
  struct LessBank {
    float* one;                              // in place of variances: what is left of the divergence then is
    float* inverse[kernels::kMaxScales][3];  // one over the sum of weights
    float* result[kernels::kMaxScales][3];
  };
  [[nodiscard]] std::size_t count_floats() const noexcept {
    return counts_.floats() + static_cast<std::size_t>((kPairs + 1 + std::ptrdiff_t{6} * scales_) * counts_.pitch());
  }
  [[nodiscard]] float* counts_of(float* scratch) const noexcept { return scratch + kPairs * counts_.pitch(); }
  [[nodiscard]] LessBank less_bank(float* scratch) const {
    float* memory = counts_of(scratch) + counts_.floats();
    const auto next = [&] { return std::exchange(memory, memory + counts_.pitch()); };
    LessBank bank{};
    bank.one = next();
    for (int s = 0; s < scales_; ++s) {
      for (int c = 0; c < 3; ++c) {
        bank.inverse[s][c] = next();
        bank.result[s][c] = next();
      }
    }
    return bank;
  }

  bool split_counts(const Rect& tile, int y, float* scratch, float* const* guide_covariance, float* const* variance,
                    const kernels::CrossBilateralRow& row) const {
    constexpr std::size_t kPairOf[kPairs][2] = {{0, 1}, {0, 2}, {1, 2}};
    float* colour[] = {variance[0], variance[1], variance[2], nullptr, nullptr, nullptr};
    for (int p = 0; p < kPairs; ++p) {
      colour[3 + p] = scratch + p * counts_.pitch();
      source_.colour_covariance_row(kPairOf[p][0], kPairOf[p][1], y, tile.x0, tile.width(), colour[3 + p]);
    }
    return counts_.split({row.guides, row.colour, guide_covariance, colour, tile.x0, y, tile.width()},
                         counts_of(scratch));
  }

  // Adds the counts' part to the divergences of a row whose pixels were split, and filtered.
  void add_counts(const kernels::CrossBilateralRow& row, float* scratch) const {
    const CountNoise::Less less = counts_.less(counts_of(scratch));
    const LessBank bank = less_bank(scratch);
    std::fill_n(bank.one, counts_.pitch(), 1.0F);
    for (int begin = 0; begin < row.count; begin += kernels::kMaxLanes) {
      const int end = std::min(begin + kernels::kMaxLanes, row.count);
      int i = begin;
      while (i < end && !less.has_count(i)) ++i;
      if (i < end) add_counts(row, less, begin, end - begin, bank);
    }
  }

  // The bank as pixels with an event less see their neighbours. Among these is what they are now: it is taken out
  // again, and what they would be put in its place.
  void add_counts(const kernels::CrossBilateralRow& row, const CountNoise::Less& less, int begin, int count,
                  const LessBank& bank) const {
    kernels::CrossBilateralRow other = row;
    other.count = count;
    other.has_covariance = false;
    other.layers = {};
    const auto shift = [&](kernels::Guides& guides) {
      for (int k = 0; k < guides_.channels(); ++k) guides.channel[k] += begin;
      for (int g = 0; g < guides.groups; ++g) guides.variance[g] += begin;
      guides.mask += begin;
    };
    shift(other.guides);
    other.centre = other.guides;
    for (int k = 0; k < guides_.channels(); ++k) other.centre.channel[k] = less.channel[k] + begin;
    for (int g = 0; g < guides_.groups(); ++g) other.centre.variance[g] = less.variance[g] + begin;
    for (int c = 0; c < 3; ++c) {
      other.colour[c] += begin;
      other.variance[c] = bank.one;
      for (int s = 0; s < scales_; ++s) {
        other.result[s][c] = bank.result[s][c];
        other.divergence[s][c] = bank.inverse[s][c];
      }
    }
    kernels::cross_bilateral_row(other);
    for (int i = 0; i < count; ++i) {
      const int x = begin + i;
      if (!less.has_count(x)) continue;
      const double likeness = less.likeness[x];
      for (int c = 0; c < 3; ++c) {
        for (int s = 0; s < scales_; ++s) {
          const double inverse = bank.inverse[s][c][i];
          const double weight = inverse > 0.0 ? 1.0 / inverse : 0.0;
          const double sum = bank.result[s][c][i] * weight - likeness * row.colour[c][x];
          const double F = (sum + less.colour[c][x]) / (weight - likeness + 1.0);
          row.divergence[s][c][x] += static_cast<float>(less.factor[c][x] * (row.result[s][c][x] - F));
        }
      }
    }
  }

  const Source& source_;
  const GuideRows& guides_;
  const LayerSource* layers_;
  Divergence divergence_;
  bool has_counts_;
  bool has_covariance_;
  exec::TileLayout layout_;
  ScaleTaps taps_;
  int scales_;
  CountNoise counts_;
};

}  // namespace

std::vector<int> halos(const CrossBilateralParams& params) { return {radius_of(params.spatial_sigmas)}; }

GuideRows make_guides(const CrossBilateralParams& params, const Source& source, const GuideWindow& window) {
  return {source, params.guides, params.range_sigma, window};
}

std::unique_ptr<PreparedFilter> prepare(const CrossBilateralParams& params, const FilterContext& context) {
  return std::make_unique<CrossBilateral>(params, context);
}

}  // namespace stein
