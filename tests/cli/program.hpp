// SPDX-License-Identifier: Apache-2.0
//
// Runs the stein program as a user does.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

struct Outcome {
  int exit_code = -1;  ///< -1: ended by `signal`
  int signal = 0;
  std::string out;
  std::string err;
};

/// Runs `stein arguments...` to its end. A file size limit above 0 makes writes fail beyond that many bytes. `folder`:
/// to run it in.
[[nodiscard]] Outcome run_stein(const std::vector<std::string>& arguments, long file_size_limit = 0,
                                const std::string& folder = ".");

/// The program with standard error going to a pipe of one page that is nearly full: it halts at one of the progress
/// lines after the first two, until `drain`. So a test can act in the middle of a run, however fast the machine.
class HaltedProgram {
 public:
  explicit HaltedProgram(const std::vector<std::string>& arguments);
  HaltedProgram(const HaltedProgram&) = delete;
  HaltedProgram& operator=(const HaltedProgram&) = delete;
  ~HaltedProgram();

  /// Returns once two lines were written; false if the program ended before.
  [[nodiscard]] bool wait_for_progress();
  void send(int signal) const;
  /// Whether the program has ended; if so `outcome` is valid.
  [[nodiscard]] bool has_ended();
  /// Lets the program go on and waits for its end.
  void drain();

  [[nodiscard]] const Outcome& outcome() const { return outcome_; }

 private:
  void remember(int status);

  pid_t process_ = -1;
  int pipe_ = -1;
  bool ended_ = false;
  Outcome outcome_;
};
