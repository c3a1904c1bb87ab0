// SPDX-License-Identifier: Apache-2.0
//
// One of the files that become one frame, as an accumulator takes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stein/accumulate.hpp"
#include "stein/exr.hpp"

namespace stein::cli {

/// Of the colour and of every feature.
[[nodiscard]] bool has_all_variances(const Frame& frame);

/// The frame's features. Where variances are pooled, covariances are kept if the frame has all of them.
[[nodiscard]] SampleLayout sample_layout(const Frame& frame, bool pooled);

/// Size, data window and features, and, where variances are pooled, the planes that describe noise.
/// @throws Error kInvalidFrame naming both files and what differs.
void require_same_view(const exr::LoadedFrame& first, const exr::LoadedFrame& other, bool pooled);

class MergeInput {
 public:
  /// Views `frame`, which must outlive this.
  MergeInput(const Frame& frame, const SampleLayout& layout, bool pooled);

  /// Adds the pixels of a row, with their variances if pooled. Pixels without samples are passed over.
  void add_row(int y, Accumulator& film);

  /// Differs, almost certainly, where the colours added so far differ.
  [[nodiscard]] std::uint64_t digest() const noexcept { return digest_; }

 private:
  void load_row(int y);

  const Frame& frame_;
  bool pooled_;
  std::size_t channels_;
  std::vector<ConstPlaneView> planes_;  // means, then variances and covariances if pooled, as in a record
  std::vector<float> pixels_;           // of one row, pixel by pixel
  std::vector<float> plane_row_;
  std::vector<float> counts_;
  std::uint64_t digest_ = 0xcbf29ce484222325U;  // FNV-1a
};

}  // namespace stein::cli
