// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>

#include <exception>

#include "frame.hpp"
#include "stein/error.hpp"

namespace nb = nanobind;

namespace {

// stein::Error as the exception of its code, of stein/_errors.py.
void translate(const std::exception_ptr& thrown, void* /*payload*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (const stein::Error& error) {
    const nb::object type = nb::module_::import_("stein._errors").attr("of_code")(static_cast<int>(error.code()));
    PyErr_SetString(type.ptr(), error.what());
  }
}

}  // namespace

NB_MODULE(_stein, module) {
  module.attr("version") = STEIN_VERSION_TEXT;
  nb::register_exception_translator(translate);
  stein::python::bind_frame(module);
  stein::python::bind_denoise(module);
#ifdef STEIN_PYTHON_EXR
  stein::python::bind_exr(module);
#endif
}
