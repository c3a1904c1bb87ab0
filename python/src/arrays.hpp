// SPDX-License-Identifier: Apache-2.0
//
// Arrays of Python as planes and back. Nothing is copied.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>
#include <vector>

#include "stein/plane.hpp"

namespace stein::python {

namespace nb = nanobind;

/// Holds the memory of what was passed in.
using InputArray = nb::ndarray<nb::ro, nb::device::cpu>;

[[noreturn]] void refuse(const std::string& message);

/// One view for each channel of an array of height x width, or height x width x channels (further axes count as
/// channels too, the last one fastest), or of a list of these. The arrays are appended to `owners`.
/// @throws Error kInvalidArgument naming `what` if it is no such thing, or of a type that views cannot have.
[[nodiscard]] std::vector<ConstPlaneView> views_of(nb::handle value, const std::string& what,
                                                   std::vector<InputArray>& owners);

/// The same with `count` views; a single channel stands for all of them. None: no views.
[[nodiscard]] std::vector<ConstPlaneView> views_of(nb::handle value, const std::string& what, std::size_t count,
                                                   std::vector<InputArray>& owners);

/// Arrays of a plane, or of the three of a Plane::triple, that lie in an object whose property they are.
using PlaneArray = nb::ndarray<nb::numpy, float, nb::shape<-1, -1>, nb::device::cpu>;
using ColourArray = nb::ndarray<nb::numpy, float, nb::shape<-1, -1, 3>, nb::device::cpu>;
[[nodiscard]] PlaneArray array_of(Plane& plane);
[[nodiscard]] ColourArray array_of(std::array<Plane, 3>& planes);

/// A view as an array that keeps `owner`.
[[nodiscard]] nb::ndarray<nb::numpy, nb::ro> array_of(const ConstPlaneView& view, nb::handle owner);

}  // namespace stein::python
