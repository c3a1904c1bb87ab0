// SPDX-License-Identifier: Apache-2.0
#include "exec/runner.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>

#include "stein/error.hpp"

namespace stein::exec {

struct Runner::State {
  std::optional<tbb::global_control> more_workers;  // oneTBB makes no more than there are cores unless told so
  std::optional<tbb::task_arena> own_arena;
  std::function<bool(double)> progress;
  std::mutex progress_mutex;
  double done = 0;  // guarded by progress_mutex
  std::atomic<bool> cancelled{false};

  void advance(double amount) {
    if (!progress) return;
    const std::lock_guard lock(progress_mutex);
    if (cancelled) return;  // no call after the one that cancelled
    done += amount;
    if (!progress(std::min(done, 1.0))) cancelled = true;
  }
};

Runner::Runner(const Execution& execution) : state_(std::make_unique<State>()) {
  if (execution.threads > 0) {
    constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(execution.threads);
    if (wanted > tbb::global_control::active_value(kLimit)) state_->more_workers.emplace(kLimit, wanted);
    state_->own_arena.emplace(execution.threads);
  }
  state_->progress = execution.progress;
}

Runner::~Runner() = default;

int Runner::slots() const noexcept {
  return state_->own_arena ? state_->own_arena->max_concurrency() : tbb::this_task_arena::max_concurrency();
}

void Runner::for_each(int count, double weight, const std::function<void(int, int)>& body) {
  if (count <= 0) return;
  State& state = *state_;
  const double step = weight / count;
  const auto run_item = [&](int item) {
    if (state.cancelled) return;
    body(item, tbb::this_task_arena::current_thread_index());
    state.advance(step);
  };
  const auto loop = [&] {
    // Isolated: a thread that waits here must not pick up unrelated work of the caller while it owns a slot.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, count, run_item, tbb::simple_partitioner{}); });
  };
  if (state.own_arena) {
    state.own_arena->execute(loop);
  } else {
    loop();
  }
  if (state.cancelled) throw Error(ErrorCode::kCancelled, "cancelled by the progress callback");
}

}  // namespace stein::exec
