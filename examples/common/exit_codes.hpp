// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "stein/error.hpp"

namespace stein::cli {

// What a render farm decides by: kTryAgain and kCancelledByUser are worth another try, the others fail again until
// somebody acts. Documented in the help text of the program's main.cpp and in docs/farm.md.
enum ExitCode : int {
  kSuccess = 0,
  kOtherFailure = 1,
  kUsage = 2,
  kUnusableInput = 3,
  kIoFailure = 4,
  kCancelledByUser = 5,
  kTryAgain = 75,  ///< EX_TEMPFAIL of sysexits.h: a full disk, too little memory, a file server that does not answer
};

[[nodiscard]] ExitCode exit_code(const Error& error) noexcept;

/// A failure that is reported by its message and ends the program with its code.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

/// What the exception in flight, of any type, is to a user. Only in a catch block.
[[nodiscard]] Failure current_failure();

}  // namespace stein::cli
