// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "layer_picture.hpp"
#include "metrics/metrics.hpp"
#include "output_file.hpp"
#include "plane_statistics.hpp"
#include "png_file.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"
#include "verbs.hpp"

namespace stein::cli {
namespace {

struct CompareOptions {
  std::string image;
  std::string reference;
  std::string error_picture;
  bool json = false;
};

constexpr const char* kCompareFooter =
    "The second file is the reference. The size and the channels R, G, B must agree.\n"
    "  relative MSE  mean of (a - b)^2 / (b^2 + 0.01)\n"
    "  trimmed       the same without the worst 0.01 % of the pixels\n"
    "  PSNR, SSIM    of the clipped, sRGB-encoded images\n"
    "Where the first file has error.R/G/B, the error that it claims stands next to the true one. The true one\n"
    "includes the reference's own noise; where the reference has variance.R/G/B (of the mean), it is also given\n"
    "without.\n"
    "\n"
    "Examples:\n"
    "  stein compare clean.exr reference.exr\n"
    "  stein compare noisy.exr reference.exr --error-picture error.png --json";

/// Mean over pixels and channels of planes of squared errors: those that the image claims, or the reference's
/// variances.
struct MeanError {
  double mse = 0;
  double rel_mse = 0;
};

/// Besides the true errors; what the files do not have is missing.
struct Known {
  std::optional<MeanError> claim;            ///< the image's own estimate
  std::optional<MeanError> reference_noise;  ///< part of the true errors
};

metrics::Rgb rgb(const exr::NamedPlanes& planes) {
  return {planes.planes[0].view(), planes.planes[1].view(), planes.planes[2].view()};
}

MeanError mean_error(const exr::NamedPlanes& error, const metrics::Rgb& reference) {
  MeanError mean;
  const Plane& first = error.planes[0];
  const double values = 3.0 * first.width() * first.height();
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < first.height(); ++y) {
      for (int x = 0; x < first.width(); ++x) {
        const double squared = error.planes[c].row(y)[x];
        const double truth = reference[c].at(x, y);
        mean.mse += squared / values;
        mean.rel_mse += squared / (truth * truth + 0.01) / values;
      }
    }
  }
  return mean;
}

Known what_is_known(const CompareOptions& options, const metrics::Rgb& reference) {
  Known known;
  if (const auto error = read_if_present(options.image, {"error.R", "error.G", "error.B"})) {
    known.claim = mean_error(*error, reference);
  }
  const auto variance = read_if_present(options.reference, {"variance.R", "variance.G", "variance.B"});
  if (!variance) return known;
  const bool sound = std::all_of(variance->planes.begin(), variance->planes.end(), [](const Plane& plane) {
    const PlaneStatistics values = statistics(plane.view());
    return values.non_finite == 0 && values.minimum >= 0;
  });
  if (sound) {
    known.reference_noise = mean_error(*variance, reference);
  } else {
    std::fprintf(stderr, "stein: warning: %s: variances that are negative or no numbers: its noise is not taken off\n",
                 options.reference.c_str());
  }
  return known;
}

void print_json(const metrics::Comparison& figures, const Known& known) {
  nlohmann::ordered_json json = {{"relative_mse", figures.rel_mse},
                                 {"trimmed_relative_mse", figures.trimmed_rel_mse},
                                 {"mse", figures.mse},
                                 {"psnr", figures.psnr},
                                 {"ssim", figures.ssim}};
  if (known.reference_noise) {
    json["mse_without_reference_noise"] = figures.mse - known.reference_noise->mse;
    json["relative_mse_without_reference_noise"] = figures.rel_mse - known.reference_noise->rel_mse;
  }
  if (known.claim) {
    json["estimated_mse"] = known.claim->mse;
    json["estimated_relative_mse"] = known.claim->rel_mse;
  }
  std::printf("%s\n", json.dump(2).c_str());
}

void print_text(const metrics::Comparison& figures, const Known& known) {
  const auto print_known = [&](double all, double MeanError::*which) {
    if (known.reference_noise) {
      const double noise = (*known.reference_noise).*which;
      std::printf("  true        %.6g without the reference's noise of %.3g\n", all - noise, noise);
    }
    if (known.claim) {
      std::printf("  estimated   %.6g\n", (*known.claim).*which);
    }
  };
  std::printf("relative MSE  %.6g\n", figures.rel_mse);
  std::printf("  trimmed     %.6g\n", figures.trimmed_rel_mse);
  print_known(figures.rel_mse, &MeanError::rel_mse);
  std::printf("MSE           %.6g\n", figures.mse);
  print_known(figures.mse, &MeanError::mse);
  std::printf("PSNR          %.3f dB\n", figures.psnr);
  std::printf("SSIM          %.5f\n", figures.ssim);
}

void check_sizes(const CompareOptions& options, const exr::NamedPlanes& image, const exr::NamedPlanes& reference) {
  const Plane& a = image.planes[0];
  const Plane& b = reference.planes[0];
  if (a.width() != b.width() || a.height() != b.height()) {
    throw Error(ErrorCode::kInvalidFrame, "the images differ in size: " + options.image + " has " +
                                              std::to_string(a.width()) + "x" + std::to_string(a.height()) + " and " +
                                              options.reference + " has " + std::to_string(b.width()) + "x" +
                                              std::to_string(b.height()) + " pixels");
  }
  if (image.data_window != reference.data_window) {
    std::fprintf(stderr, "stein: warning: the data windows have one size but different positions\n");
  }
}

void compare(const CompareOptions& options) {
  if (!options.error_picture.empty()) {
    check_output_path(options.error_picture);
  }
  const exr::NamedPlanes image = exr::read_planes(options.image);
  const exr::NamedPlanes reference = exr::read_planes(options.reference);
  check_sizes(options, image, reference);
  const Known known = what_is_known(options, rgb(reference));
  const metrics::Comparison figures = metrics::compare(rgb(image), rgb(reference));
  if (!options.error_picture.empty()) {
    const Plane map = metrics::relative_error_map(rgb(image), rgb(reference));
    write_png(options.error_picture, scalar_picture(map.view(), std::nullopt));
  }
  options.json ? print_json(figures, known) : print_text(figures, known);
}

}  // namespace

Action add_compare(CLI::App& verb) {
  auto options = std::make_shared<CompareOptions>();
  verb.add_option("A", options->image, "OpenEXR file: the image to judge")->required();
  verb.add_option("B", options->reference, "OpenEXR file: the reference")->required();
  verb.add_option("--error-picture", options->error_picture, "Write the relative error of each pixel as a PNG");
  verb.add_flag("--json", options->json, "Print JSON");
  verb.footer(kCompareFooter);
  return [options] { compare(*options); };
}

}  // namespace stein::cli
