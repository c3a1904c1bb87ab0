// SPDX-License-Identifier: Apache-2.0
//
// From the filtered picture and its divergence to the result: colour, estimated error and density.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/large_array.hpp"
#include "exec/row_pipeline.hpp"
#include "exec/runner.hpp"
#include "filters/guide_rows.hpp"
#include "pipeline/error_calibration.hpp"
#include "pipeline/mixture.hpp"
#include "prefilter/layer_source.hpp"
#include "prefilter/outlier_energy.hpp"
#include "prefilter/source.hpp"
#include "select/guided_pass.hpp"
#include "stein/denoise.hpp"

namespace stein {

/// The halos of the stages.
[[nodiscard]] std::vector<int> error_halos();

class ErrorStages {
 public:
  /// Everything referred to must outlive this. When a stage runs, earlier ones have filled the rows of `filtered` and
  /// of the guides that it reads.
  ErrorStages(const Source& source, const LayerSource& layers, const OutlierEnergy& energy, const DenoiseParams& params,
              const MixtureRows& filtered, const GuideRows& guides, const exec::RowPipelineGeometry& geometry,
              int slots, DenoiseResult& result);

  /// In the order in which they run. The stages refer to this object.
  [[nodiscard]] const std::vector<exec::RowStage>& list() const noexcept { return list_; }

  /// After the stages: the error of each pixel, the density that depends on it, and the means in the report.
  void calibrate(exec::Runner& runner);

 private:
  struct Sums {
    double risk = 0;
    double likely = 0;
    double relative_risk = 0;
    double relative_likely = 0;
  };

  [[nodiscard]] MapRows add_ring(int planes, int rows);
  void add_passes();
  void assess(const Rect& tile, int slot);
  void assess_row(const Rect& tile, int y, float* lines);
  void collect(const Rect& tile, int slot);
  void collect_row(const Rect& tile, int channel, int y, int slot);
  void weigh_row(const Rect& tile, int channel, int y, float* weight, float* scratch);
  [[nodiscard]] std::vector<double> area_pixels(int row) const;
  [[nodiscard]] double report_means();
  [[nodiscard]] std::size_t row_start(int y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_);
  }
  [[nodiscard]] Sums area_sums(std::size_t channel, int column, int row) const;
  [[nodiscard]] float* lines_of(int slot) { return lines_[static_cast<std::size_t>(slot)].data(); }

  const Source& source_;
  const LayerSource& layers_;
  const OutlierEnergy& energy_;
  const DenoiseParams& params_;
  MixtureRows filtered_;
  const GuideRows& guides_;
  exec::RowPipelineGeometry geometry_;
  int blocks_;  // of kSumBlock pixels in a row
  DenoiseResult& result_;
  std::vector<std::unique_ptr<exec::RowRing>> rings_;
  MapRows risks_;                               // per channel; and the likely errors
  MapRows predictors_;                          // of the error, per channel; and the noise where the density wants it
  MapRows smooth_predictors_;                   // the same, smoothed
  std::vector<ErrorCalibration> calibrations_;  // per channel
  std::vector<LargeArray<Sums>> sums_;          // per channel: over blocks of 16 pixels of a row
  std::vector<std::vector<float>> lines_;       // per slot: rows as wide as a tile
  std::vector<exec::RowStage> list_;
};

}  // namespace stein
