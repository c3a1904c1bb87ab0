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
#include "synthetic.hpp"

namespace {

nlohmann::json report_in(const std::string& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

constexpr std::int64_t kMiB = std::int64_t{1} << 20;

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
