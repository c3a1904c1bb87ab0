// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "core/parameter_check.hpp"
#include "rpf/sample_rows.hpp"
#include "stein/error.hpp"
#include "stein/rpf.hpp"

namespace stein {
namespace {

void require(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorCode::kInvalidArgument, "rpf: " + message);
}

void check_boxes(const RpfParams& params) {
  const std::size_t passes = params.boxes.size();
  require(passes >= 1 && passes <= rpf::kMostPasses,
          "the number of boxes is " + std::to_string(passes) + "; it must be in [1..4]");
  require(params.shares.size() == passes, "there are " + std::to_string(passes) + " boxes and " +
                                              std::to_string(params.shares.size()) + " shares; give one for each box");
  for (std::size_t p = 0; p < passes; ++p) {
    const std::string index = "[" + std::to_string(p) + "]";
    require_in_range("rpf: boxes" + index, static_cast<float>(params.boxes[p]), 3.0F, 127.0F, "px");
    require(params.boxes[p] % 2 == 1, "boxes" + index + " is " + std::to_string(params.boxes[p]) +
                                          "; it must be odd, so that the box has a middle");
    require_in_range("rpf: shares" + index, params.shares[p], 1e-6F, 1.0F);
  }
}

}  // namespace

void RpfParams::check() const {
  check_boxes(*this);
  require_in_range("rpf: colour_variance", colour_variance, 1e-6F, 100.0F);
  require_in_range("rpf: feature_variance", feature_variance, 1e-6F, 100.0F);
  require_in_range("rpf: least_feature_share", least_feature_share, 0.0F, 1.0F);
  require_in_range("rpf: cluster_deviations", cluster_deviations, 0.1F, 1e6F);
  require_in_range("rpf: location_deviations", location_deviations, 0.1F, 1e6F);
  require_in_range("rpf: least_deviation", least_deviation, 0.0F, 1e6F);
  require_in_range("rpf: information_floor", information_floor, 0.0F, 1.0F);
  require_in_range("rpf: pass_growth", pass_growth, 0.0F, 1.0F);
  require_in_range("rpf: spike_deviations", spike_deviations, 0.0F, 100.0F);
  require_in_range("rpf: search_radius", static_cast<float>(search_radius), 0.0F, 32.0F, "px");
  require_in_range("rpf: draws", static_cast<float>(draws), 0.0F, 16.0F);
  require_in_range("rpf: step", step, 1e-3F, 1.0F);
  require_in_range("rpf: return_sigma", return_sigma, 0.0F, 16.0F, "px");
}

RpfParams paper_rpf(float variance) {
  RpfParams params;
  params.shares = {0.02F, 0.04F, 0.3F, 0.5F};
  params.colour_variance = variance;
  params.feature_variance = variance;
  params.cluster_deviations = 3;
  params.location_deviations = 3;
  params.least_deviation = 0;
  params.unclustered.clear();
  params.information_floor = 0;
  params.least_feature_share = 0;
  params.pass_growth = 0.1F;
  params.colour_unit = RpfColourUnit::kFiltered;
  params.spikes = RpfSpikes::kReset;
  params.return_sigma = 0;
  return params;
}

}  // namespace stein
