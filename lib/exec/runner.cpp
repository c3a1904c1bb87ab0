// SPDX-License-Identifier: Apache-2.0
#include "exec/runner.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "stein/error.hpp"

#ifdef __has_feature
#if __has_feature(thread_sanitizer)
#define STEIN_TSAN 1
#endif
#elif defined(__SANITIZE_THREAD__)
#define STEIN_TSAN 1
#endif
#ifdef STEIN_TSAN
#include <sanitizer/tsan_interface.h>
#endif

namespace stein::exec {
namespace {

// ThreadSanitizer does not see how TBB, which is built without it, orders the work. These tell it: what was done before
// `publish(p)` is seen after `observe(p)`.
#ifdef STEIN_TSAN
void publish(void* p) { __tsan_release(p); }
void observe(void* p) { __tsan_acquire(p); }
#else
void publish(void* /*p*/) {}
void observe(void* /*p*/) {}
#endif

// Calls it when the scope ends, by an exception as well.
template <class Action>
class AtExit {
 public:
  explicit AtExit(Action action) : action_(std::move(action)) {}
  AtExit(const AtExit&) = delete;
  AtExit& operator=(const AtExit&) = delete;
  ~AtExit() { action_(); }

 private:
  Action action_;
};

/// TBB looks at the affinity mask once, and not at quotas of control groups: its default arena can be too large. 0:
/// not.
int limit_of_default_arena() {
  const int default_threads = tbb::info::default_concurrency();
  if (tbb::this_task_arena::max_concurrency() != default_threads) return 0;  // the caller's choice
  const int available = available_threads();
  return available < default_threads ? available : 0;
}

char begin_of_loop = 0;  // static: what a closure holds is only seen after observing

}  // namespace

struct Runner::State {
  std::optional<tbb::global_control> more_workers;  // oneTBB makes no more than there are cores unless told so
  std::optional<tbb::task_arena> own_arena;
  std::function<bool(double)> progress;
  std::shared_ptr<Memory> memory;
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
  const int threads = execution.threads > 0 ? execution.threads : limit_of_default_arena();
  if (threads > 0) {
    constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(threads);
    if (wanted > tbb::global_control::active_value(kLimit)) state_->more_workers.emplace(kLimit, wanted);
    state_->own_arena.emplace(threads);
  }
  state_->progress = execution.progress;
  state_->memory = execution.memory;
}

Runner::~Runner() = default;

int Runner::slots() const noexcept {
  return state_->own_arena ? state_->own_arena->max_concurrency() : tbb::this_task_arena::max_concurrency();
}

void Runner::for_each(int count, double weight, const std::function<void(int, int)>& body) {
  if (count <= 0) return;
  State& state = *state_;
  const double step = weight / count;
  std::vector<char> in_slot(static_cast<std::size_t>(slots()));
  const auto run_item = [&](int item) {
    const int slot = tbb::this_task_arena::current_thread_index();
    observe(&begin_of_loop);
    observe(&in_slot[static_cast<std::size_t>(slot)]);
    const AtExit end_of_item([&] {
      publish(&in_slot[static_cast<std::size_t>(slot)]);
      publish(&state);
    });
    if (!state.cancelled) {
      body(item, slot);
      if (state.memory) state.memory->trim();
      state.advance(step);
    }
  };
  publish(&begin_of_loop);
  const auto loop = [&] {
    // Isolated: a thread that waits here must not pick up unrelated work of the caller while it owns a slot.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, count, run_item, tbb::simple_partitioner{}); });
  };
  {
    const AtExit end_of_loop([&] { observe(&state); });
    if (state.own_arena) {
      state.own_arena->execute(loop);
    } else {
      loop();
    }
  }
  if (state.cancelled) throw Error(ErrorCode::kCancelled, "cancelled by the progress callback");
}

}  // namespace stein::exec
