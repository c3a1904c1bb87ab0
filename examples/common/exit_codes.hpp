// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stein/error.hpp"

namespace stein::cli {

// What a render farm decides by. Documented in the help text of main.cpp.
enum ExitCode : int {
  kSuccess = 0,
  kOtherFailure = 1,
  kUsage = 2,
  kUnusableInput = 3,
  kIoFailure = 4,
  kCancelledByUser = 5,
};

[[nodiscard]] constexpr ExitCode exit_code(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return kUsage;
    case ErrorCode::kInvalidFrame:
    case ErrorCode::kUnsupported:
      return kUnusableInput;
    case ErrorCode::kIo:
      return kIoFailure;
    case ErrorCode::kCancelled:
      return kCancelledByUser;
  }
  return kOtherFailure;
}

}  // namespace stein::cli
