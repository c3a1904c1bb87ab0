// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "stein/denoise.hpp"
#ifdef STEIN_PYTHON_EXR
#include "stein/exr.hpp"
#endif

namespace stein::python {

/// What is behind stein.Frame: views, and the memory they look at.
struct InputFrame {
  Frame frame;
  std::vector<InputArray> arrays;
  std::vector<Plane> planes;  // of a frame that the library made
#ifdef STEIN_PYTHON_EXR
  std::optional<exr::LoadedFrame> file;
#endif
};

/// What is behind stein.Result.
struct OutputFrame {
  DenoiseResult result;
  std::string filter;
  std::vector<std::string> features;
};

/// With memory of its own, so that it can outlive `frame`.
[[nodiscard]] InputFrame copy_of(const Frame& frame);

void bind_frame(nb::module_& module);
void bind_denoise(nb::module_& module);
#ifdef STEIN_PYTHON_EXR
void bind_exr(nb::module_& module);
#endif

}  // namespace stein::python
