// SPDX-License-Identifier: Apache-2.0
#include "exec/runner.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "stein/error.hpp"

namespace stein::exec {
namespace {

Execution with_threads(int threads) {
  Execution execution;
  execution.threads = threads;
  return execution;
}

// Waits until `wanted` threads have come, or until it has waited too long.
class Rendezvous {
 public:
  explicit Rendezvous(int wanted) : wanted_(wanted) {}
  bool arrive_and_wait() {
    std::unique_lock lock(mutex_);
    ++arrived_;
    all_here_.notify_all();
    return all_here_.wait_for(lock, std::chrono::seconds(30), [&] { return arrived_ >= wanted_; });
  }

 private:
  const int wanted_;
  int arrived_ = 0;
  std::mutex mutex_;
  std::condition_variable all_here_;
};

void wait_a_little() { std::this_thread::sleep_for(std::chrono::microseconds(50)); }

ErrorCode cancelled_code(Runner& runner, int count, const std::function<void(int, int)>& body) {
  try {
    runner.for_each(count, 1.0, body);
  } catch (const Error& error) {
    return error.code();
  }
  FAIL("the loop was not cancelled");
  return ErrorCode::kIo;
}

}  // namespace

TEST_CASE("runner: every item runs once, for any number of threads and items") {
  for (const int threads : {0, 1, 2, 3, 7}) {
    Runner runner(with_threads(threads));
    CHECK(runner.slots() >= 1);
    if (threads > 0) CHECK(runner.slots() == threads);
    for (const int count : {0, 1, 2, 5, 100, 3000}) {
      std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
      std::atomic<int> bad_slots{0};
      runner.for_each(count, 0.0, [&](int item, int slot) {
        ++runs.at(static_cast<std::size_t>(item));
        if (slot < 0 || slot >= runner.slots()) ++bad_slots;
      });
      CHECK(std::all_of(runs.begin(), runs.end(), [](const std::atomic<int>& n) { return n == 1; }));
      CHECK(bad_slots == 0);
    }
  }
}

TEST_CASE("runner: what is written in a loop of several threads is seen after it, and in the next one") {
  Runner runner(with_threads(3));
  std::vector<int> plain(2000);
  runner.for_each(2000, 0.0, [&](int item, int) { plain[static_cast<std::size_t>(item)] = item; });
  std::vector<int> next(2000);
  runner.for_each(2000, 0.0, [&](int item, int) {
    next[static_cast<std::size_t>(item)] = plain[static_cast<std::size_t>(1999 - item)];
  });
  int wrong = 0;
  for (int i = 0; i < 2000; ++i) wrong += next[static_cast<std::size_t>(i)] == 1999 - i ? 0 : 1;
  CHECK(wrong == 0);
}

TEST_CASE("runner: no two threads hold a slot at the same time") {
  for (const int threads : {0, 1, 2, 5}) {
    Runner runner(with_threads(threads));
    std::vector<std::atomic<bool>> busy(static_cast<std::size_t>(runner.slots()));
    std::vector<int> uses(static_cast<std::size_t>(runner.slots()));  // not atomic: the slot's own
    std::atomic<int> clashes{0};
    for (int round = 0; round < 4; ++round) {
      runner.for_each(100, 0.0, [&](int, int slot) {
        const auto s = static_cast<std::size_t>(slot);
        if (busy[s].exchange(true)) ++clashes;
        ++uses[s];
        wait_a_little();
        busy[s] = false;
      });
    }
    CHECK(clashes == 0);
    int sum = 0;
    for (const int n : uses) sum += n;
    CHECK(sum == 400);
  }
}

TEST_CASE("runner: more threads than cores are there when they are asked for") {
  const int threads = std::max(3, static_cast<int>(std::thread::hardware_concurrency()) + 1);
  Runner runner(with_threads(threads));
  Rendezvous rendezvous(threads);
  std::mutex mutex;
  std::set<std::thread::id> ids;
  std::set<int> slots;
  std::atomic<int> alone{0};
  runner.for_each(threads, 0.0, [&](int, int slot) {
    {
      const std::lock_guard lock(mutex);
      ids.insert(std::this_thread::get_id());
      slots.insert(slot);
    }
    if (!rendezvous.arrive_and_wait()) ++alone;
  });
  CHECK(alone == 0);
  CHECK(ids.size() == static_cast<std::size_t>(threads));
  CHECK(slots.size() == static_cast<std::size_t>(threads));
}

TEST_CASE("runner: a limit of one uses the thread of the caller alone") {
  Runner runner(with_threads(1));
  std::set<std::thread::id> ids;
  std::set<int> slots;
  runner.for_each(50, 0.0, [&](int, int slot) {
    ids.insert(std::this_thread::get_id());
    slots.insert(slot);
  });
  CHECK(ids == std::set<std::thread::id>{std::this_thread::get_id()});
  CHECK(slots == std::set<int>{0});
}

TEST_CASE("runner: two runners work in two threads of the caller without mixing") {
  std::vector<std::atomic<int>> runs(2);
  std::atomic<int> clashes{0};
  const auto work = [&](std::size_t which) {
    Runner runner(with_threads(2));
    std::vector<std::atomic<bool>> busy(static_cast<std::size_t>(runner.slots()));
    runner.for_each(200, 0.0, [&](int, int slot) {
      if (busy[static_cast<std::size_t>(slot)].exchange(true)) ++clashes;
      ++runs[which];
      wait_a_little();
      busy[static_cast<std::size_t>(slot)] = false;
    });
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  CHECK(runs[0] == 200);
  CHECK(runs[1] == 200);
  CHECK(clashes == 0);
}

TEST_CASE("runner: an exception of the body comes out of all threads, and the runner works on") {
  for (const int threads : {1, 3}) {
    Runner runner(with_threads(threads));
    for (const int thrower : {0, 57, 99}) {
      std::string message;
      try {
        runner.for_each(100, 0.0, [&](int item, int) {
          if (item == thrower) throw std::runtime_error("item " + std::to_string(item));
        });
      } catch (const std::runtime_error& error) {
        message = error.what();
      }
      CHECK(message == "item " + std::to_string(thrower));
    }
    std::atomic<int> runs{0};
    runner.for_each(100, 0.0, [&](int, int) { ++runs; });
    CHECK(runs == 100);
  }
}

TEST_CASE("runner: progress never decreases, is not told by two threads at a time, and sums to the weights") {
  for (const int threads : {0, 1, 3}) {
    std::vector<double> told;
    std::atomic<int> inside{0};
    std::atomic<int> clashes{0};
    Execution execution = with_threads(threads);
    execution.progress = [&](double done) {
      if (++inside > 1) ++clashes;
      told.push_back(done);
      wait_a_little();
      --inside;
      return true;
    };
    Runner runner(execution);
    runner.for_each(37, 0.25, [](int, int) {});
    REQUIRE(told.size() == 37);
    CHECK(told.back() == Approx(0.25).epsilon(1e-12));
    runner.for_each(0, 0.3, [](int, int) {});
    CHECK(told.size() == 37);
    runner.for_each(11, 0.75, [](int, int) {});
    REQUIRE(told.size() == 48);
    CHECK(told.back() == Approx(1.0).epsilon(1e-12));
    CHECK(std::is_sorted(told.begin(), told.end()));
    CHECK(told.back() <= 1.0);
    CHECK(clashes == 0);
  }
}

TEST_CASE("runner: cancelling stops all threads, and the callback is not called again") {
  for (const int threads : {0, 1, 3}) {
    int calls = 0;
    Execution execution = with_threads(threads);
    execution.progress = [&](double) { return ++calls < 5; };
    Runner runner(execution);
    std::atomic<int> runs{0};
    const auto body = [&](int, int) {
      ++runs;
      wait_a_little();
    };
    CHECK(cancelled_code(runner, 5000, body) == ErrorCode::kCancelled);
    CHECK(calls == 5);
    CHECK(runs >= 5);
    CHECK(runs < 5 + 2 * runner.slots());  // what was under way, and no more
    const int runs_before = runs;
    CHECK(cancelled_code(runner, 10, body) == ErrorCode::kCancelled);
    CHECK(runs == runs_before);
    CHECK(calls == 5);
  }
}

}  // namespace stein::exec
