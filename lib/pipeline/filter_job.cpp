// SPDX-License-Identifier: Apache-2.0
#include "pipeline/filter_job.hpp"

namespace stein {

FilterJob::FilterJob(const Source& source, const LayerSource& layers, const FilterPlan& plan, Selection selection,
                     const exec::RowPipelineGeometry& geometry, const std::vector<int>& guided, int slots)
    : source_(source),
      selection_(selection),
      geometry_(geometry),
      slots_(slots),
      runs_(source, layers, plan, geometry, choice_halos(selection), guided, slots),
      surveyor_(source, runs_, geometry, slots) {}

bool FilterJob::wants_survey() const noexcept {
  constexpr int kMostPasses = 2;
  return selection_ == Selection::kEvidence && runs_.passes() <= kMostPasses;
}

void FilterJob::survey(exec::Runner& runner, double progress_weight) {
  prior_ = stein::survey(surveyor_, runs_, geometry_, runner, progress_weight);
}

const std::vector<exec::RowStage>& FilterJob::plan_stages(const Mixture& out) {
  stages_.emplace(source_, selection_, runs_, prior_ ? &*prior_ : nullptr, surveyor_, geometry_, slots_, out);
  return stages_->list();
}

Survey FilterJob::findings() const { return prior_ ? *prior_ : surveyor_.result(); }

}  // namespace stein
