// SPDX-License-Identifier: Apache-2.0
//
// Sequences: lists of frames, names with numbers, and runs over many frames.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.hpp"
#include "frame_numbers.hpp"
#include "program.hpp"
#include "stein/error.hpp"
#include "synthetic.hpp"

using stein::cli::frame_path;
using stein::cli::frames_text;
using stein::cli::has_frame_place;
using stein::cli::parse_frames;
using Names = std::vector<std::string>;

namespace {

void write_frames(const TemporaryFolder& folder, const std::vector<int>& frames) {
  for (const int frame : frames) {
    write(frame_path(folder / "in.####.exr", frame), noisy_image(24, 16, static_cast<unsigned>(frame)));
  }
}

Outcome denoise(const TemporaryFolder& folder, const Names& options) {
  Names arguments = {"denoise", folder / "in.####.exr", "-o", folder / "out.%03d.exr"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_stein(arguments);
}

/// The names that are not of the input.
Names outputs(const TemporaryFolder& folder) {
  Names names = folder.names();
  std::erase_if(names, [](const std::string& name) { return name.rfind("in.", 0) == 0; });
  return names;
}

bool fails(const std::string& text) {
  try {
    static_cast<void>(parse_frames(text));
    return false;
  } catch (const stein::Error& error) {
    return error.code() == stein::ErrorCode::kInvalidArgument;
  }
}

}  // namespace

TEST_CASE("frames: lists of numbers and ranges, in their order, each once") {
  CHECK(parse_frames("7") == std::vector{7});
  CHECK(parse_frames("1-3,20-25:2") == std::vector{1, 2, 3, 20, 22, 24});
  CHECK(parse_frames("5,1-6:5,1") == std::vector{5, 1, 6});
  CHECK(parse_frames("-2-1") == std::vector{-2, -1, 0, 1});
  CHECK(parse_frames("-10--8:2") == std::vector{-10, -8});
  CHECK(parse_frames("2147483646-2147483647").size() == 2);
  for (const char* text : {"", ",", "1,", "1-", "-", "a", "1-2:0", "1-2:-1", "3-1", "1:2", "1 ", "1.5", "99999999999",
                           "1-2-3", "0-1000000", "1-2:"}) {
    INFO(text);
    CHECK(fails(text));
  }
}

TEST_CASE("frames: as text that can be read again") {
  CHECK(frames_text({7}) == "7");
  CHECK(frames_text({1, 2, 3, 5, 7, 8}) == "1-3,5,7-8");
  CHECK(parse_frames(frames_text({-3, -2, 0, 9})) == std::vector{-3, -2, 0, 9});
}

TEST_CASE("frames: both habits of numbers in names") {
  CHECK(frame_path("a.####.exr", 7) == "a.0007.exr");
  CHECK(frame_path("a.%04d.exr", 7) == "a.0007.exr");
  CHECK(frame_path("a.#.exr", 12345) == "a.12345.exr");
  CHECK(frame_path("a.%d.exr", 7) == "a.7.exr");
  CHECK(frame_path("a.%04d.exr", -7) == "a.-007.exr");
  CHECK(frame_path("s##/a.####.exr", 3) == "s03/a.0003.exr");
  CHECK(frame_path("100%/a%4d%s%.exr", 3) == "100%/a%4d%s%.exr");
  CHECK(has_frame_place("a.#"));
  CHECK(has_frame_place("%d"));
  CHECK_FALSE(has_frame_place("a%4d%s%123d.exr%"));
}

TEST_CASE("frames: a range makes a file and a report for each") {
  const TemporaryFolder folder;
  write_frames(folder, {1, 2, 3, 4, 5});
  const Outcome outcome = denoise(folder, {"--frames", "1-5:2,4", "--json", folder / "report.##.json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outputs(folder) == Names{"out.001.exr", "out.003.exr", "out.004.exr", "out.005.exr", "report.01.json",
                                 "report.03.json", "report.04.json", "report.05.json"});
  CHECK(outcome.out.find("frame 4 ") != std::string::npos);
  std::ifstream file(folder / "report.03.json");
  const nlohmann::json report = nlohmann::json::parse(file);
  CHECK(report.at("frame") == 3);
  CHECK(report.at("output") == folder / "out.003.exr");

  const TemporaryFolder one_by_one;
  write_frames(one_by_one, {4});
  REQUIRE(denoise(one_by_one, {"--frame", "4", "--quiet"}).exit_code == 0);
  CHECK(read_channel(one_by_one / "out.004.exr", "R") == read_channel(folder / "out.004.exr", "R"));
}

TEST_CASE("frames: one that fails does not keep the others from being done") {
  const TemporaryFolder folder;
  write_frames(folder, {1, 2, 5});
  write(folder / "in.0003.exr", flat_image(24, 16, 1));
  const Outcome outcome = denoise(folder, {"--frames", "1-5"});
  CHECK(outcome.exit_code == 3);  // of the first that failed
  CHECK(outcome.err.find("stein: frame 3: ") != std::string::npos);
  CHECK(outcome.err.find("stein: frame 4: cannot read '" + folder / "in.0004.exr" + "'") != std::string::npos);
  CHECK(outcome.err.find("stein: 2 of 5 frames failed: 3-4\n") != std::string::npos);
  CHECK(outputs(folder) == Names{"out.001.exr", "out.002.exr", "out.005.exr"});
}

TEST_CASE("frames: what exists is skipped, where its report exists as well") {
  const TemporaryFolder folder;
  write_frames(folder, {1, 2, 3});
  std::ofstream(folder / "out.001.exr") << "done";
  std::ofstream(folder / "out.002.exr") << "done, but not told";
  std::ofstream(folder / "report.1.json") << "told";
  const Names options = {"--frames", "1-3", "--skip-existing", "--json", folder / "report.#.json"};
  const Outcome outcome = denoise(folder, options);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("skipped   1 of 3") != std::string::npos);
  CHECK(std::filesystem::file_size(folder / "out.001.exr") == 4);
  CHECK(has_channel(folder / "out.002.exr", "R"));
  CHECK(has_channel(folder / "out.003.exr", "R"));
  CHECK(denoise(folder, options).out == "skipped   3 of 3, which exist\n");
}

