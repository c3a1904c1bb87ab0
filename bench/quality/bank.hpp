// SPDX-License-Identifier: Apache-2.0
//
// A scene with its reference, and every entry of a filter's bank on it as a fixed filter.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/filter_runs.hpp"
#include "select/guided_pass.hpp"
#include "stein/denoise.hpp"
#include "stein/exr.hpp"

namespace stein::quality {

/// Means over pixels and channels, plain and with the weight 1 / (x^2 + 0.01) of relative MSE; the reference's own
/// noise is taken off the true ones.
struct EntryErrors {
  double estimated = 0;
  double truth = 0;
  double estimated_relative = 0;
  double true_relative = 0;
  double trimmed_ratio = 0;  ///< relative, estimated over true, without the 0.01 % of the pixels that differ most
};

/// What choosing among the entries gives, as relative MSE (the reference's noise included).
struct Choices {
  double best_single = 0;  ///< of the entries for the whole image
  double argmin = 0;       ///< Selection::kArgmin: least smoothed risk, pixel by pixel
  double evidence = 0;     ///< Selection::kEvidence, the default
  double oracle = 0;       ///< least smoothed true error, pixel by pixel
};

class Bank {
 public:
  /// `file`: a noisy render; ref.exr and, if there is one, refnoise lie next to it. Of the filters the first; where it
  /// has a closed form Risk::kAuto is joint SURE, with the covariances that there are.
  Bank(const std::string& file, const DenoiseParams& params);

  [[nodiscard]] int entries() const { return runs_->entries(); }
  [[nodiscard]] EntryErrors errors(int entry) const;
  [[nodiscard]] Choices choices() const;

 private:
  struct Pixel {
    double F, D, mean, variance, truth;
  };
  [[nodiscard]] Pixel pixel(int entry, int channel, int x, int y) const;
  [[nodiscard]] double relative_error(const std::vector<int>& entry_of_pixel) const;
  [[nodiscard]] double relative_error(Selection selection) const;
  [[nodiscard]] std::vector<int> least_true_error() const;

  exr::LoadedFrame loaded_;
  exr::NamedPlanes reference_;
  std::array<double, 2> reference_noise_{};  // plain, relative
  DenoiseParams params_;
  std::unique_ptr<Source> source_;
  std::unique_ptr<LayerSource> layers_;
  exec::RowPipelineGeometry geometry_;
  std::unique_ptr<FilterRuns> runs_;
};

}  // namespace stein::quality
