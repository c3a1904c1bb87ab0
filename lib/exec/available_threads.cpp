// SPDX-License-Identifier: Apache-2.0
#include "exec/available_threads.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

#include "stein/execution.hpp"

namespace stein::exec {
namespace {

constexpr int kNoLimit = 1 << 20;

/// Time per period, as whole threads; `quota` is "max" or -1 where there is no limit.
int threads_of(const std::string& quota, double period) {
  const double time = quota == "max" ? -1 : std::strtod(quota.c_str(), nullptr);
  if (!(time > 0) || !(period > 0)) return kNoLimit;
  return static_cast<int>(std::clamp(std::ceil(time / period), 1.0, static_cast<double>(kNoLimit)));
}

int limit_v2(const std::filesystem::path& folder) {
  std::ifstream file(folder / "cpu.max");
  std::string quota;
  double period = 0;
  return file >> quota >> period ? threads_of(quota, period) : kNoLimit;
}

int limit_v1(const std::filesystem::path& folder) {
  std::ifstream quota_file(folder / "cpu.cfs_quota_us");
  std::ifstream period_file(folder / "cpu.cfs_period_us");
  std::string quota;
  double period = 0;
  return quota_file >> quota && period_file >> period ? threads_of(quota, period) : kNoLimit;
}

/// The least limit of a group and of all that it is in. Within a container the path can be that of the host, and only
/// the root is there.
template <class Limit>
int least_limit(const std::filesystem::path& root, std::filesystem::path group, const Limit& limit) {
  int least = limit(root);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path()) {
    least = std::min(least, limit(root / group));
  }
  return least;
}

bool has_word(const std::string& list, const std::string& word) {
  return ("," + list + ",").find("," + word + ",") != std::string::npos;
}

int affinity_threads() {
  cpu_set_t cpus;
  // That of the process, not of the calling thread: renderers pin their threads to one core each.
  if (sched_getaffinity(getpid(), sizeof cpus, &cpus) != 0)
    return static_cast<int>(std::thread::hardware_concurrency());
  return CPU_COUNT(&cpus);
}

}  // namespace

int cgroup_threads(const std::filesystem::path& groups, const std::filesystem::path& root) {
  std::ifstream file(groups);
  int least = kNoLimit;
  for (std::string line; std::getline(file, line);) {  // number:controllers:path
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty()) least = std::min(least, least_limit(root, group, limit_v2));
    if (has_word(controllers, "cpu")) least = std::min(least, least_limit(root / controllers, group, limit_v1));
  }
  return least;
}

}  // namespace stein::exec

namespace stein {

int available_threads() {
  return std::max(1, std::min(exec::affinity_threads(), exec::cgroup_threads("/proc/self/cgroup", "/sys/fs/cgroup")));
}

}  // namespace stein
