// SPDX-License-Identifier: Apache-2.0
//
// Parallel loops with progress and cancelling.
#pragma once

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <optional>

#include "stein/error.hpp"
#include "stein/execution.hpp"

namespace pathtracer {

/// Runs loops whose items add up to `total` units of progress.
class Parallel {
 public:
  Parallel(const stein::Execution& execution, double total)
      : execution_(execution),
        total_(total),
        arena_(execution.threads > 0 ? execution.threads : tbb::task_arena::automatic) {
    constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(execution.threads);
    if (wanted > tbb::global_control::active_value(kLimit)) more_workers_.emplace(kLimit, wanted);
  }

  /// units += body(item) for each item in [0, count), in any order. @throws stein::Error kCancelled.
  template <class Body>
  void for_each(int count, const Body& body) {
    arena_.execute([&] {
      tbb::parallel_for(
          0, count,
          [&](int item) {
            if (!cancelled_) advance(body(item));
          },
          tbb::simple_partitioner{});
    });
    if (cancelled_) throw stein::Error(stein::ErrorCode::kCancelled, "cancelled by the progress callback");
  }

 private:
  void advance(double units) {
    if (!execution_.progress) return;
    const std::lock_guard lock(mutex_);
    if (cancelled_) return;
    done_ += units;
    if (!execution_.progress(total_ > 0 ? std::min(done_ / total_, 1.0) : 1.0)) cancelled_ = true;
  }

  const stein::Execution& execution_;
  double total_;
  double done_ = 0;  // guarded by mutex_
  std::mutex mutex_;
  std::atomic<bool> cancelled_{false};
  std::optional<tbb::global_control> more_workers_;  // than there are cores, which oneTBB does not make by itself
  tbb::task_arena arena_;
};

}  // namespace pathtracer
