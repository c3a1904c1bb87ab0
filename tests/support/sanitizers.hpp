// SPDX-License-Identifier: Apache-2.0
//
// STEIN_HAS_TSAN, STEIN_HAS_ASAN: whether the tests run under these, which takes ten times as long.
#pragma once

#ifdef __has_feature
#define STEIN_HAS_TSAN __has_feature(thread_sanitizer)
#define STEIN_HAS_ASAN __has_feature(address_sanitizer)
#else
#ifdef __SANITIZE_THREAD__
#define STEIN_HAS_TSAN 1
#else
#define STEIN_HAS_TSAN 0
#endif
#ifdef __SANITIZE_ADDRESS__
#define STEIN_HAS_ASAN 1
#else
#define STEIN_HAS_ASAN 0
#endif
#endif
