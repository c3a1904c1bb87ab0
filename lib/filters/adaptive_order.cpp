// SPDX-License-Identifier: Apache-2.0
//
// Local polynomial regression on features. AOS: Yuan, Zheng, Zheng, Liu, "Adaptive Rendering based on Adaptive Order
// Selection", 2017.
//
// Where this differs from the paper: docs/filters/adaptive_order.md.
//
// symbol              | here                              | Eq.
// x_i                 | filters/smooth_features.cpp       | sec. 6
// truncated SVD       | kernels/window_moments-inl.hpp,   | sec. 6
//                     | kernels/feature_basis-inl.hpp     |
// X, W, beta, l_i     | kernels/local_polynomial.cpp      | 4, 7-9
// bias, variance, MSE | kernels/local_polynomial.cpp      | 11-13, 16
// order               | the choice of the pipeline        | algorithm 1
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "filters/blurred_rows.hpp"
#include "filters/filter.hpp"
#include "filters/nlm_block.hpp"
#include "filters/nlm_taps.hpp"
#include "filters/smooth_features.hpp"
#include "kernels/local_polynomial.hpp"
#include "stein/error.hpp"

namespace stein {
namespace {

constexpr float kLargestSquare = 1e37F;   // of a residual; what is added to it stays finite
constexpr float kCurvatureRidge = 30.0F;  // px; why: docs/filters/adaptive_order.md, choices by measurement
constexpr double kLog2E = std::numbers::log2e;

NlmWindow window_of(const AdaptiveOrderParams& params) { return {params.window_radius, params.patch_radius}; }

int tile_halo(const AdaptiveOrderParams& params) { return params.window_radius + std::max(params.patch_radius, 1); }

// A mean has no slopes; the Taylor error of one is seen by a fit of order 2.
FeatureGuides regressors(const AdaptiveOrderParams& params) {
  const bool has_slopes = params.orders.back() > 0 || params.error == OrderError::kTaylor;
  return has_slopes ? params.guides : FeatureGuides{{}, 0.0F, params.guides.min_feature_variance};
}

class AdaptiveOrder final : public PreparedFilter {
 public:
  AdaptiveOrder(const AdaptiveOrderParams& params, const FilterContext& context)
      : source_(context.source),
        layers_(context.layers),
        divergence_(context.divergence),
        layout_(context.tile_width, context.tile_height, tile_halo(params)),
        features_(context.source, regressors(params), context.tile_width, context.tile_height, context.window_rows),
        taps_(nlm_taps(window_of(params), layout_)) {
    set_taps(params);
    set_weights(params);
    rows_.features = features_.channels();
    if (rows_.features > kernels::kMaxRegressionFeatures) {
      throw Error(ErrorCode::kInvalidArgument, "the frame has " + std::to_string(rows_.features) +
                                                   " feature channels to regress on; at most " +
                                                   std::to_string(kernels::kMaxRegressionFeatures) +
                                                   " can be: give those that matter less the sigma 0");
    }
    rows_.has_feature_covariance = divergence_ == Divergence::kJoint && features_.has_covariance();
    rows_.noise_threshold = params.noise_threshold;
    rows_.ridge = params.ridge;
    rows_.is_taylor = params.error == OrderError::kTaylor;
    rows_.curvature_ridge = params.curvature_ridge.value_or(rows_.is_taylor ? params.ridge : kCurvatureRidge);
    for (const int order : params.orders) rows_.order[rows_.orders++] = order;
  }

  [[nodiscard]] int candidates() const noexcept override { return rows_.weights.candidates * rows_.orders; }

  // The widest weights take lamps for the walls beside them.
  [[nodiscard]] int common_candidate() const noexcept override { return candidates() / 2; }

