// SPDX-License-Identifier: Apache-2.0
#include "exec/available_threads.hpp"

#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <string>

#include "catch.hpp"
#include "exec/runner.hpp"
#include "support/temporary_folder.hpp"

namespace stein::exec {
namespace {

/// A machine's control groups in a folder.
class Groups {
 public:
  explicit Groups(const std::string& membership) { put("membership", membership); }

  void put(const std::string& path, const std::string& text) const {
    const std::filesystem::path file = folder_ / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text << "\n";
  }
  [[nodiscard]] int threads() const { return cgroup_threads(folder_ / "membership", folder_ / "root"); }

 private:
  TemporaryFolder folder_;
};

constexpr int kMany = 100'000;

/// The process on one of its cores, until the end of the scope.
class OneCore {
 public:
  OneCore() {
    sched_getaffinity(getpid(), sizeof before_, &before_);
    int first = 0;
    while (!CPU_ISSET(first, &before_)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    sched_setaffinity(getpid(), sizeof one, &one);
  }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;
  ~OneCore() { sched_setaffinity(getpid(), sizeof before_, &before_); }

 private:
  cpu_set_t before_{};
};

}  // namespace

TEST_CASE("threads: quotas of control groups, version 2, of the group and of all around it") {
  const Groups groups("0::/batch/job7");
  CHECK(groups.threads() > kMany);
  groups.put("root/batch/job7/cpu.max", "max 100000");
  CHECK(groups.threads() > kMany);
  groups.put("root/batch/job7/cpu.max", "600000 100000");
  CHECK(groups.threads() == 6);
  groups.put("root/batch/cpu.max", "250000 100000");
  CHECK(groups.threads() == 3);  // what is begun is worth a thread
  groups.put("root/cpu.max", "50000 100000");
  CHECK(groups.threads() == 1);
}

TEST_CASE("threads: quotas of control groups, version 1") {
  const Groups groups("4:memory:/other\n3:cpu,cpuacct:/batch\n2:cpuset:/");
  CHECK(groups.threads() > kMany);
  groups.put("root/cpu,cpuacct/batch/cpu.cfs_quota_us", "-1");
  groups.put("root/cpu,cpuacct/batch/cpu.cfs_period_us", "100000");
  CHECK(groups.threads() > kMany);
  groups.put("root/cpu,cpuacct/batch/cpu.cfs_quota_us", "400000");
  CHECK(groups.threads() == 4);
}

TEST_CASE("threads: what is not understood of control groups limits nothing") {
  CHECK(cgroup_threads("/nowhere", "/nowhere") > kMany);
  const Groups groups("nonsense\n:\n0::/x");
  groups.put("root/x/cpu.max", "many of them");
  CHECK(groups.threads() > kMany);
  groups.put("root/x/cpu.max", "100000 0");
  CHECK(groups.threads() > kMany);
}

TEST_CASE("threads: the affinity mask limits what is used unless a number is asked for") {
  CHECK(available_threads() >= 1);
  const OneCore one_core;
  CHECK(available_threads() == 1);
  Runner limited(Execution{});
  CHECK(limited.slots() == 1);
  Execution three;
  three.threads = 3;
  CHECK(Runner(three).slots() == 3);
}

}  // namespace stein::exec
