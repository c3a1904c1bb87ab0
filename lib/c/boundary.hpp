// SPDX-License-Identifier: Apache-2.0
//
// Where exceptions end: what every function of stein.h that can fail runs in.
#pragma once

#include <cstddef>
#include <exception>
#include <new>
#include <string>

#include "stein.h"
#include "stein/error.hpp"

namespace stein::c {

/// Keeps a message for stein_error_message() of this thread. @returns status
stein_status fail(stein_status status, const char* function, const char* message) noexcept;

/// Runs body() and makes a status of what it throws.
template <class Body>
stein_status guarded(const char* function, const Body& body) noexcept {
  try {
    body();
    return STEIN_OK;
  } catch (const Error& error) {
    return fail(static_cast<stein_status>(error.code()), function, error.what());
  } catch (const std::bad_alloc&) {
    return fail(STEIN_OUT_OF_MEMORY, function, "out of memory");
  } catch (const std::exception& error) {
    return fail(STEIN_INTERNAL, function, error.what());
  } catch (...) {
    return fail(STEIN_INTERNAL, function, "an exception that is not of the standard library");
  }
}

/// The same for functions that make a handle: *made is what make() returns, or null.
template <class Handle, class Make>
stein_status guarded_make(const char* function, Handle** made, const Make& make) noexcept {
  if (made == nullptr) return fail(STEIN_INVALID_ARGUMENT, function, "the address for the new handle is null");
  *made = nullptr;
  return guarded(function, [&] { *made = make(); });
}

[[noreturn]] inline void refuse(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

template <class T>
void require(const T* pointer, const char* what) {
  if (pointer == nullptr) refuse(std::string(what) + " is null");
}

/// Planes are found by what a dot separates. @throws Error kInvalidArgument for a feature's name with a dot
inline void require_no_dot(const std::string& name) {
  if (name.find('.') != std::string::npos) refuse("the feature '" + name + "' has a dot in its name; leave it out");
}

/// @throws Error kInvalidArgument where a stride cannot be right. 0 means packed.
void require_strides(const char* plane, std::ptrdiff_t element, std::ptrdiff_t pixel_stride, std::ptrdiff_t row_stride,
                     int width);

}  // namespace stein::c
