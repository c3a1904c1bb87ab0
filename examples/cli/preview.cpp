// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "arguments.hpp"
#include "layer_picture.hpp"
#include "output_file.hpp"
#include "png_file.hpp"
#include "stein/error.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

struct PreviewOptions {
  std::string input;
  std::string output;
  std::string layer;
  std::optional<double> exposure;
  std::optional<std::string> range;
};

constexpr const char* kPreviewFooter =
    "Colour layers are exposed, clipped and sRGB-encoded; normals and other vectors become colours; everything else "
    "is\n"
    "shown in false colours with a scale. Values that are not finite, and pixels that were filled, are magenta.\n"
    "\n"
    "Examples:\n"
    "  stein preview clean.exr -o clean.png --exposure 1.5\n"
    "  stein preview clean.exr -o error.png --layer error --range 0,0.01\n"
    "  stein preview noisy.exr -o normal.png --layer normal\n"
    "  stein preview clean.exr -o choice.png --layer choice";

Picture make_picture(const Layer& layer, const PreviewOptions& options) {
  std::optional<ValueRange> range;
  if (options.range) {
    const auto [low, high] = parse_range(*options.range);
    range = ValueRange{low, high};
  }
  const bool is_colour = layer.kind == LayerKind::kColour;
  if (options.exposure && !is_colour) {
    throw Error(ErrorCode::kInvalidArgument, "--exposure: layer '" + options.layer + "' is not a colour; use --range");
  }
  if (range && (is_colour || layer.kind == LayerKind::kChoice)) {
    throw Error(ErrorCode::kInvalidArgument,
                is_colour ? "--range: the layer is a colour; use --exposure" : "--range: a choice has no range");
  }
  switch (layer.kind) {
    case LayerKind::kColour:
      return colour_picture(layer.planes, options.exposure.value_or(0));
    case LayerKind::kVector:
      return vector_picture(layer.planes, range);
    case LayerKind::kChoice:
      return choice_picture(layer.planes.planes[0].view());
    case LayerKind::kScalar:
      break;
  }
  const Plane mean = channel_mean(layer.planes);
  return scalar_picture(mean.view(), range);
}

void preview(const PreviewOptions& options) {
  check_output_path(options.output, options.input);
  write_png(options.output, make_picture(find_layer(options.input, options.layer), options));
}

}  // namespace

Action add_preview(CLI::App& verb) {
  auto options = std::make_shared<PreviewOptions>();
  verb.add_option("FILE", options->input, "OpenEXR file")->required();
  verb.add_option("-o,--output", options->output, "PNG file to write")->required();
  verb.add_option("--layer", options->layer, "Layer or channel, such as albedo, depth, error, R; default: the colour");
  verb.add_option("--exposure", options->exposure, "Stops by which a colour is made brighter");
  verb.add_option("--range", options->range, "LOW,HIGH: the values at the ends of the scale; default: what is there");
  verb.footer(kPreviewFooter);
  return [options] { preview(*options); };
}

}  // namespace stein::cli
