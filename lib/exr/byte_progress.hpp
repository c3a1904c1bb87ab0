// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>

#include "stein/error.hpp"

namespace stein::exr {

/// Progress and cancelling of work that reads files of a known size, by the bytes read.
class ByteProgress {
 public:
  /// `callback` may be empty; returning false cancels.
  explicit ByteProgress(std::function<bool(double)> callback) : callback_(std::move(callback)) {}

  void expect(std::int64_t bytes) { expected_ += bytes; }

  /// Adds bytes, or none, to be asked whether to go on. @throws Error kCancelled, once: what cleans up then may go on.
  void advance(std::int64_t bytes) {
    done_ += bytes;
    if (!callback_ || cancelled_) return;
    const double fraction = static_cast<double>(done_) / static_cast<double>(std::max<std::int64_t>(expected_, 1));
    if (callback_(std::min(fraction, 1.0))) return;
    cancelled_ = true;
    throw Error(ErrorCode::kCancelled, "cancelled by the progress callback");
  }

 private:
  std::function<bool(double)> callback_;
  std::int64_t expected_ = 0;
  std::int64_t done_ = 0;
  bool cancelled_ = false;
};

}  // namespace stein::exr
