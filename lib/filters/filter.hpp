// SPDX-License-Identifier: Apache-2.0
//
// The contract of a filter: it returns, for every candidate of its bank, the filtered colour F and the divergence term
// that the risk estimate needs of dF, and it declares its halo. Where layers are wanted, it averages them with the
// weights that it has for the colour. Tiles, threads, memory, selection and tests then work alike.
#pragma once

#include <memory>
#include <vector>

#include "exec/buffers.hpp"
#include "exec/rect.hpp"
#include "filters/guide_rows.hpp"
#include "filters/layer_pointers.hpp"
#include "prefilter/layer_source.hpp"
#include "prefilter/source.hpp"
#include "stein/filters.hpp"

namespace stein {

/// Where candidates go: planes of a row window, in the order F.R, F.G, F.B, D.R, D.G, D.B for each candidate; and in
/// another one, if layers are wanted, the channels of all layers for each candidate.
class CandidateRows {
 public:
  static constexpr int kPlanes = 6;
  explicit CandidateRows(const exec::RowRing& rows, int first_plane = 0) : rows_(rows), first_(first_plane) {}

  /// The same with `channels` channels of layers.
  [[nodiscard]] CandidateRows with_layers(const exec::RowRing& rows, int channels) const {
    CandidateRows both = *this;
    both.layer_rows_ = &rows;
    both.layers_ = channels;
    return both;
  }
  /// Channels of layers that are wanted.
  [[nodiscard]] int layers() const noexcept { return layers_; }
  /// A filtered channel of the layers.
  [[nodiscard]] float* layer(int candidate, int channel, int y) const noexcept {
    return layer_rows_->row((first_ / kPlanes + candidate) * layers_ + channel, y);
  }

  /// The filtered colour.
  [[nodiscard]] float* result(int candidate, int channel, int y) const noexcept {
    return rows_.row(plane(candidate, channel), y);
  }
  /// D_c = sum over inputs j of dF_c/dx_j Cov(x_j, x_c): what 2 D_c adds to the risk (SBF Eq. 2; Joint SURE Eq. 2).
  /// Covariances are of the mean. With independent channels and features free of noise: variance of the mean times
  /// dF_c/dx_c.
  [[nodiscard]] float* divergence(int candidate, int channel, int y) const noexcept {
    return rows_.row(plane(candidate, channel) + 3, y);
  }
  /// F, D and layers by one index, in the order above.
  [[nodiscard]] float* row(int candidate, int index, int y) const noexcept {
    return index < kPlanes ? rows_.row(plane(candidate, index), y) : layer(candidate, index - kPlanes, y);
  }

 private:
  [[nodiscard]] int plane(int candidate, int channel) const noexcept { return first_ + candidate * kPlanes + channel; }
  const exec::RowRing& rows_;
  int first_;
  const exec::RowRing* layer_rows_ = nullptr;
  int layers_ = 0;
};

/// Scratch memory of one thread.
struct FilterScratch : exec::TileScratch {
  LayerPointers layers;
};

/// A filter bound to its parameters and to one frame. Const and stateless while it runs: tiles run in any order and
/// thread, pass by pass.
class PreparedFilter {
 public:
  PreparedFilter() = default;
  PreparedFilter(const PreparedFilter&) = delete;
  PreparedFilter& operator=(const PreparedFilter&) = delete;
  virtual ~PreparedFilter() = default;

  [[nodiscard]] virtual int candidates() const noexcept = 0;  ///< without the unfiltered input
  /// A fairly wide one, whose F says how bright a pixel is; sigma_s = 4 in both banks of SBF.
  [[nodiscard]] virtual int common_candidate() const noexcept { return 2 * candidates() / 3; }
  /// To what a pixel's relative risks are clipped before they are smoothed: it bounds a single pixel's vote. For the
  /// choice only; the error that is reported is not clipped. Measured: docs/selection.md.
  [[nodiscard]] virtual float risk_limit() const noexcept { return 1.0F; }
  /// Runs one pass over the tile; the last one fills F, and D where the filter knows its derivative. What earlier
  /// passes left is there for the tile and the pass's halo around it. Writes up to the next multiple of 16 pixels in x.
  virtual void run(int pass, const Rect& tile, FilterScratch& scratch, const CandidateRows& out) const = 0;
};

/// What a filter is bound to. Tiles do not exceed tile_width x tile_height; when one runs, the guides of its rows and
/// of those within the halo are prepared.
struct FilterContext {
  const Source& source;
  const GuideRows& guides;
  int tile_width = 0;
  int tile_height = 0;
  int window_rows = 0;  ///< rows to keep of what a pass leaves for the next one
  Divergence divergence = Divergence::kPlain;
  const LayerSource* layers = nullptr;  ///< null: none will be wanted
  bool counts = false;                  ///< with kJoint: CountNoise, where the filter knows it
};

/// One overload per filter, each in its own pair of files: the halo of each pass, the guides that the filter wants
/// prepared in `window` (they guide the smoothing of its risk too), and the filter.
[[nodiscard]] std::vector<int> halos(const CrossBilateralParams& params);
[[nodiscard]] GuideRows make_guides(const CrossBilateralParams& params, const Source& source,
                                    const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const CrossBilateralParams& params, const FilterContext& context);

[[nodiscard]] std::vector<int> halos(const GaussianParams& params);
[[nodiscard]] GuideRows make_guides(const GaussianParams& params, const Source& source, const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const GaussianParams& params, const FilterContext& context);

[[nodiscard]] std::vector<int> halos(const AtrousParams& params);
[[nodiscard]] GuideRows make_guides(const AtrousParams& params, const Source& source, const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const AtrousParams& params, const FilterContext& context);

[[nodiscard]] std::vector<int> halos(const AtrousSureParams& params);
[[nodiscard]] GuideRows make_guides(const AtrousSureParams& params, const Source& source, const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const AtrousSureParams& params, const FilterContext& context);
[[nodiscard]] std::vector<int> halos(const CrossNlmParams& params);
[[nodiscard]] GuideRows make_guides(const CrossNlmParams& params, const Source& source, const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const CrossNlmParams& params, const FilterContext& context);

[[nodiscard]] std::vector<int> halos(const AdaptiveOrderParams& params);
[[nodiscard]] GuideRows make_guides(const AdaptiveOrderParams& params, const Source& source, const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const AdaptiveOrderParams& params, const FilterContext& context);

/// The overloads for the alternative that `spec` holds.
[[nodiscard]] std::vector<int> halos(const FilterSpec& spec);
[[nodiscard]] GuideRows make_guides(const FilterSpec& spec, const Source& source, const GuideWindow& window);
[[nodiscard]] std::unique_ptr<PreparedFilter> prepare(const FilterSpec& spec, const FilterContext& context);

/// Pixels that can change a pixel's result: the halos of all passes and of the guides together.
[[nodiscard]] int reach(const FilterSpec& spec);

}  // namespace stein
