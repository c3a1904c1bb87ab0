// SPDX-License-Identifier: Apache-2.0
//
// stein.h comes first and alone, and its names have C linkage.
#include "stein.h"

extern "C" {
stein_status stein_denoise(const stein_frame*, const stein_params*, stein_progress, void*, stein_result**);
}
static_assert(STEIN_VERSION >= 100);
