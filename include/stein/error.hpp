// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#pragma GCC visibility push(default)
namespace stein {

/// What kind of thing went wrong. The message says which plane, pixel or file, and what to do about it. The numbers are
/// those of stein.h, and stay.
enum class ErrorCode {
  kInvalidArgument = 1,  ///< a parameter is out of its documented range
  kInvalidFrame = 2,     ///< planes are missing, mismatched, or hold values that cannot be used
  kIo = 3,               ///< a file cannot be opened, read or written
  kUnsupported = 4,      ///< well-formed, but not something stein can read or do
  kCancelled = 5,        ///< the progress callback asked to stop
};

/// The one exception type that public functions throw (besides std::bad_alloc).
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace stein
#pragma GCC visibility pop
