// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hwy/targets.h>

#include <cstdint>
#include <set>
#include <string>

#include "catch.hpp"
#include "kernels/guides.hpp"

namespace stein::kernels {

// Calls body() once per instruction set of this machine that the kernels are compiled for; returns their names.
template <class Body>
std::set<std::string> for_each_instruction_set(Body body) {
  std::set<std::string> names;
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    const std::string name = instruction_set();
    if (name == hwy::TargetName(targets & -targets)) {
      names.insert(name);
      INFO(name);
      body();
    }
    hwy::SetSupportedTargetsForTest(0);
  }
  return names;
}

}  // namespace stein::kernels
