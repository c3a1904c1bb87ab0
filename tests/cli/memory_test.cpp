// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.hpp"
#include "exr/fixture.hpp"
#include "program.hpp"
#include "stein/exr_samples.hpp"
#include "synthetic.hpp"

namespace {

nlohmann::json report_in(const std::string& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

constexpr std::int64_t kMiB = std::int64_t{1} << 20;

/// Two samples in each pixel.
void write_samples(const std::string& path, int width, int height) {
  const std::vector<std::string> channels = {"R",
                                             "G",
                                             "B",
                                             "albedo.R",
                                             "albedo.G",
                                             "albedo.B",
                                             "normal.X",
                                             "normal.Y",
                                             "random.light.X",
                                             "random.pixel.X",
                                             "depth.Z",
                                             "normal.Z",
                                             "random.pixel.Y"};
  constexpr std::uint32_t kSamples = 2;
  stein::exr::SampleWriter writer(path, width, height, channels, {{}, false});
  const std::vector<std::uint32_t> counts(static_cast<std::size_t>(width), kSamples);
  std::vector<float> samples(static_cast<std::size_t>(width) * kSamples * channels.size());
  std::uint32_t state = 1;
  for (int y = 0; y < height; ++y) {
    for (float& value : samples) value = static_cast<float>((state = state * 1664525U + 1013904223U) >> 8U) * 0x1p-24F;
    writer.write_row(counts.data(), samples.data());
  }
  writer.finish();
}

}  // namespace

TEST_CASE("denoise --max-memory: less than it takes in memory, and the same file") {
  const TemporaryFolder folder;
  const TemporaryFolder scratch;
  write(folder / "noisy.exr", noisy_image(1300, 1000));
  const auto run = [&](const std::string& out, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"denoise", folder / "noisy.exr",   "-o",        folder / out,
                                          "--json",  folder / "report.json", "--filter",  "gaussian",
                                          "--bank",  "intermediate",         "--threads", "2"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);

    return outcome.out;
  };
  CHECK(run("plain.exr", {}).find("MiB at most\n") != std::string::npos);
  const nlohmann::json plain = report_in(folder / "report.json");
  const std::string text = run("limited.exr", {"--max-memory", "128M", "--scratch", scratch.path().string()});
  const nlohmann::json limited = report_in(folder / "report.json");
  CHECK(text.find("MiB in scratch files\n") != std::string::npos);
  CHECK(plain.at("scratch_bytes") == 0);
  CHECK(limited.at("scratch_bytes") > 80 * kMiB);
  const bool is_same = fixture::bytes_of(folder / "plain.exr") == fixture::bytes_of(folder / "limited.exr");
  CHECK(is_same);  // not in it: the bytes would be printed
  CHECK(scratch.entries() == 0);
#if !defined(STEIN_SANITIZED)  // sanitizers take memory of their own
  CHECK(plain.at("peak_memory_bytes") > 160 * kMiB);
  CHECK(limited.at("peak_memory_bytes") < 128 * kMiB);
#endif
}

TEST_CASE("denoise --max-memory: with images of another denoiser") {
  const TemporaryFolder folder;
  const TemporaryFolder scratch;
  write(folder / "noisy.exr", noisy_image(1000, 900));
  write(folder / "other.exr", flat_image(1000, 900, 0.5F));
  const auto run = [&](const std::string& out, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"denoise",
                                          folder / "noisy.exr",
                                          "-o",
                                          folder / out,
                                          "--candidate",
                                          folder / "other.exr",
                                          "--candidate-perturbed",
                                          folder / "other.exr",
                                          "--json",
                                          folder / "report.json",
                                          "--filter",
                                          "gaussian",
                                          "--bank",
                                          "intermediate",
                                          "--threads",
                                          "2",
                                          "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return report_in(folder / "report.json");
  };
  const nlohmann::json plain = run("plain.exr", {});
  const nlohmann::json limited = run("limited.exr", {"--max-memory", "128M", "--scratch", scratch.path().string()});
  const bool is_same = fixture::bytes_of(folder / "plain.exr") == fixture::bytes_of(folder / "limited.exr");
  CHECK(is_same);
  CHECK(limited.at("scratch_bytes") > 140 * kMiB);  // without those images: 129
  CHECK(scratch.entries() == 0);
#if !defined(STEIN_SANITIZED)
  CHECK(plain.at("peak_memory_bytes") > 160 * kMiB);
  CHECK(limited.at("peak_memory_bytes") < 128 * kMiB);
#endif
}

