// SPDX-License-Identifier: Apache-2.0
//
// Errors on a folder of renders: FOLDER/<scene>/{*.exr, ref.exr}. Prints the Markdown tables of docs/quality.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "metrics/metrics.hpp"
#include "quality/bank.hpp"
#include "quality/reliability.hpp"
#include "stein/denoise.hpp"
#include "stein/error.hpp"
#include "stein/exr.hpp"
#include "stein/options.hpp"

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

void print_errors(const fs::path& file, const stein::DenoiseParams& params) {
  const stein::exr::NamedPlanes reference = stein::exr::read_planes((file.parent_path() / "ref.exr").string());
  const stein::exr::LoadedFrame loaded = stein::exr::read_frame(file.string());
  const stein::DenoiseResult result = stein::denoise(loaded.frame(), params);
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

std::string title(const fs::path& file) { return file.parent_path().filename().string() + " " + file.stem().string(); }

// Estimated over true mean error of every entry as a fixed filter.
void print_risks(const fs::path& file, const stein::DenoiseParams& params) {
  const stein::quality::Bank bank(file.string(), params);
  const std::vector<std::string> names = stein::candidate_names(params.filters.front());
  for (int e = 1; e < bank.entries(); ++e) {
    const stein::quality::EntryErrors errors = bank.errors(e);
    std::printf("| %s | %s | %.5g / %.5g | %.2f | %.5f / %.5f | %.2f | %.2f |\n", title(file).c_str(),
                names[static_cast<std::size_t>(e)].c_str(), errors.estimated, errors.truth,
                errors.estimated / errors.truth, errors.estimated_relative, errors.true_relative,
                errors.estimated_relative / errors.true_relative, errors.trimmed_ratio);
  }
  std::fflush(stdout);
}

void print_choices(const fs::path& file, const stein::DenoiseParams& params, std::vector<double>& log_sums) {
  const stein::quality::Bank bank(file.string(), params);
  const stein::quality::Choices choices = bank.choices();
  const double values[] = {choices.best_single, choices.argmin, choices.evidence, choices.oracle};
  std::printf("| %s |", title(file).c_str());
  for (std::size_t i = 0; i < 4; ++i) {
    std::printf(" %.5f |", values[i]);
    log_sums[i] += std::log(values[i]);
  }
  std::printf("\n");
  std::fflush(stdout);
}

// What a run reports against the truth: the image, then pixels by what is reported of them.
void print_calibration(const fs::path& file, const stein::DenoiseParams& params) {
  const stein::exr::NamedPlanes reference = stein::exr::read_planes((file.parent_path() / "ref.exr").string());
  const stein::exr::LoadedFrame loaded = stein::exr::read_frame(file.string());
  const stein::DenoiseResult result = stein::denoise(loaded.frame(), params);
  const double noise = reference_noise(file.parent_path()).rel_mse;
  const std::array<stein::Plane, 3>& colour = result.colour;
  const double truth =
      stein::metrics::compare({colour[0].view(), colour[1].view(), colour[2].view()}, rgb(reference.planes)).rel_mse -
      noise;
  const double reported = result.report.mean_relative_error;
  std::printf("| %s | all | 100 | %.5f | %.5f | %.2f |\n", title(file).c_str(), reported, truth, reported / truth);
  for (const stein::quality::ReliabilityBin& bin : stein::quality::reliability(result, reference, noise)) {
    if (bin.share == 0) continue;
    std::printf("| %s | %.2g to %.2g | %.2f | %.3g | %.3g | %.2f |\n", title(file).c_str(), bin.lower, bin.upper,
                100.0 * bin.share, bin.reported, bin.truth, bin.reported / bin.truth);
  }
  std::fflush(stdout);
}

int usage() {
  std::fprintf(stderr,
               "usage: stein_quality FOLDER [--filter NAME | --quality NAME] [--risk NAME]\n"
               "                     [--table errors|risk|selection|calibration]\n"
               "FOLDER holds one folder per scene with ref.exr and noisy renders.\n");
  return 2;
}

void print_table(const std::string& table, const std::vector<fs::path>& files, const stein::DenoiseParams& params) {
  if (table == "errors") {
    std::printf(
        "| scene, file | input relMSE / SSIM | stein relMSE / SSIM | trimmed relMSE | estimated MSE | true MSE |\n"
        "|---|---|---|---|---|---|\n");
    for (const fs::path& file : files) print_errors(file, params);
  } else if (table == "calibration") {
    std::printf(
        "| scene, file | reported relative error | %% of the pixels | reported, mean | true, mean | ratio |\n"
        "|---|---|---|---|---|---|\n");
    for (const fs::path& file : files) print_calibration(file, params);
  } else if (table == "risk") {
    std::printf(
        "| scene, file | entry | estimated / true MSE | ratio | relative | ratio | trimmed "
        "|\n|---|---|---|---|---|---|---|\n");
    for (const fs::path& file : files) print_risks(file, params);
  } else {
    std::vector<double> log_sums(4, 0.0);
    std::printf("| scene, file | best single entry | argmin | evidence | oracle |\n|---|---|---|---|---|\n");
    for (const fs::path& file : files) print_choices(file, params, log_sums);
    std::printf("| geometric mean |");
    for (const double sum : log_sums) std::printf(" %.5f |", std::exp(sum / static_cast<double>(files.size())));
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  std::string table = "errors";
  stein::DenoiseParams params;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string argument = argv[i];
      if (argument == "--filter" && i + 1 < argc) {
        params.filters = stein::make_filters(argv[++i]);
      } else if (argument == "--quality" && i + 1 < argc) {
        stein::set_option(params, "quality", argv[++i]);
      } else if (argument == "--risk" && i + 1 < argc) {
        stein::set_option(params, "risk", argv[++i]);
      } else if (argument == "--table" && i + 1 < argc) {
        table = argv[++i];
      } else if (folder.empty() && argument.rfind("--", 0) != 0) {
        folder = argument;
      } else {
        return usage();
      }
    }
    const std::vector<std::string> tables = {"errors", "risk", "selection", "calibration"};
    if (folder.empty() || std::find(tables.begin(), tables.end(), table) == tables.end()) return usage();
    print_table(table, noisy_files(folder), params);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stein_quality: %s\n", error.what());
    return 1;
  }
  return 0;
}
