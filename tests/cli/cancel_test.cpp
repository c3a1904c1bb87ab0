// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

// Small tiles: the run then has many steps, and reports its progress in many.
std::vector<std::string> slow_run(const TemporaryFolder& folder) {
  write(folder / "noisy.exr", noisy_image(128, 128));
  return {"denoise", folder / "noisy.exr", "-o", folder / "clean.exr", "--json", folder / "report.json", "--tile",
          "16x16",   "--threads",          "1"};
}

}  // namespace

TEST_CASE("the first interrupt cancels and leaves nothing behind") {
  const int signal = GENERATE(SIGINT, SIGTERM);
  const TemporaryFolder folder;
  HaltedProgram program(slow_run(folder));
  REQUIRE(program.wait_for_progress());
  program.send(signal);
  program.drain();
  CHECK(program.outcome().exit_code == 5);
  CHECK(program.outcome().err.find("stein: cancelled\n") != std::string::npos);
  CHECK(program.outcome().err.find("100%") == std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"noisy.exr"});
}

TEST_CASE("without an interrupt the halted run completes") {
  const TemporaryFolder folder;
  HaltedProgram program(slow_run(folder));
  REQUIRE(program.wait_for_progress());
  program.drain();
  CHECK(program.outcome().exit_code == 0);
  CHECK(program.outcome().err.find("100%\n") != std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"clean.exr", "noisy.exr", "report.json"});
}

TEST_CASE("a second interrupt ends a run that does not react") {
  const TemporaryFolder folder;
  HaltedProgram program(slow_run(folder));
  REQUIRE(program.wait_for_progress());
  constexpr int kEnough = 2000;  // two that are sent at once may arrive as one
  for (int i = 0; i < kEnough && !program.has_ended(); ++i) {
    program.send(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  REQUIRE(program.has_ended());
  CHECK(program.outcome().signal == SIGINT);
  CHECK(folder.names() == std::vector<std::string>{"noisy.exr"});
}
