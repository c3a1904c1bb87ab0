// SPDX-License-Identifier: Apache-2.0
#include "rpf/record_layout.hpp"

#include <algorithm>

#include "kernels/sample_weights.hpp"
#include "stein/error.hpp"

namespace stein::rpf {
namespace {

constexpr const char* kPixel = "random.pixel";
constexpr const char* kFirstBounce = "first bounce";

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_names(const SampleSource& source, SampleGroup::Kind kind, const char* what,
                 const std::vector<std::string>& wanted) {
  for (const std::string& name : wanted) {
    std::string known;
    bool found = false;
    for (const SampleGroup& group : source.groups) {
      if (group.kind != kind) continue;
      found = found || group.name == name;
      known += " " + group.name;
    }
    if (!found) {
      throw Error(ErrorCode::kInvalidArgument, "rpf: the samples have no " + std::string(what) + " '" + name +
                                                   "'; they have:" + (known.empty() ? " none" : known));
    }
  }
}

bool is_wanted(const std::vector<std::string>& wanted, const std::string& name) {
  return wanted.empty() || contains(wanted, name);
}

void add_feature(const RpfParams& params, const SampleGroup& group, int channel, RecordLayout& layout) {
  const bool is_location = group.name.rfind("position", 0) == 0 || group.name == "depth";
  for (int k = 0; k < group.channels; ++k) {
    layout.feature_from.push_back(channel + k);
    layout.is_clustered.push_back(!contains(params.unclustered, group.name));
    layout.is_location.push_back(is_location);
  }
  layout.feature_names.push_back(group.name);
}

void add_random(const SampleGroup& group, int channel, RecordLayout& layout) {
  for (int k = 0; k < group.channels; ++k) layout.random_from.push_back(channel + k);
  layout.random_names.push_back(group.name);
}

// The direction to the second hit takes the place of what chose it, if the samples do not tell.
void add_first_bounce(const RpfParams& params, RecordLayout& layout) {
  const bool has_light = std::any_of(layout.random_names.begin(), layout.random_names.end(),
                                     [](const auto& name) { return name != "random.lens" && name != "random.time"; });
  const bool is_possible = layout.position_from[0] >= 0 && layout.position2_from[0] >= 0;
  if (has_light || !is_possible || !params.first_bounce) {
    layout.position_from = layout.position2_from = {-1, -1, -1};
    return;
  }
  layout.random_names.emplace_back(kFirstBounce);
}

// The first hit's place, or the second's.
void note_position(const SampleGroup& group, int channel, RecordLayout& layout) {
  if (group.kind != SampleGroup::Kind::kFeature || group.channels != 3) return;
  if (group.name == "position") layout.position_from = {channel, channel + 1, channel + 2};
  if (group.name == "position2") layout.position2_from = {channel, channel + 1, channel + 2};
}

void add_group(const RpfParams& params, const SampleGroup& group, int channel, RecordLayout& layout) {
  if (group.kind == SampleGroup::Kind::kFeature) {
    if (is_wanted(params.features, group.name)) add_feature(params, group, channel, layout);
  } else if (group.kind == SampleGroup::Kind::kRandom) {
    if (group.name == kPixel && group.channels == 2) {
      layout.pixel_from = {channel, channel + 1};
    } else if (is_wanted(params.randoms, group.name)) {
      add_random(group, channel, layout);
    }
  }
}

}  // namespace

RecordLayout make_layout(const SampleSource& source, const RpfParams& params) {
  check_names(source, SampleGroup::Kind::kFeature, "feature", params.features);
  check_names(source, SampleGroup::Kind::kRandom, "random parameter", params.randoms);
  RecordLayout layout;
  int channel = 3;
  for (const SampleGroup& group : source.groups) {
    if (group.channels < 1) {
      throw Error(ErrorCode::kInvalidFrame, "rpf: the samples' group '" + group.name + "' has no channels");
    }
    note_position(group, channel, layout);
    add_group(params, group, channel, layout);
    channel += group.channels;
  }
  add_first_bounce(params, layout);
  layout.source_channels = channel;
  layout.features = static_cast<int>(layout.feature_from.size());
  layout.randoms = static_cast<int>(layout.random_from.size()) + (layout.has_first_bounce() ? 3 : 0);
  layout.stride = (layout.columns() + kernels::kRecordGroup - 1) / kernels::kRecordGroup * kernels::kRecordGroup;
  return layout;
}

}  // namespace stein::rpf
