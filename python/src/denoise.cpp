// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <exception>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "frame.hpp"
#include "stein/error.hpp"
#include "stein/options.hpp"

namespace stein::python {
namespace {

/// What the library calls, from any of its threads, with the GIL released. An exception that Python raises cancels.
class Progress {
 public:
  explicit Progress(nb::handle callback) : callback_(callback) {}

  bool operator()(double done) {
    // Signals, such as Ctrl-C, are for the thread that called; others need not wait for the GIL.
    if (callback_.is_none() && std::this_thread::get_id() != caller_) return true;
    const nb::gil_scoped_acquire gil;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (callback_.is_none()) return true;
      const nb::object answer = callback_(done);
      return answer.is_none() || nb::cast<bool>(nb::bool_(answer));
    } catch (const nb::python_error&) {
      raised_ = std::current_exception();
      return false;
    }
  }

  void rethrow() const {
    if (raised_) std::rethrow_exception(raised_);
  }

 private:
  nb::handle callback_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::exception_ptr raised_;
};

/// A function of Python as an external denoiser. What it raises passes through the library.
class PythonDenoiser {
 public:
  PythonDenoiser(std::string name, nb::handle function) : name_(std::move(name)), function_(function) {}

  std::array<Plane, 3> operator()(const Frame& frame) const {
    const nb::gil_scoped_acquire gil;
    const nb::object answer = function_(nb::cast(copy_of(frame)));
    std::vector<InputArray> owners;
    const std::vector<ConstPlaneView> views = views_of(answer, "the image of the candidate '" + name_ + "'", 3, owners);
    if (views.empty()) refuse("the candidate '" + name_ + "' returned no image");
    std::array<Plane, 3> image = Plane::triple(views[0].width(), views[0].height());
    for (std::size_t c = 0; c < 3; ++c) {
      if (views[c].width() != image[c].width() || views[c].height() != image[c].height())
        refuse("the channels that the candidate '" + name_ + "' returned differ in size");
      for (int y = 0; y < image[c].height(); ++y) views[c].read_row(y, 0, image[c].width(), image[c].row(y));
    }
    return image;
  }

 private:
  std::string name_;
  nb::handle function_;  // held by the call's arguments
};

std::vector<ExternalCandidate> candidates_of(const nb::dict& candidates) {
  std::vector<ExternalCandidate> list;
  for (const auto [key, value] : candidates) {
    const auto name = nb::cast<std::string>(key);
    const nb::tuple parts = nb::isinstance<nb::tuple>(value) ? nb::borrow<nb::tuple>(value) : nb::make_tuple(value);
    ExternalDenoiser denoiser;
    if (parts.size() < 1 || parts.size() > 2 || !nb::isinstance<nb::callable>(parts[0]) ||
        (parts.size() == 2 && !nb::try_cast(nb::handle(parts[1]), denoiser.draws))) {
      refuse("the candidate '" + name + "' is neither a function nor (function, draws)");
    }
    denoiser.run = PythonDenoiser(name, nb::handle(parts[0]));
    list.push_back({name, denoiser});
  }
  return list;
}

constexpr const char* kQuality = "quality";

std::string list_text(nb::handle numbers) {
  std::string text;
  for (const nb::handle number : numbers)
    text += (text.empty() ? "" : ",") + std::string(nb::str(nb::float_(number)).c_str());
  return text;
}

void set_option(DenoiseParams& params, const std::string& name, nb::handle value) {
  double number = 0;
  if (nb::isinstance<nb::str>(value)) {
    stein::set_option(params, name, nb::cast<std::string>(value));
  } else if (nb::try_cast(value, number)) {
    stein::set_option(params, name, number);
  } else if (nb::isinstance<nb::sequence>(value)) {
    stein::set_option(params, name, list_text(value));
  } else {
    refuse(name + " is neither a text, a number nor a list of numbers");
  }
}

DenoiseParams params_of(const Frame& frame, const std::string& filter, const nb::dict& feature_sigmas,
                        const nb::dict& options) {
  DenoiseParams params;
  params.filters = make_filters(filter);
  if (options.contains(kQuality)) {
    if (filter != "auto") refuse("quality chooses the filters of auto; leave out filter, or quality");
    set_option(params, kQuality, options[kQuality]);  // before all others, since it resets the filters
  }
  for (const auto [name, sigma] : feature_sigmas) {
    const auto feature = nb::cast<std::string>(name);
    require_feature(frame, feature);
    set_option(params, "feature-sigma." + feature, sigma);
  }
  for (const auto [key, value] : options) {
    auto name = nb::cast<std::string>(key);
    std::replace(name.begin(), name.end(), '_', '-');
    if (name != kQuality) set_option(params, name, value);
  }
  return params;
}

OutputFrame run(const InputFrame& input, const std::string& filter, const nb::dict& feature_sigmas,
                const nb::dict& options, const nb::dict& candidates, nb::handle callback) {
  DenoiseParams params = params_of(input.frame, filter, feature_sigmas, options);
  params.candidates = candidates_of(candidates);
#ifdef STEIN_PYTHON_EXR
  if (input.file) params.luminance_weights = input.file->luminance_weights();
#endif
  OutputFrame output{{}, filter, {}};
  for (const Feature& feature : input.frame.features) output.features.push_back(feature.name);
  Progress progress(callback);
  params.execution.progress = [&progress](double done) { return progress(done); };
  std::exception_ptr failure;
  {
    const nb::gil_scoped_release released;
    try {
      output.result = denoise(input.frame, params);
    } catch (...) {
      failure = std::current_exception();
    }
  }
  progress.rethrow();
  if (failure) std::rethrow_exception(failure);
  return output;
}

template <class Value>
nb::dict by_name(const std::vector<std::string>& names, const std::vector<Value>& values) {
  nb::dict dict;
  for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) dict[names[i].c_str()] = values[i];
  return dict;
}

