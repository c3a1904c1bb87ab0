// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <memory>
#include <string>

#include "c/boundary.hpp"
#include "c/handles.hpp"
#include "stein/options.hpp"

using stein::c::frame_of;
using stein::c::guarded_make;

stein_status stein_denoise(const stein_frame* frame, const stein_params* params, stein_progress progress, void* user,
                           stein_result** result) {
  return guarded_make("stein_denoise", result, [&] {
    const stein::Frame input = frame_of(frame);
    stein::DenoiseParams values;
    if (params != nullptr) {
      for (const std::string& feature : params->guiding) stein::require_feature(input, feature);
      values = params->values;
    }
    if (progress != nullptr)
      values.execution.progress = [progress, user](double done) { return progress(done, user) != 0; };
    return std::make_unique<stein_result>(stein_result{stein::denoise(input, values)}).release();
  });
}

void stein_result_destroy(stein_result* result) { delete result; }
