// SPDX-License-Identifier: Apache-2.0
#include "stein/exr.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "frame.hpp"
#include "stein/error.hpp"

namespace stein::python {
namespace {

using Names = std::vector<std::string>;

exr::VarianceOf variance_of(const std::optional<std::string>& word) {
  if (!word) return exr::VarianceOf::kAsStated;
  if (*word == "mean") return exr::VarianceOf::kMean;
  if (*word == "sample") return exr::VarianceOf::kSample;
  if (*word == "m2") return exr::VarianceOf::kSecondMoment;
  refuse("variance_of is '" + *word + "'; it can be: mean, sample, m2");
}

// The names of the mean's channels, or those and the names of the variance's.
exr::PlaneMap map_of(const std::string& plane, nb::handle value) {
  exr::PlaneMap map{plane, {}, {}};
  std::pair<Names, Names> both;
  if (nb::isinstance<nb::tuple>(value) ? nb::try_cast(value, both) : nb::try_cast(value, both.first)) {
    map.mean = std::move(both.first);
    map.variance = std::move(both.second);
    return map;
  }
  refuse("the map of '" + plane + "' is neither a list of channels nor (list of channels, list of their variances)");
}

InputFrame read(const std::filesystem::path& path, float samples, bool covariances, const std::string& preset,
                const nb::dict& maps, const std::optional<std::string>& variances) {
  exr::ReadOptions options{.samples_per_pixel = samples, .read_covariances = covariances, .preset = preset};
  for (const auto [plane, value] : maps) options.maps.push_back(map_of(nb::cast<std::string>(plane), value));
  options.variance_of = variance_of(variances);
  InputFrame input;
  const nb::gil_scoped_release released;
  input.file = exr::read_frame(path.string(), options);
  input.frame = input.file->frame();
  return input;
}

std::vector<std::pair<std::string, ConstPlaneView>> planes_of(const DenoiseResult& result,
                                                              const exr::WriteOptions& options) {
  std::vector<std::pair<std::string, ConstPlaneView>> planes;
  const auto add_three = [&](const std::string& prefix, const std::array<Plane, 3>& three) {
    constexpr std::array<const char*, 3> kChannels = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) planes.emplace_back(prefix + kChannels.at(c), three.at(c).view());
  };
  add_three("", result.colour);
  if (options.error) add_three("error.", result.error);
  if (options.choice) planes.emplace_back("choice.V", result.choice.view());
  if (options.density) planes.emplace_back("density.V", result.density.view());
  return planes;
}

void write(const std::filesystem::path& path, const OutputFrame& output, const InputFrame* frame,
           const exr::WriteOptions& options) {
  const bool has_file = frame != nullptr && frame->file;
  if (!has_file && (options.noisy || options.inputs || options.half_colour))
    refuse("noisy, inputs and half need the frame, from stein.read");
  const nb::gil_scoped_release released;
  if (has_file) {
    exr::write_result(path.string(), *frame->file, output.result, options);
  } else {
    exr::write_planes(path.string(), planes_of(output.result, options));
  }
}

void write_frame(const std::filesystem::path& path, const InputFrame& input) {
  const nb::gil_scoped_release released;
  const Frame& frame = input.frame;
  if (input.file) return exr::write_frame(path.string(), frame, *input.file);
  if (frame.degrees_of_freedom != 0)
    throw Error(ErrorCode::kUnsupported,
                "a frame with degrees of freedom of its own can be written only where it was read from a file");
  std::vector<std::pair<std::string, ConstPlaneView>> planes = named_planes(frame);
  Plane counts;
  if (!frame.sample_count) {
    counts = Plane(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y) std::fill_n(counts.row(y), frame.width, frame.uniform_sample_count);
    planes.emplace_back("sampleCount", std::as_const(counts).view());
  }
  exr::write_planes(path.string(), planes);
}

}  // namespace

void bind_exr(nb::module_& module) {
  module.def(
      "read", read, nb::arg("path"), nb::kw_only(), nb::arg("samples") = 0.0F, nb::arg("covariances") = true,
      nb::arg("preset") = "", nb::arg("maps") = nb::dict(), nb::arg("variance_of") = nb::none(),
      "Reads a frame from an OpenEXR file. docs/inputs.md says which there can be.\n\n"
      "samples: per pixel, for files that do not say.\n"
      "preset: whose names the channels bear, such as 'pbrt'; left out, it is found by the names.\n"
      "maps: channels of planes, whatever the preset says: {'albedo': ['D.R', 'D.G', 'D.B']}, or with the channels of\n"
      "the variance, {'albedo': (['D.R', 'D.G', 'D.B'], ['V.R', 'V.G', 'V.B'])}.\n"
      "variance_of: what all variances of the file are, against the preset: 'mean', 'sample' or 'm2'.",
      nb::sig("def read(path: str | os.PathLike[str], *, samples: float = 0.0, covariances: bool = True, "
              "preset: str = '', maps: collections.abc.Mapping[str, stein._types.Channels] = {}, "
              "variance_of: typing.Literal['mean', 'sample', 'm2'] | None = None) -> Frame"));
  module.def(
      "write",
      [](const std::filesystem::path& path, const OutputFrame& result, const InputFrame* frame, bool error, bool choice,
         bool density, bool noisy, bool inputs, bool half) {
        write(path, result, frame, {error, choice, density, noisy, inputs, half});
      },
      nb::arg("path"), nb::arg("result"), nb::arg("frame").none() = nb::none(), nb::kw_only(), nb::arg("error") = true,
      nb::arg("choice") = true, nb::arg("density") = true, nb::arg("noisy") = false, nb::arg("inputs") = false,
      nb::arg("half") = false,
      "Writes a result to an OpenEXR file, whole or not at all.\n\n"
      "frame: where it was read from a file, everything else of that file is carried over, and there can be as well:\n"
      "noisy, the input's colour; inputs, the planes that describe its noise; half, the colour as half.",
      nb::sig("def write(path: str | os.PathLike[str], result: Result, frame: Frame | None = None, *, "
              "error: bool = True, choice: bool = True, density: bool = True, noisy: bool = False, "
              "inputs: bool = False, half: bool = False) -> None"));
  module.def("write_frame", write_frame, nb::arg("path"), nb::arg("frame"),
             "Writes a frame to an OpenEXR file, in the schema that stein.read and the program read.",
             nb::sig("def write_frame(path: str | os.PathLike[str], frame: Frame) -> None"));
}

}  // namespace stein::python