nb::dict report_of(const OutputFrame& output) {
  const DenoiseReport& report = output.result.report;
  nb::dict seconds;
  for (const StageSeconds& stage : report.stages) seconds[stage.name.c_str()] = stage.seconds;
  nb::dict dict;
  dict["filter"] = output.filter;
  nb::list filters;
  for (const FilterShare& share : report.filters) {
    nb::dict entry;
    entry["name"] = share.name;
    entry["weight"] = share.weight;
    entry["mean_relative_error"] = share.mean_relative_error;
    entry["risk"] = share.risk;
    entry["risk_reason"] = share.risk_reason;
    filters.append(entry);
  }
  dict["filters"] = filters;
  dict["candidates"] = report.candidates;
  dict["choice_share"] = by_name(report.candidates, report.choice_share);
  dict["mean_error"] = report.mean_error;
  dict["mean_relative_error"] = report.mean_relative_error;
  dict["invalid_pixels"] = report.frame.invalid_pixels;
  dict["single_sample_pixels"] = report.frame.single_sample_pixels;
  dict["bad_feature_pixels"] = by_name(output.features, report.frame.bad_feature_pixels);
  dict["outlier_pixels"] = report.outlier_pixels;
  dict["outlier_energy"] = report.outlier_energy;
  dict["scratch_bytes"] = report.scratch_bytes;
  dict["warnings"] = report.warnings;
  dict["seconds"] = seconds;
  dict["instruction_set"] = report.instruction_set;
  return dict;
}

}  // namespace

void bind_denoise(nb::module_& module) {
  nb::class_<OutputFrame>(module, "Result",
                          "What denoising gives. The arrays are memory of the result, which they keep.")
      .def_prop_ro("colour", [](OutputFrame& o) { return array_of(o.result.colour); })
      .def_prop_ro(
          "error", [](OutputFrame& o) { return array_of(o.result.error); },
          "Squared error that is estimated to remain in each channel; >= 0")
      .def_prop_ro(
          "choice", [](OutputFrame& o) { return array_of(o.result.choice); },
          "Index of the candidate that weighs most; 0 is the unfiltered input")
      .def_prop_ro(
          "density", [](OutputFrame& o) { return array_of(o.result.density); }, "Where samples are worth most; mean 1")
      .def_prop_ro("report", report_of, nb::sig("def report(self) -> stein._types.Report"));
  module.def("denoise", run, nb::arg("frame"), nb::arg("filter"), nb::arg("feature_sigmas"), nb::arg("options"),
             nb::arg("candidates"), nb::arg("progress").none(),
             nb::sig("def denoise(frame: Frame, filter: str, feature_sigmas: dict[str, float], "
                     "options: dict[str, typing.Any], candidates: dict[str, stein._types.Candidate], progress: "
                     "collections.abc.Callable[[float], bool | None] | None) "
                     "-> Result"));
  module.def(
      "filter_names",
      [] {
        std::vector<std::string> names;
        for (const std::string_view name : filter_names()) names.emplace_back(name);
        return names;
      },
      "The filters there are");
}

}  // namespace stein::python
