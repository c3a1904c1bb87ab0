// SPDX-License-Identifier: Apache-2.0
//
// What batch systems and containers allow, besides the machine.
#pragma once

#include <filesystem>

namespace stein::exec {

/// Threads that the CPU quota of control groups (version 1 or 2) leaves busy; very many where there is none. `groups`:
/// /proc/self/cgroup; `root`: where they are mounted, /sys/fs/cgroup.
[[nodiscard]] int cgroup_threads(const std::filesystem::path& groups, const std::filesystem::path& root);

}  // namespace stein::exec
