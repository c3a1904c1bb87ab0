// SPDX-License-Identifier: Apache-2.0
//
// Parallel loops over independent items, with progress and cancelling. The only place that knows threads.
#pragma once

#include <functional>
#include <memory>

#include "stein/execution.hpp"

namespace stein::exec {

class Runner {
 public:
  explicit Runner(const Execution& execution);
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// Number of different `slot` values that loops may pass: the size of an array of scratch memory.
  [[nodiscard]] int slots() const noexcept;

  /// Calls body(item, slot) once for each item in [0, count), in any order; no two calls at a time share a slot.
  /// Each finished item adds `weight / count` to the progress. @throws Error kCancelled; what the body throws.
  /// Memory under a limit is trimmed after each item.
  void for_each(int count, double weight, const std::function<void(int item, int slot)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stein::exec