  void run(int pass, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const override {
    if (pass == 0) {
      features_.prepare(tile, scratch);
    } else {
      fit(tile, scratch, out);
    }
  }

 private:
  // Planes of a tile.
  static constexpr int kMask = 0;
  static constexpr int kColour = 1;
  static constexpr int kBlurred = kColour + 3;
  static constexpr int kVariance = kBlurred + kBlurredPlanes;
  static constexpr int kFeatures = kVariance + 3;  // means and variances in turn
  static constexpr std::size_t kLines = 2;         // of scratch, of a tile's pitch

  void set_taps(const AdaptiveOrderParams& params) {
    // One pixel's step such that the window has variance 1.
    const double radius = params.window_radius;
    const double unit = 1.0 / std::sqrt(radius * (radius + 1.0) / 3.0);
    const double sigma = params.spatial_sigma;
    const double exponent = sigma > 0 ? kLog2E / (2.0 * sigma * sigma) : 0.0;
    for_each_nlm_tap(window_of(params), [&](int dx, int dy) {
      position_[0].push_back(static_cast<float>(dx * unit));
      position_[1].push_back(static_cast<float>(dy * unit));
      spatial_.push_back(static_cast<float>((dx * dx + dy * dy) * exponent));
    });
    for (std::vector<float>* list : {&position_[0], &position_[1], &spatial_}) list->resize(taps_.size());
    rows_.position[0] = position_[0].data();
    rows_.position[1] = position_[1].data();
    rows_.spatial = spatial_.data();
  }

  void set_weights(const AdaptiveOrderParams& params) {
    kernels::CrossNlmRows& weights = rows_.weights;
    set_window(window_of(params), taps_, layout_, weights);
    weights.blur = params.patch_blur;
    weights.is_normalised = true;
    rows_.has_colour_weights = !params.range_sigmas.empty();
    weights.candidates = 1;
    weights.exponent[0] = 1.0F;
    weights.slope[0] = 0.0F;
    if (rows_.has_colour_weights) set_range_sigmas(params.range_sigmas, 1.0, weights);
  }

  void fit(const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const {
    exec::TilePlanes& planes = scratch.tile;
    const int layer = kFeatures + 2 * rows_.features;
    planes.reserve(layout_, layer + out.layers());
    load(tile, planes);
    if (out.layers() > 0) load_layers(*layers_, tile, source_.frame(), planes, layer);
    kernels::LocalPolynomialRows rows = rows_;
    const int channels = out.layers() > 0 ? out.layers() + kernels::kLayerColours : 0;
    rows.layers = scratch.layers.reserve(channels, 1, kernels::kNlmBlockRows * candidates(),
                                         kernels::nlm_layer_scratch(candidates(), channels));
    rows.layer_colour = layers_ != nullptr ? layers_->colours() : nullptr;
    rows.weights.count = tile.width();
    const int columns = kernels::most_columns(rows.order[rows.orders - 1], rows.is_taylor);
    const OwnCovariances own(source_, divergence_, layout_, rows.has_feature_covariance ? rows.features : 0);
    const auto pitch = static_cast<std::size_t>(layout_.pitch);
    float* own_memory = scratch.lines.reserve(
        own.floats() + kLines * pitch +
        kernels::local_polynomial_scratch(rows.weights.candidates, columns, rows.orders, rows.features));
    float* lines = own_memory + own.floats();
    rows.scratch = lines + kLines * pitch;
    for (int y = 0; y < tile.height(); y += kernels::kNlmBlockRows) {
      rows.weights.rows = std::min(kernels::kNlmBlockRows, tile.height() - y);
      const Rect target{tile.x0, tile.y0 + y, tile.x1, tile.y0 + y + rows.weights.rows};
      set_inputs(planes, y, rows);
      own.load(
          target, own_memory, rows.weights.colour_covariance, rows.feature_covariance,
          [&](int image_y, float* const* to) { features_.covariance_rows(image_y, target.x0, target.width(), to); });
      set_outputs(target, out, candidates(), rows.weights);
      set_layers(target, out, candidates(), planes, layer, y, scratch.layers);
      for (int k = out.layers(); k < channels; ++k)
        scratch.layers.set_value(static_cast<std::size_t>(k), rows.weights.colour[k - out.layers()]);
      kernels::local_polynomial_rows(rows);
      if (rows.is_taylor) give_error(target, lines, out);
    }
  }

  void load(const Rect& tile, exec::TilePlanes& planes) const {
    const Frame& frame = source_.frame();
    const int all = kFeatures + 2 * rows_.features;
    load_tile(tile, frame.width, frame.height, planes, 0, all, [&](int y, int x, int n, float* const* rows) {
      source_.mask_row(y, x, n, rows[kMask]);
      source_.colour_rows(y, x, n, rows + kColour);
      for (std::size_t c = 0; c < 3 && rows_.is_taylor; ++c) source_.variance_row(c, y, x, n, rows[kVariance + c]);
      blurred_row(source_, rows_.weights.blur, y, x, n, rows + kBlurred);
      for (int k = 0; k < rows_.features; ++k) {
        std::copy_n(features_.mean(k, y) + x, n, rows[kFeatures + 2 * k]);
        std::copy_n(features_.variance(k, y) + x, n, rows[kFeatures + 2 * k + 1]);
      }
    });
  }

  void set_inputs(const exec::TilePlanes& planes, int y, kernels::LocalPolynomialRows& rows) const {
    rows.weights.guides.mask = planes.row(kMask, y);
    for (int c = 0; c < 3; ++c) {
      rows.weights.colour[c] = planes.row(kColour + c, y);
      rows.weights.blurred[c] = planes.row(kBlurred + c, y);
      rows.variance[c] = planes.row(kVariance + c, y);
    }
    rows.weights.gain = planes.row(kBlurred + 3, y);
    rows.weights.noise = planes.row(kBlurred + 4, y);
    for (int k = 0; k < rows_.features; ++k) {
      rows.feature[k] = planes.row(kFeatures + 2 * k, y);
      rows.feature_noise[k] = planes.row(kFeatures + 2 * k + 1, y);
    }
  }

  // Turns an error into the D whose risk (F - y)^2 - V + 2 D it is.
  void give_error(const Rect& target, float* lines, const CandidateRows& out) const {
    const int n = target.width();
    float* mean = lines;
    float* variance = lines + layout_.pitch;
    for (int y = target.y0; y < target.y1; ++y) {
      for (int c = 0; c < 3; ++c) {
        source_.input_row(static_cast<std::size_t>(c), y, target.x0, n, mean, variance);
        for (int s = 0; s < candidates(); ++s) {
          const float* F = out.result(s, c, y) + target.x0;
          float* D = out.divergence(s, c, y) + target.x0;
          for (int i = 0; i < n; ++i) {
            const float square = (F[i] - mean[i]) * (F[i] - mean[i]);
            D[i] = 0.5F * (D[i] - std::min(square, kLargestSquare) + variance[i]);
          }
        }
      }
    }
  }

  const Source& source_;
  const LayerSource* layers_;
  Divergence divergence_;
  exec::TileLayout layout_;
  SmoothFeatures features_;
  std::vector<std::ptrdiff_t> taps_;
  std::vector<float> position_[2];
  std::vector<float> spatial_;
  kernels::LocalPolynomialRows rows_;  // what all tiles share
};

}  // namespace

std::vector<int> halos(const AdaptiveOrderParams& params) {
  return {SmoothFeatures::kHalo, tile_halo(params) + kBlurRadius};
}

GuideRows make_guides(const AdaptiveOrderParams& params, const Source& source, const GuideWindow& window) {
  return {source, params.guides, 0.0F, window};
}

std::unique_ptr<PreparedFilter> prepare(const AdaptiveOrderParams& params, const FilterContext& context) {
  return std::make_unique<AdaptiveOrder>(params, context);
}

}  // namespace stein
