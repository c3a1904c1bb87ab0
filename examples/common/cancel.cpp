// SPDX-License-Identifier: Apache-2.0
#include "cancel.hpp"

#include <atomic>
#include <csignal>

#include "stein/error.hpp"

namespace stein::cli {
namespace {

std::atomic<bool> interrupt_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "the flag is set in a signal handler");

extern "C" void raise_interrupt_flag(int /*signal*/) { interrupt_flag.store(true, std::memory_order_relaxed); }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = raise_interrupt_flag;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() noexcept { return interrupt_flag.load(std::memory_order_relaxed); }

void check_not_interrupted() {
  if (interrupted()) {
    throw Error(ErrorCode::kCancelled, "cancelled");
  }
}

}  // namespace stein::cli
