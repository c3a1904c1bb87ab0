// SPDX-License-Identifier: Apache-2.0
//
// Outputs are the old file or the new one, never a piece of it: whatever ends the program, and whoever else writes.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

using Names = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

pid_t start_quietly(Names arguments) {
  arguments.insert(arguments.begin(), "stein");
  std::vector<char*> pointers;
  for (std::string& text : arguments) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  const pid_t process = fork();
  if (process == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execv(STEIN_PROGRAM, pointers.data());
    _exit(127);
  }
  return process;
}

/// A verb that makes `outputs` of an image, all of them known.
struct Job {
  Names arguments;
  Names outputs;
};

/// Kills the job at random moments of its run, each time looking at what lies there afterwards.
void check_killed(const TemporaryFolder& folder, const Job& job, int times) {
  const auto start = Clock::now();
  REQUIRE(run_stein(job.arguments).exit_code == 0);
  const std::chrono::duration<double> whole_run = Clock::now() - start;
  Names whole;
  for (const std::string& output : job.outputs) whole.push_back(content(output));
  const std::size_t files = folder.entries();
  std::mt19937 random(5);
  int killed = 0;
  for (int i = 0; i < times; ++i) {
    for (const std::string& output : job.outputs) std::ofstream(output, std::ios::trunc) << "old";
    const pid_t process = start_quietly(job.arguments);
    std::this_thread::sleep_for(whole_run * (static_cast<double>(random() % 1000) / 1000));
    kill(process, SIGKILL);
    int status = 0;
    waitpid(process, &status, 0);
    killed += WIFSIGNALED(status) ? 1 : 0;
    for (std::size_t k = 0; k < whole.size(); ++k) {
      const std::string found = content(job.outputs[k]);
      const bool is_report = job.outputs[k].ends_with(".json");  // it tells times, which differ
      const bool is_whole = found == "old" || (is_report ? nlohmann::json::accept(found) : found == whole[k]);
      CHECK(is_whole);
    }
  }
  CHECK(killed > 0);
  REQUIRE(run_stein(job.arguments).exit_code == 0);
  CHECK(folder.entries() == files);  // what the killed runs left is gone
}

}  // namespace

TEST_CASE("whole: kill -9 at 50 random moments of a run leaves the old file or the new one") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(128, 96));
  const Job job = {{"denoise", folder / "noisy.exr", "-o", folder / "clean.exr", "--json", folder / "report.json",
                    "--quiet", "--filter", "gaussian"},
                   {folder / "clean.exr", folder / "report.json"}};
  check_killed(folder, job, 50);
}

TEST_CASE("whole: kill -9 at random moments, of a picture") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(256, 192));
  check_killed(folder, {{"preview", folder / "noisy.exr", "-o", folder / "noisy.png"}, {folder / "noisy.png"}}, 30);
}

TEST_CASE("whole: several processes write one output at the same time") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(64, 48));
  const std::string out = folder / "clean.exr";
  const auto arguments = [&](const char* strength) {
    return Names{"denoise", folder / "noisy.exr", "-o", out, "--filter", "gaussian", "--strength", strength};
  };
  const Names strengths = {"1", "0.5", "0.25", "0"};
  Names wholes;
  for (const std::string& strength : strengths) {
    REQUIRE(run_stein(arguments(strength.c_str())).exit_code == 0);
    wholes.push_back(content(out));
  }
  const auto is_whole = [&] { return std::find(wholes.begin(), wholes.end(), content(out)) != wholes.end(); };
  for (int round = 0; round < 5; ++round) {
    std::vector<pid_t> processes;
    for (const std::string& strength : strengths) processes.push_back(start_quietly(arguments(strength.c_str())));
    for (const pid_t process : processes) {
      int status = 0;
      while (waitpid(process, &status, WNOHANG) == 0) REQUIRE(is_whole());
      CHECK(WIFEXITED(status));
      CHECK(WEXITSTATUS(status) == 0);
    }
    CHECK(is_whole());
  }
  CHECK(folder.names() == Names{"clean.exr", "noisy.exr"});
}

TEST_CASE("whole: a temporary file goes when nobody writes it any more, and no sooner") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(24, 16));
  const std::string orphan = folder / ".clean.exr.0123456789ab.stein-tmp";
  const Names others = {".clean.exr.stein-tmp", ".other.exr.0123456789ab.stein-tmp", "clean.exr.stein-tmp"};
  for (const std::string& name : others) std::ofstream(folder / name) << "of others";
  const Names arguments = {"denoise", folder / "noisy.exr", "-o", folder / "clean.exr"};

  const int held = open(orphan.c_str(), O_RDWR | O_CREAT, 0600);
  REQUIRE(flock(held, LOCK_EX) == 0);
  REQUIRE(run_stein(arguments).exit_code == 0);
  CHECK(access(orphan.c_str(), F_OK) == 0);
  close(held);
  REQUIRE(run_stein(arguments).exit_code == 0);
  CHECK(access(orphan.c_str(), F_OK) != 0);
  for (const std::string& name : others) CHECK(access((folder / name).c_str(), F_OK) == 0);
}
