// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "stein/memory.hpp"

#pragma GCC visibility push(default)
namespace stein {

/// How to run, never what to compute: results are bit-identical for every setting here.
struct Execution {
  /// 0: work in the task arena of the calling thread, as it is; where that is the default one, with
  /// available_threads(). n >= 1: at most n threads, the calling one included.
  int threads = 0;
  int tile_width = 0;   ///< [0, 16..4096] px; 0: default
  int tile_height = 0;  ///< [0, 1..4096] px; 0: default
  /// Where images and windows of rows lie: see memory.hpp. Null: on the heap, whatever it takes.
  std::shared_ptr<Memory> memory;
  /// Called with the fraction done in [0, 1], never decreasing, one call at a time, from any working thread.
  /// Return false to cancel: the call in progress ends within about one tile and throws Error kCancelled.
  std::function<bool(double)> progress;
};

/// Cores that this process may keep busy: those of its affinity mask, and no more than the CPU quota of its control
/// groups allows (containers, batch systems).
[[nodiscard]] int available_threads();

}  // namespace stein
#pragma GCC visibility pop
