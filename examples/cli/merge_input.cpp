// SPDX-License-Identifier: Apache-2.0
#include "merge_input.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "frame_text.hpp"

namespace stein::cli {
namespace {

bool has_all_covariances(const Frame& frame) {
  return frame.colour_covariance[0] && std::all_of(frame.features.begin(), frame.features.end(),
                                                   [](const Feature& f) { return !f.colour_covariance.empty(); });
}

std::string feature_list(const Frame& frame) {
  std::string list;
  for (const Feature& feature : frame.features) {
    list += (list.empty() ? "" : ", ") + feature.name + " (" + std::to_string(feature.mean.size()) + ")";
  }
  return list.empty() ? "none" : list;
}

std::string noise_list(const Frame& frame) {
  if (!has_all_variances(frame)) return "not all variances";
  return has_all_covariances(frame) ? "variances and covariances" : "variances, but not all covariances";
}

std::string window_text(const exr::LoadedFrame& file) {
  const auto window = file.data_window();
  return std::to_string(window[0]) + "," + std::to_string(window[1]) + " to " + std::to_string(window[2]) + "," +
         std::to_string(window[3]);
}

void require_same(const exr::LoadedFrame& first, const exr::LoadedFrame& other, const std::string& what,
                  const std::string& of_first, const std::string& of_other, const std::string& advice) {
  if (of_first == of_other) return;
  throw Error(ErrorCode::kInvalidFrame, "'" + first.path() + "' and '" + other.path() + "' cannot be merged: their " +
                                            what + " differ: " + of_first + " and " + of_other + "; " + advice);
}

}  // namespace

bool has_all_variances(const Frame& frame) {
  return frame.colour_variance[0] && std::all_of(frame.features.begin(), frame.features.end(),
                                                 [](const Feature& f) { return !f.variance.empty(); });
}

SampleLayout sample_layout(const Frame& frame, bool pooled) {
  SampleLayout layout{.features = {}, .covariances = !pooled || has_all_covariances(frame)};
  for (const Feature& f : frame.features) layout.features.push_back({f.name, static_cast<int>(f.mean.size())});
  return layout;
}

void require_same_view(const exr::LoadedFrame& first, const exr::LoadedFrame& other, bool pooled) {
  require_same(first, other, "sizes", size_text(first), size_text(other), "merge renders of one view");
  require_same(first, other, "data windows", window_text(first), window_text(other), "merge renders of one view");
  require_same(first, other, "features (channels)", feature_list(first.frame()), feature_list(other.frame()),
               "render all with the same ones");
  if (!pooled) return;
  require_same(first, other, "variances", noise_list(first.frame()), noise_list(other.frame()),
               "--spread takes them from how the files differ");
}

MergeInput::MergeInput(const Frame& frame, const SampleLayout& layout, bool pooled)
    : frame_(frame), pooled_(pooled), channels_(static_cast<std::size_t>(layout.channels())) {
  const auto append = [&](const auto& views) { planes_.insert(planes_.end(), views.begin(), views.end()); };
  append(frame.colour);
  for (const Feature& feature : frame.features) append(feature.mean);
  if (pooled) {
    append(frame.colour_variance);
    for (const Feature& feature : frame.features) append(feature.variance);
  }
  if (pooled && layout.covariances) {
    append(frame.colour_covariance);
    for (std::ptrdiff_t c = 0; c < 3; ++c) {
      for (const Feature& feature : frame.features) {
        const auto begin = feature.colour_covariance.begin();
        const auto count = static_cast<std::ptrdiff_t>(feature.mean.size());
        planes_.insert(planes_.end(), begin + c * count, begin + (c + 1) * count);
      }
    }
  }
  const auto width = static_cast<std::size_t>(frame.width);
  pixels_.resize(planes_.size() * width);
  plane_row_.resize(width);
  counts_.assign(width, frame.uniform_sample_count);
}

void MergeInput::load_row(int y) {
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    planes_[p].read_row(y, 0, frame_.width, plane_row_.data());
    for (std::size_t x = 0; x < plane_row_.size(); ++x) {
      pixels_[x * planes_.size() + p] = plane_row_[x];
      if (p < 3) digest_ = (digest_ ^ std::bit_cast<std::uint32_t>(plane_row_[x])) * 0x100000001b3U;
    }
  }
  if (frame_.sample_count) frame_.sample_count.read_row(y, 0, frame_.width, counts_.data());
}

void MergeInput::add_row(int y, Accumulator& film) {
  load_row(y);
  for (int x = 0; x < frame_.width; ++x) {
    const auto at = static_cast<std::size_t>(x);
    if (counts_[at] == 0) continue;
    const float* mean = pixels_.data() + at * planes_.size();
    // Few samples of a file cannot leave more degrees of freedom than samples.
    const float degrees = std::clamp(frame_.degrees_of_freedom, 0.0F, std::max(counts_[at] - 1, 0.0F));
    film.add(x, y,
             Estimate{.samples = counts_[at],
                      .mean = mean,
                      .moments = pooled_ ? mean + channels_ : nullptr,
                      .degrees_of_freedom = degrees});
  }
}

}  // namespace stein::cli
