// SPDX-License-Identifier: Apache-2.0
//
// What the kernels know of a tile: rows of floats. No images, files or threads.
#pragma once

#include <cstddef>

namespace stein::kernels {

inline constexpr int kMaxLanes = 16;  ///< rows are written in blocks of at most this many floats

/// `count` raised to whole blocks of kMaxLanes.
[[nodiscard]] constexpr int whole_vectors(int count) noexcept {
  return (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
}

inline constexpr int kTapBatch = 4;           ///< a bank's taps come in batches; lists of taps are padded to it
inline constexpr int kMaxGuideChannels = 32;  ///< feature channels (and the colour's, with a range term)
inline constexpr int kMaxGuideGroups = 16;

/// The guides of one row: pointers to the row's first target pixel.
///
/// The weight of a neighbour is 2^-d with d = sum over groups of |a - b|^2 / max(va + vb, min_variance), where a and b
/// are the scaled features of the two pixels and va, vb their per-sample variances, times the neighbour's mask.
struct Guides {
  const float* channel[kMaxGuideChannels];  ///< feature means, scaled by sqrt(log2(e) / 2) / sigma_f
  const float* variance[kMaxGuideGroups];   ///< per-sample variance of each group, not scaled by sigma_f
  int group_end[kMaxGuideGroups];           ///< group g owns channels [group_end[g-1], group_end[g])
  int groups = 0;
  float min_variance = 0;
  float distance_scale = 1;     ///< factor to d
  const float* mask = nullptr;  ///< 1: a source; 0: invalid, or outside of the image
};

/// Channels of layers, which are averaged with the weights of the colour.
struct LayerChannels {
  int count = 0;
  const float* const* value = nullptr;  ///< of each channel, as the colour's pointers
  float* const* result = nullptr;       ///< out: [candidate * count + channel], as the colour's results
  float* scratch = nullptr;             ///< as many floats as the kernel says, aligned to 64 bytes
};

/// Whether the groups are those that have a faster path: 3, 3 and 1 channels (normal, albedo, depth).
[[nodiscard]] constexpr bool is_usual(const Guides& guides) noexcept {
  return guides.groups == 3 && guides.group_end[0] == 3 && guides.group_end[1] == 6 && guides.group_end[2] == 7;
}

/// The name of the instruction set that the kernels run on, as Highway calls it.
[[nodiscard]] const char* instruction_set() noexcept;

}  // namespace stein::kernels
