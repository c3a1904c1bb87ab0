/* SPDX-License-Identifier: Apache-2.0
 *
 * stein.h comes first and alone, twice, and can be used as C99: with values in constant expressions. */
#include "stein.h"

typedef char version_is_a_constant[STEIN_VERSION >= 100 ? 1 : -1];
typedef char statuses_are_distinct[STEIN_OK == 0 && STEIN_INTERNAL == 7 ? 1 : -1];

#if STEIN_VERSION != 10000 * STEIN_VERSION_MAJOR + 100 * STEIN_VERSION_MINOR + STEIN_VERSION_PATCH
#error "the preprocessor must know the version"
#endif

int stein_header_test(stein_frame* frame, version_is_a_constant* version, statuses_are_distinct* statuses) {
  (void)version;
  (void)statuses;
  return stein_frame_set_sample_count(frame, 8) == STEIN_OK;
}
