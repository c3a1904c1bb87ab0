// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <new>
#include <string>
#include <utility>

namespace stein::python {
namespace {

using Arrays = std::vector<InputArray>;

std::array<ConstPlaneView, 3> three_of(nb::handle value, const std::string& what, Arrays& arrays) {
  const std::vector<ConstPlaneView> views = views_of(value, what, 3, arrays);
  std::array<ConstPlaneView, 3> three;
  std::copy(views.begin(), views.end(), three.begin());
  return three;
}

// (mean, variance, covariance), of which the last ones can be missing, or the mean alone.
Feature feature_of(const std::string& name, nb::handle value, Arrays& arrays) {
  const nb::tuple parts = nb::isinstance<nb::tuple>(value) ? nb::borrow<nb::tuple>(value) : nb::make_tuple(value);
  if (parts.size() < 1 || parts.size() > 3)
    refuse("the feature '" + name + "' has " + std::to_string(parts.size()) +
           " parts; give (mean, variance, covariance), the last ones may be missing");
  const std::string what = "the feature '" + name + "'";
  Feature feature;
  feature.name = name;
  feature.mean = views_of(parts[0], what, arrays);
  const std::size_t channels = feature.mean.size();
  if (parts.size() > 1) feature.variance = views_of(parts[1], "the variance of " + what, channels, arrays);
  if (parts.size() > 2)
    feature.colour_covariance = views_of(parts[2], "the covariance of " + what, 3 * channels, arrays);
  return feature;
}

void set_samples(Frame& frame, nb::handle value, Arrays& arrays) {
  if (value.is_none()) refuse("samples is missing: the number of samples of each pixel, a number or an array");
  if (nb::hasattr(value, "__len__")) {
    frame.sample_count = views_of(value, "samples", 1, arrays).at(0);
  } else if (!nb::try_cast(value, frame.uniform_sample_count)) {
    refuse("samples is neither a number nor an array");
  }
}

void make_frame(InputFrame* self, nb::handle colour, nb::handle variance, const nb::dict& features,
                nb::handle covariance, nb::handle samples, float degrees_of_freedom) {
  InputFrame made;
  Frame& frame = made.frame;
  Arrays& arrays = made.arrays;
  frame.colour = three_of(colour, "colour", arrays);
  frame.width = frame.colour[0].width();
  frame.height = frame.colour[0].height();
  frame.colour_variance = three_of(variance, "variance", arrays);
  frame.colour_covariance = three_of(covariance, "covariance", arrays);
  for (const auto [name, value] : features)
    frame.features.push_back(feature_of(nb::cast<std::string>(name), value, arrays));
  set_samples(frame, samples, arrays);
  frame.degrees_of_freedom = degrees_of_freedom;
  check(frame);
  new (self) InputFrame(std::move(made));
}

nb::dict planes_of(nb::handle_t<InputFrame> self) {
  nb::dict planes;
  for (const auto& [name, view] : named_planes(nb::cast<const InputFrame&>(self).frame))
    planes[name.c_str()] = array_of(view, self);
  return planes;
}

std::vector<std::string> feature_names(const InputFrame& input) {
  std::vector<std::string> names;
  for (const Feature& feature : input.frame.features) names.push_back(feature.name);
  return names;
}

// What is taken for granted or missing, in words.
std::vector<std::string> notes_of([[maybe_unused]] const InputFrame& input) {
  std::vector<std::string> notes;
#ifdef STEIN_PYTHON_EXR
  if (input.file) {
    notes = input.file->missing();
    notes.insert(notes.end(), input.file->assumptions().begin(), input.file->assumptions().end());
  }
#endif
  return notes;
}

constexpr const char* kDoc =
    "One noisy image with all that is known of its noise: views of arrays, which must stay as they are while it is\n"
    "denoised. Arrays are height x width x channels, or height x width, of float32, float16 or uint32, with any\n"
    "strides; or lists of these. One channel stands for all three.\n\n"
    "colour: mean of each pixel's samples, linear. variance: of that mean.\n"
    "features: by name, such as 'albedo', 'normal', 'depth': the mean, or (mean, variance), or (mean, variance,\n"
    "covariance with the colour: height x width x 3 x channels).\n"
    "covariance: of the colour's means, R with G, R with B, G with B.\n"
    "samples: of each pixel, a number or an array.\n"
    "degrees_of_freedom: of the variances, where they do not come from single samples: K - 1 for the spread of K\n"
    "renders.";

// A float copy in memory of the frame.
ConstPlaneView owned(const ConstPlaneView& view, InputFrame& frame) {
  if (!view) return {};
  Plane plane(view.width(), view.height());
  for (int y = 0; y < view.height(); ++y) view.read_row(y, 0, view.width(), plane.row(y));
  frame.planes.push_back(std::move(plane));
  return std::as_const(frame.planes.back()).view();
}

}  // namespace

InputFrame copy_of(const Frame& frame) {
  InputFrame copy;
  copy.frame = frame;
  const auto own = [&copy](auto& views) {
    for (ConstPlaneView& view : views) view = owned(view, copy);
  };
  own(copy.frame.colour);
  own(copy.frame.colour_variance);
  own(copy.frame.colour_covariance);
  copy.frame.sample_count = owned(frame.sample_count, copy);
  for (Feature& feature : copy.frame.features) {
    own(feature.mean);
    own(feature.variance);
    own(feature.colour_covariance);
  }
  for (Layer& layer : copy.frame.layers) own(layer.mean);
  return copy;
}

void bind_frame(nb::module_& module) {
  nb::class_<InputFrame>(module, "Frame", kDoc)
      .def("__init__", make_frame, nb::arg("colour"), nb::arg("variance").none(), nb::kw_only(),
           nb::arg("features") = nb::dict(), nb::arg("covariance") = nb::none(), nb::arg("samples") = nb::none(),
           nb::arg("degrees_of_freedom") = 0.0F,
           nb::sig("def __init__(self, colour: stein._types.Planes, variance: stein._types.Planes | None, *, "
                   "features: collections.abc.Mapping[str, stein._types.FeaturePlanes] = {}, "
                   "covariance: stein._types.Planes | None = None, "
                   "samples: float | numpy.typing.NDArray[typing.Any] | None = None, "
                   "degrees_of_freedom: float = 0.0) -> None"))
      .def_prop_ro("width", [](const InputFrame& input) { return input.frame.width; })
      .def_prop_ro("height", [](const InputFrame& input) { return input.frame.height; })
      .def_prop_ro("features", feature_names, "Names of the features")
      .def_prop_ro("notes", notes_of,
                   "Of a file: what it lacks, and what is taken for granted though it does not say it")
      .def_prop_ro("planes", planes_of, "All planes, under their names in files",
                   nb::sig("def planes(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"));
}

}  // namespace stein::python
