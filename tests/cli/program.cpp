// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace {

constexpr int kPipeSize = 4096;
constexpr int kRoom = 20;     // for less than all lines of a run, however short they are
constexpr int kTwoLines = 7;  // "0%\n" and "NN%\n" at the least

void require(bool condition, const char* what) {
  if (!condition) {
    throw std::runtime_error(what);
  }
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Never returns. Only what is safe after a fork.
[[noreturn]] void become_stein(char* const* arguments, int out, int err, long file_size_limit, const char* folder) {
  if (chdir(folder) != 0) _exit(126);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (file_size_limit > 0) {
    struct rlimit limit = {};
    limit.rlim_cur = limit.rlim_max = static_cast<rlim_t>(file_size_limit);
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);  // so that writes fail instead
  }
  execv(STEIN_PROGRAM, arguments);
  _exit(127);
}

pid_t start(const std::vector<std::string>& arguments, int out, int err, long file_size_limit,
            const std::string& folder = ".") {
  std::vector<std::string> texts = {"stein"};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) {
    pointers.push_back(text.data());
  }
  pointers.push_back(nullptr);
  const pid_t process = fork();
  require(process >= 0, "fork failed");
  if (process == 0) {
    become_stein(pointers.data(), out, err, file_size_limit, folder.c_str());
  }
  return process;
}

int open_for_output(const std::string& path) { return open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600); }

}  // namespace

Outcome run_stein(const std::vector<std::string>& arguments, long file_size_limit, const std::string& folder) {
  const TemporaryFolder texts;
  const int out = open_for_output(texts / "out");
  const int err = open_for_output(texts / "err");
  const pid_t process = start(arguments, out, err, file_size_limit, folder);
  close(out);
  close(err);
  int status = 0;
  require(waitpid(process, &status, 0) == process, "waitpid failed");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          read_file(texts / "out"), read_file(texts / "err")};
}

HaltedProgram::HaltedProgram(const std::vector<std::string>& arguments) {
  std::array<int, 2> ends{};
  require(pipe2(ends.data(), O_CLOEXEC) == 0, "no pipe");
  pipe_ = ends[0];
  require(fcntl(ends[1], F_SETPIPE_SZ, kPipeSize) == kPipeSize, "no pipe of one page");
  const std::string filling(kPipeSize - kRoom, '.');
  require(write(ends[1], filling.data(), filling.size()) == static_cast<ssize_t>(filling.size()),
          "cannot fill the pipe");
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  process_ = start(arguments, nowhere, ends[1], 0);
  close(nowhere);
  close(ends[1]);
}

HaltedProgram::~HaltedProgram() {
  if (!ended_) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  close(pipe_);
}

bool HaltedProgram::wait_for_progress() {
  while (!has_ended()) {
    int waiting = 0;
    require(ioctl(pipe_, FIONREAD, &waiting) == 0, "cannot look at the pipe");
    if (waiting >= kPipeSize - kRoom + kTwoLines) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

void HaltedProgram::send(int signal) const { kill(process_, signal); }

bool HaltedProgram::has_ended() {
  int status = 0;
  if (!ended_ && waitpid(process_, &status, WNOHANG) == process_) {
    remember(status);
  }
  return ended_;
}

void HaltedProgram::drain() {
  std::array<char, kPipeSize> buffer{};
  for (ssize_t count = 1; count > 0;) {
    count = read(pipe_, buffer.data(), buffer.size());
    outcome_.err.append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
  int status = 0;
  if (!ended_ && waitpid(process_, &status, 0) == process_) {
    remember(status);
  }
}

void HaltedProgram::remember(int status) {
  ended_ = true;
  outcome_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  outcome_.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}
