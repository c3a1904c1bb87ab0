// SPDX-License-Identifier: Apache-2.0
//
// A renderer calls from wherever it is: from several threads at a time, within arenas, within its own parallel loops.
// Every call gives the bits of a call alone.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstring>
#include <deque>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "stein/denoise.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 34;
constexpr int kHeight = 27;
constexpr int kCalls = 4;

std::vector<float> values_of(const DenoiseResult& result) {
  std::vector<float> values;
  for (const Plane* plane : {&result.colour[0], &result.colour[1], &result.error[2], &result.choice, &result.density}) {
    for (int y = 0; y < kHeight; ++y) values.insert(values.end(), plane->row(y), plane->row(y) + kWidth);
  }
  return values;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// Calls with different frames, filters and numbers of threads, and what each gives alone.
class Calls {
 public:
  Calls() {
    const std::vector<FilterSpec> filters = {CrossBilateralParams{}, AtrousSureParams{}, GaussianParams{}};
    for (int i = 0; i < kCalls; ++i) {
      OwnedFrame& frame = frames_.emplace_back(kWidth, kHeight, kUsualFeatures);
      fill_random(frame, 50 + static_cast<std::uint64_t>(i));
      frame.at("G", 7 + i, 5) = std::numeric_limits<float>::quiet_NaN();
      DenoiseParams& params = params_.emplace_back();
      params.filters = {filters[static_cast<std::size_t>(i) % filters.size()]};
      params.execution.threads = i % 3;  // 0: of the arena that the call is in
      params.execution.tile_width = 16;
      params.execution.tile_height = 8;
      expected_.push_back(values_of(denoise(frame.frame(), params)));
    }
    const std::lock_guard lock(mutex_);  // see make()
  }

  /// Call number `i`, from any thread.
  void make(int i) {
    const auto at = static_cast<std::size_t>(i % kCalls);
    // Tells ThreadSanitizer, which does not see how TBB orders the work, that all of the above was before.
    { const std::lock_guard lock(mutex_); }
    const std::vector<float> values = values_of(denoise(frames_[at].frame(), params_[at]));
    const std::lock_guard lock(mutex_);
    ++done_;
    if (!same_bits(values, expected_[at])) ++wrong_;
  }

  void check(int done) {
    const std::lock_guard lock(mutex_);
    CHECK(done_ == done);
    CHECK(wrong_ == 0);
  }

 private:
  std::deque<OwnedFrame> frames_;
  std::vector<DenoiseParams> params_;
  std::vector<std::vector<float>> expected_;
  std::mutex mutex_;
  int done_ = 0;   // guarded by mutex_
  int wrong_ = 0;  // guarded by mutex_
};

void in_threads(int count, const std::function<void(int)>& work) {
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) threads.emplace_back(work, i);
  for (std::thread& thread : threads) thread.join();
}

}  // namespace

TEST_CASE("threads: calls from several threads of the caller do not meet") {
  Calls calls;
  in_threads(kCalls, [&](int i) {
    calls.make(i);
    calls.make(i + 1);
  });
  calls.check(2 * kCalls);
}

TEST_CASE("threads: calls within arenas of the caller do not meet") {
  Calls calls;
  // A slot for each caller and two more: with fewer, TBB lets another thread run a caller's work, through a closure on
  // the caller's stack, and ThreadSanitizer does not see that it was written before.
  tbb::task_arena shared(kCalls + 2, kCalls);
  in_threads(kCalls, [&](int i) {
    tbb::task_arena own(1 + i % 2);
    own.execute([&] { calls.make(i); });
    shared.execute([&] { calls.make(i + 1); });
  });
  calls.check(2 * kCalls);
}

TEST_CASE("threads: calls nested in a parallel loop of the caller do not meet") {
  Calls calls;
  // Not captured: ThreadSanitizer would take what a closure on this thread's stack holds for unordered with its use.
  static std::atomic<Calls*> shared;
  shared = &calls;
  tbb::task_arena arena(3);
  arena.execute([] {
    tbb::parallel_for(
        0, 2 * kCalls, [](int i) { shared.load()->make(i); }, tbb::simple_partitioner{});
  });
  calls.check(2 * kCalls);
}

TEST_CASE("threads: a call that is cancelled leaves those beside it alone") {
  Calls calls;
  OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
  fill_random(frame, 60);
  in_threads(2, [&](int i) {
    if (i == 0) return calls.make(1);
    DenoiseParams params;
    params.execution.threads = 2;
    params.execution.progress = [](double done) { return done < 0.3; };
    CHECK_THROWS(denoise(frame.frame(), params));
  });
  calls.check(1);
}

}  // namespace stein::test
