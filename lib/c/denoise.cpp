// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <algorithm>
#include <memory>
#include <string>

#include "c/boundary.hpp"
#include "c/handles.hpp"

namespace stein::c {
namespace {

// An option that nothing in the frame answers to would be ignored.
void require_guides(const stein_params& params, const Frame& frame) {
  for (const std::string& name : params.guiding) {
    std::string names;
    for (const Feature& feature : frame.features) names += " " + feature.name;
    if (std::none_of(frame.features.begin(), frame.features.end(), [&](const Feature& f) { return f.name == name; }))
      refuse("feature-sigma: the frame has no feature '" + name + "'; it has:" + (names.empty() ? " none" : names));
  }
}

}  // namespace
}  // namespace stein::c

using stein::c::frame_of;
using stein::c::guarded_make;
using stein::c::require_guides;

stein_status stein_denoise(const stein_frame* frame, const stein_params* params, stein_progress progress, void* user,
                           stein_result** result) {
  return guarded_make("stein_denoise", result, [&] {
    const stein::Frame input = frame_of(frame);
    stein::DenoiseParams values;
    if (params != nullptr) {
      require_guides(*params, input);
      values = params->values;
    }
    if (progress != nullptr)
      values.execution.progress = [progress, user](double done) { return progress(done, user) != 0; };
    return std::make_unique<stein_result>(stein_result{stein::denoise(input, values)}).release();
  });
}

void stein_result_destroy(stein_result* result) { delete result; }
