// SPDX-License-Identifier: Apache-2.0
//
// One filter on the frame, from its preparation to the picture that its candidates are mixed to.
#pragma once

#include <optional>
#include <vector>

#include "exec/row_pipeline.hpp"
#include "pipeline/choice_stages.hpp"
#include "pipeline/filter_runs.hpp"
#include "pipeline/mixture.hpp"
#include "pipeline/survey.hpp"
#include "stein/denoise.hpp"

namespace stein {

class FilterJob {
 public:
  /// Everything referred to must outlive this. `guided`: halos of the stages that follow the job's own and read its
  /// guides.
  FilterJob(const Source& source, const LayerSource& layers, const FilterPlan& plan, Selection selection,
            const exec::RowPipelineGeometry& geometry, const std::vector<int>& guided, int slots);

  /// Whether the image is surveyed before: filters of many passes need nearly all rows of each for a few of the last,
  /// and do without.
  [[nodiscard]] bool wants_survey() const noexcept;
  void survey(exec::Runner& runner, double progress_weight);

  /// The stages that fill `out`. Call once, after the survey. The stages refer to this object.
  [[nodiscard]] const std::vector<exec::RowStage>& plan_stages(const Mixture& out);

  [[nodiscard]] const GuideRows& guides() const noexcept { return runs_.guides(); }
  /// What the candidates say of the variances, once the stages have run.
  [[nodiscard]] Survey findings() const;

 private:
  const Source& source_;
  Selection selection_;
  exec::RowPipelineGeometry geometry_;
  int slots_;
  FilterRuns runs_;
  Surveyor surveyor_;
  std::optional<Survey> prior_;
  std::optional<ChoiceStages> stages_;
};

}  // namespace stein
