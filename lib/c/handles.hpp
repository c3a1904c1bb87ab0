// SPDX-License-Identifier: Apache-2.0
//
// What is behind the handles of stein.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stein.h"
#include "stein/accumulate.hpp"
#include "stein/denoise.hpp"
#include "stein/frame.hpp"

struct stein_frame {
  stein::Frame slots;                    // features have views, absent ones too, for all planes that can be set
  std::optional<stein::Moments> memory;  // of a film's snapshot
};

struct stein_params {
  stein::DenoiseParams values;
  std::vector<std::string> guiding;  // features that were given a sigma; the frame must have them
};

struct stein_result {
  stein::DenoiseResult value;
};

struct stein_film {
  stein::Accumulator value;
};

namespace stein::c {

/// The frame without the slots that nothing was put in. @throws Error kInvalidArgument for null
[[nodiscard]] Frame frame_of(const stein_frame* handle);

/// Gives a feature of a handle's frame all views that it can have.
void make_slots(Feature& feature);

}  // namespace stein::c
