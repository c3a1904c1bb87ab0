// SPDX-License-Identifier: Apache-2.0
#include "accumulated_rows.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "cancel.hpp"
#include "stein/error.hpp"

namespace stein::cli {
namespace {

using Kind = exr::SampleLayer::Kind;

constexpr int kMostRows = 16;  // that OpenEXR compresses together
constexpr std::int64_t kBandBytes = std::int64_t{64} << 20;

/// So many rows that their moments stay within kBandBytes, but at least one.
int rows_of_band(int width, const SampleLayout& layout) {
  constexpr int kFieldsBeside = 4;
  const std::int64_t values = kFieldsBeside + 2 * layout.channels() + layout.pairs();
  const std::int64_t row_bytes = width * values * std::int64_t{sizeof(double)};
  return static_cast<int>(std::clamp<std::int64_t>(kBandBytes / row_bytes, 1, kMostRows));
}

void check_names(const exr::SampleReader& samples, const std::vector<std::string>& leave_out) {
  for (const std::string& name : leave_out) {
    std::string names;
    bool found = false;
    for (const exr::SampleLayer& layer : samples.layers()) {
      if (layer.kind != Kind::kFeature) {
        continue;
      }
      found = found || layer.name == name;
      names += " " + layer.name;
    }
    if (!found) {
      throw Error(ErrorCode::kInvalidArgument, "--leave-out: " + samples.path() + " has no feature '" + name +
                                                   "'; it has:" + (names.empty() ? " none" : names));
    }
  }
}

/// Components keep the names that they have in the file.
void add_names(const exr::SampleLayer& layer, std::map<std::string, std::string>& names) {
  const Feature feature{layer.name, std::vector<ConstPlaneView>(layer.channels.size()), {}, {}};
  for (std::size_t k = 0; k < layer.channels.size(); ++k) {
    const std::string& channel = layer.channels[k];
    const std::string conventional = plane_name(feature, k, false);
    names[conventional] = channel;
    names[plane_name(feature, k, true)] = layer.name + ".variance" + channel.substr(layer.name.size());
    for (const std::string colour : {"R", "G", "B"}) {
      names["covariance." + colour + "." + conventional] = "covariance." + colour + "." + channel;
    }
  }
}

}  // namespace

SamplePlan plan_samples(const exr::SampleReader& samples, const std::vector<std::string>& leave_out, bool covariances) {
  check_names(samples, leave_out);
  SamplePlan plan;
  plan.layout.covariances = covariances;
  for (const exr::SampleLayer& layer : samples.layers()) {
    const bool named = std::find(leave_out.begin(), leave_out.end(), layer.name) != leave_out.end();
    if (layer.kind == Kind::kFeature && !named) {
      plan.layout.features.push_back({layer.name, static_cast<int>(layer.channels.size())});
      add_names(layer, plan.names);
    } else if (layer.kind != Kind::kColour) {
      plan.left_out.push_back(layer.name);
      continue;
    }
    plan.channels.insert(plan.channels.end(), layer.channels.begin(), layer.channels.end());
  }
  return plan;
}

AccumulatedRows::AccumulatedRows(exr::SampleReader& samples, const SamplePlan& plan)
    : samples_(samples), plan_(plan), band_rows_(rows_of_band(samples.width(), plan.layout)) {
  samples_.select(plan.channels);
  counts_.fewest = std::numeric_limits<std::uint32_t>::max();
}

bool AccumulatedRows::next() {
  const int rows = std::min(band_rows_, samples_.height() - rows_done_);
  if (rows == 0) {
    return false;
  }
  Accumulator band(samples_.width(), rows, plan_.layout);
  for (int row = 0; row < rows; ++row) {
    check_not_interrupted();
    add_row(band, row);
  }
  counts_.rejected += band.rejected();
  counts_.repaired += band.repaired();
  moments_ = band.moments();
  count_pixels();
  rows_done_ += rows;
  return true;
}

void AccumulatedRows::add_row(Accumulator& band, int row) {
  static_cast<void>(samples_.read_row(row_counts_, row_samples_));
  const float* sample = row_samples_.data();
  for (int x = 0; x < band.width(); ++x) {
    const std::uint32_t count = row_counts_[static_cast<std::size_t>(x)];
    for (std::uint32_t i = 0; i < count; ++i) {
      counts_.total += band.add(x, row, sample) ? 1 : 0;
      sample += plan_.channels.size();
    }
    counts_.fewest = std::min(counts_.fewest, count);
    counts_.most = std::max(counts_.most, count);
  }
}

std::vector<NamedView> AccumulatedRows::planes() const {
  std::vector<NamedView> planes = named_planes(moments_->frame());
  for (auto& [name, view] : planes) {
    const auto found = plan_.names.find(name);
    if (found != plan_.names.end()) {
      name = found->second;
    }
  }
  return planes;
}

void AccumulatedRows::count_pixels() {
  const ConstPlaneView& counts = moments_->frame().sample_count;
  for (int y = 0; y < counts.height(); ++y) {
    for (int x = 0; x < counts.width(); ++x) {
      counts_.empty_pixels += counts.at(x, y) == 0 ? 1 : 0;
      counts_.single_pixels += counts.at(x, y) == 1 ? 1 : 0;
    }
  }
}

}  // namespace stein::cli