TEST_CASE("denoise --max-memory: samples for rpf as well") {
#if defined(STEIN_SANITIZED)
  constexpr int kWidth = 100;
#else
  constexpr int kWidth = 3600;
#endif
  const TemporaryFolder folder;
  const TemporaryFolder scratch;
  write_samples(folder / "samples.exr", kWidth, 144);  // as high as the window
  const auto run = [&](const std::string& out, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {
        "denoise", folder / "samples.exr", "-o", folder / out, "--filter", "rpf", "--threads", "2"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return outcome;
  };
  const auto peak_of = [](const Outcome& outcome) {
    return std::stoll(outcome.out.substr(outcome.out.find("\nmemory ") + 8)) * kMiB;
  };
  const Outcome plain = run("plain.exr", {});
  const Outcome limited = run("limited.exr", {"--max-memory", "128M", "--scratch", scratch.path().string()});
  const bool is_same = fixture::bytes_of(folder / "plain.exr") == fixture::bytes_of(folder / "limited.exr");
  CHECK(is_same);
  CHECK(scratch.entries() == 0);
#if !defined(STEIN_SANITIZED)
  CHECK(limited.out.find("MiB in scratch files\n") != std::string::npos);
  CHECK(limited.err.find("allow ") != std::string::npos);
  CHECK(peak_of(plain) > 160 * kMiB);
  CHECK(peak_of(limited) < 128 * kMiB);
#else
  CHECK(peak_of(limited) > 0);
#endif
  const Outcome refused = run_stein(
      {"denoise", folder / "samples.exr", "-o", folder / "no.exr", "--filter", "rpf", "--max-memory", "100M"});
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("the memory limit is 104857600 bytes; it must be") != std::string::npos);
}

TEST_CASE("denoise --max-memory: a file whose blocks of rows alone take more is filtered, and warned of") {
  const TemporaryFolder folder;
  fixture::PartSpec wide{"", fixture::native_channels(), {0, 0, 4095, 255}};
  wide.compression = Imf::DWAB_COMPRESSION;  // of 256 rows
  fixture::write_file(folder / "in.exr", {wide});
  const Outcome outcome =
      run_stein({"denoise", folder / "in.exr", "-o", folder / "out.exr", "--filter", "gaussian", "--bank",
                 "intermediate", "--json", folder / "report.json", "--max-memory", "128M"});
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.err.find("of --max-memory") != std::string::npos);
  CHECK(report_in(folder / "report.json").at("warnings").dump().find("of --max-memory") != std::string::npos);
}

TEST_CASE("denoise --max-memory: killed, it leaves nothing in the scratch folder") {
  const TemporaryFolder folder;
  const TemporaryFolder scratch;
  write(folder / "noisy.exr", noisy_image(640, 600));
  HaltedProgram program({"denoise", folder / "noisy.exr", "-o", folder / "clean.exr", "--filter", "gaussian", "--tile",
                         "16x16", "--threads", "1", "--max-memory", "128M", "--scratch", scratch.path().string()});
  REQUIRE(program.wait_for_progress());
  program.send(SIGKILL);
  program.drain();
  CHECK(program.outcome().signal == SIGKILL);
  CHECK(scratch.entries() == 0);
}

TEST_CASE("denoise --max-memory: a full scratch folder is told, and leaves no output") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(640, 600));
  const Outcome outcome = run_stein({"denoise", folder / "noisy.exr", "-o", folder / "clean.exr", "--max-memory",
                                     "128M", "--scratch", folder.path().string()},
                                    100'000);
  CHECK(outcome.exit_code == 4);
  CHECK(outcome.err.find("scratch folder '" + folder.path().string() + "' has no room for") != std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"noisy.exr"});
}

TEST_CASE("denoise --max-memory: layers, views and sequences as without") {
  const TemporaryFolder folder;
  Channels image = noisy_image(500, 500);
  for (const char* channel : {"R", "G", "B"}) image.values[std::string("key.") + channel] = image.values[channel];
  for (const char* name : {"in.1.exr", "in.2.exr"}) write(folder / name, image);
  const auto run = [&](const std::string& out, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"denoise", folder / "in.#.exr", "-o",     folder / out,  "--frames",
                                          "1-2",     "--layers",          "key",    "--filter",    "gaussian,atrous",
                                          "--json",  folder / "#.json",   "--bank", "intermediate"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
  };
  run("plain.#.exr", {});
  run("limited.#.exr", {"--max-memory", "0.125G"});
  for (const char* frame : {"1", "2"}) {
    const bool is_same = fixture::bytes_of(folder / ("plain." + std::string(frame) + ".exr")) ==
                         fixture::bytes_of(folder / ("limited." + std::string(frame) + ".exr"));
    CHECK(is_same);
  }
  // Told for each frame by itself.
  const nlohmann::json second = report_in(folder / "2.json");
  CHECK(second.at("scratch_bytes") > 10 * kMiB);
  CHECK(second.at("scratch_bytes") == report_in(folder / "1.json").at("scratch_bytes"));
}