TEST_CASE("frames: an interrupt ends the range, and the rest is done by another run") {
  const TemporaryFolder folder;
  write_frames(folder, {1, 2, 3, 4, 5, 6, 7, 8, 9});
  const Names arguments = {"denoise", folder / "in.####.exr", "-o", folder / "out.%03d.exr", "--frames",
                           "1-9",     "--skip-existing"};
  HaltedProgram program(arguments);
  REQUIRE(program.wait_for_progress());
  program.send(SIGTERM);
  program.drain();
  CHECK(program.outcome().exit_code == 5);
  CHECK(outputs(folder).size() < 9);
  CHECK(run_stein(arguments).exit_code == 0);
  CHECK(outputs(folder).size() == 9);
}

TEST_CASE("frames: what cannot be meant is refused") {
  const TemporaryFolder folder;
  write_frames(folder, {1});
  const auto check_refused = [&](const Names& arguments, const std::string& message) {
    const Outcome outcome = run_stein(arguments);
    INFO(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.err.find(message) != std::string::npos);
  };
  const std::string in = folder / "in.####.exr";
  const std::string out = folder / "out.####.exr";
  check_refused({"denoise", in, "-o", out}, "say which frames");
  check_refused({"denoise", in, "-o", folder / "out.exr", "--frames", "1"}, "-o");
  check_refused({"denoise", folder / "in.0001.exr", "-o", out, "--frame", "1"}, "IN");
  check_refused({"denoise", in, "-o", out, "--frame", "1", "--json", folder / "x.json"}, "--json");
  check_refused({"denoise", in, "-o", out, "--frames", "2-1"}, "'2-1'");
  check_refused({"denoise", in, "-o", out, "--frames", "1", "--frame", "1"}, "--frame");
  check_refused({"denoise", in, "-o", out, "--frames", "1", "--strength", "2"}, "strength");
  check_refused({"denoise", in, "-o", out, "--frames", "1-2", "--filter", "rpf", "--adjacent", in}, "--adjacent");
  CHECK(outputs(folder).empty());
}
