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
  explicit Error(ErrorCode code, const std::string& message, int system_error = 0)
      : std::runtime_error(message), code_(code), system_error_(system_error) {}
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  /// Of kIo, the `errno` behind it, such as ENOSPC for a full disk; 0 where there is none.
  [[nodiscard]] int system_error() const noexcept { return system_error_; }

 private:
  ErrorCode code_;
  int system_error_;
};

}  // namespace stein
#pragma GCC visibility pop
