// SPDX-License-Identifier: Apache-2.0
#include "c/boundary.hpp"

#include <array>
#include <cstdio>

namespace stein::c {
namespace {

static_assert(static_cast<int>(ErrorCode::kInvalidArgument) == STEIN_INVALID_ARGUMENT);
static_assert(static_cast<int>(ErrorCode::kInvalidFrame) == STEIN_INVALID_FRAME);
static_assert(static_cast<int>(ErrorCode::kIo) == STEIN_IO);
static_assert(static_cast<int>(ErrorCode::kUnsupported) == STEIN_UNSUPPORTED);
static_assert(static_cast<int>(ErrorCode::kCancelled) == STEIN_CANCELLED);
static_assert(STEIN_VERSION == STEIN_PROJECT_VERSION, "stein.h and the project's version in CMakeLists.txt must agree");

// 2^40: with it the largest image still has offsets that can be computed.
constexpr std::ptrdiff_t kLargestStride = std::ptrdiff_t{1} << 40;

// No std::string: it could fail itself, and its destructor would outlive a library that is unloaded.
thread_local std::array<char, 2048> last_message{};

}  // namespace

stein_status fail(stein_status status, const char* function, const char* message) noexcept {
  std::snprintf(last_message.data(), last_message.size(), "%s: %s", function, message);
  return status;
}

void require_strides(const char* plane, std::ptrdiff_t element, std::ptrdiff_t pixel_stride, std::ptrdiff_t row_stride,
                     int width) {
  const auto require_one = [&](const char* which, std::ptrdiff_t stride) {
    const bool is_less = stride > -element && stride < element;
    if (stride == 0 || (!is_less && stride >= -kLargestStride && stride <= kLargestStride)) return;
    refuse(std::string("plane '") + plane + "': the " + which + " stride is " + std::to_string(stride) + " bytes, " +
           (is_less ? "less than an element of " + std::to_string(element) : "more than any memory") +
           "; strides are in bytes, and 0 means packed");
  };
  require_one("pixel", pixel_stride);
  require_one("row", row_stride != 0 ? row_stride : pixel_stride * width);
}

}  // namespace stein::c

const char* stein_error_message(void) { return stein::c::last_message.data(); }

int32_t stein_version(void) { return STEIN_VERSION; }
