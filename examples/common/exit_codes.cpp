// SPDX-License-Identifier: Apache-2.0
#include "exit_codes.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <new>

namespace stein::cli {
namespace {

// What passes without anybody changing the file or the command.
bool is_temporary(int system_error) {
  constexpr std::array kTemporary = {ENOSPC, EDQUOT, EIO,    ENOMEM,    EAGAIN,       EINTR,      EBUSY,
                                     EMFILE, ENFILE, ESTALE, ETIMEDOUT, EHOSTUNREACH, ENETUNREACH};
  return std::find(kTemporary.begin(), kTemporary.end(), system_error) != kTemporary.end();
}

}  // namespace

ExitCode exit_code(const Error& error) noexcept {
  switch (error.code()) {
    case ErrorCode::kInvalidArgument:
      return kUsage;
    case ErrorCode::kInvalidFrame:
    case ErrorCode::kUnsupported:
      return kUnusableInput;
    case ErrorCode::kIo:
      return is_temporary(error.system_error()) ? kTryAgain : kIoFailure;
    case ErrorCode::kCancelled:
      return kCancelledByUser;
  }
  return kOtherFailure;
}

Failure current_failure() {
  try {
    throw;
  } catch (const Failure& failure) {
    return failure;
  } catch (const Error& error) {
    return {exit_code(error), error.code() == ErrorCode::kCancelled ? "cancelled" : error.what()};
  } catch (const std::bad_alloc&) {
    return {kTryAgain, "out of memory"};
  } catch (const std::exception& error) {
    return {kOtherFailure, error.what()};
  }
}

}  // namespace stein::cli
