// SPDX-License-Identifier: Apache-2.0
//
// Errors on a folder of renders: FOLDER/<scene>/{*.exr, ref.exr}. Prints the Markdown table of docs/quality.md.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "metrics/metrics.hpp"
#include "stein/denoise.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"

namespace {

namespace fs = std::filesystem;

// The reference's own mean squared error, plain and relative, from FOLDER/<scene>/refnoise where there is one.
struct ReferenceNoise {
  double mse = 0;
  double rel_mse = 0;
};

ReferenceNoise reference_noise(const fs::path& scene) {
  ReferenceNoise noise;
  std::ifstream(scene / "refnoise") >> noise.mse >> noise.rel_mse;
  return noise;
}

std::vector<fs::path> noisy_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& scene : fs::directory_iterator(folder)) {
    if (!fs::exists(scene.path() / "ref.exr")) continue;
    for (const auto& file : fs::directory_iterator(scene.path())) {
      const std::string name = file.path().filename().string();
      if (file.path().extension() == ".exr" && name != "ref.exr" && name.rfind("samples", 0) != 0)
        files.push_back(file.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

stein::metrics::Rgb rgb(const std::vector<stein::Plane>& planes) {
  return {planes[0].view(), planes[1].view(), planes[2].view()};
}

void print_line(const fs::path& file) {
  const stein::exr::NamedPlanes reference = stein::exr::read_planes((file.parent_path() / "ref.exr").string());
  const stein::exr::LoadedFrame loaded = stein::exr::read_frame(file.string());
  const stein::DenoiseResult result = stein::denoise(loaded.frame());
  const std::array<stein::Plane, 3>& colour = result.colour;
  const stein::metrics::Rgb image = {colour[0].view(), colour[1].view(), colour[2].view()};
  const stein::metrics::Comparison before = stein::metrics::compare(loaded.frame().colour, rgb(reference.planes));
  const stein::metrics::Comparison after = stein::metrics::compare(image, rgb(reference.planes));
  const auto& error = result.report.mean_error;
  std::printf("| %s %s | %.5f / %.3f | %.5f / %.3f | %.5f | %.5f | %.5f |\n", file.parent_path().filename().c_str(),
              file.stem().c_str(), before.rel_mse, before.ssim, after.rel_mse, after.ssim, after.trimmed_rel_mse,
              (error[0] + error[1] + error[2]) / 3.0, after.mse - reference_noise(file.parent_path()).mse);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "usage: stein_quality FOLDER\nFOLDER holds one folder per scene with ref.exr and noisy renders.\n");
    return 2;
  }
  try {
    std::printf(
        "| scene, file | input relMSE / SSIM | stein relMSE / SSIM | trimmed relMSE | estimated MSE | true MSE |\n");
    std::printf("|---|---|---|---|---|---|\n");
    for (const fs::path& file : noisy_files(argv[1])) print_line(file);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stein_quality: %s\n", error.what());
    return 1;
  }
  return 0;
}
