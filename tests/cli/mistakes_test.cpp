// SPDX-License-Identifier: Apache-2.0
//
// Every mistake that a user can make, with the exit code and the message that it leads to; and docs/errors.md, whose
// tables are what these runs said. STEIN_WRITE_DOCS=1 writes them anew:
//   STEIN_WRITE_DOCS=1 cli_test "mistakes*"
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "bad_files.hpp"
#include "catch.hpp"
#include "program.hpp"

namespace {

struct Mistake {
  std::string what;
  std::string arguments;  // words
  int exit_code;
  std::vector<std::string> parts;  // of the message, in their order
  bool ours = true;                // false: worded by a library in part, whose other versions may word it otherwise
};

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

bool has_in_order(const std::string& text, const std::vector<std::string>& parts) {
  std::size_t at = 0;
  return std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
    at = text.find(part, at);
    return at != std::string::npos;
  });
}

/// The line with all of these, without the program's name.
std::string message_line(const std::string& err, const std::vector<std::string>& parts) {
  constexpr std::string_view kName = "stein: ";
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kName) && has_in_order(line, parts)) return line.substr(kName.size());
  }
  return {};
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += "... " + part + " ";
  return text + "...";
}

std::string table_row(const Mistake& mistake, const std::string& message) {
  const std::string shown = replaced(mistake.ours ? message : joined(mistake.parts), "|", "\\|");
  return "| " + mistake.what + " | `" + mistake.arguments + "` | " + shown + " | " + std::to_string(mistake.exit_code) +
         " |\n";
}

/// Makes the mistake, checks what the program says, and returns the row of the table.
std::string make(const Mistake& mistake, const TemporaryFolder& folder) {
  const std::vector<std::string> before = folder.names();
  const Outcome outcome = run_stein(words(mistake.arguments), 0, folder.path().string());
  const std::string message = replaced(message_line(outcome.err, mistake.parts), folder.path().string(), "/job");
  INFO(mistake.arguments << "\n" << outcome.err);
  CHECK(outcome.exit_code == mistake.exit_code);
  CHECK_FALSE(message.empty());
  if (mistake.exit_code != 0) CHECK(folder.names() == before);
  std::filesystem::remove(folder / "out.exr");
  return table_row(mistake, message);
}

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The table between its marks in docs/errors.md is what was said now.
void check_docs(const std::string& section, const std::string& table) {
  const std::string path = STEIN_DOCS "/errors.md";
  const std::string text = read_text(path);
  const std::string mark = "<!-- " + section + " -->\n";
  const std::size_t begin = text.find(mark);
  REQUIRE(begin != std::string::npos);
  const std::size_t from = begin + mark.size();
  const std::size_t to = text.find("<!-- end -->", from);
  REQUIRE(to != std::string::npos);
  if (std::getenv("STEIN_WRITE_DOCS") != nullptr) {
    std::ofstream(path) << text.substr(0, from) + table + text.substr(to);
  } else {
    INFO("docs/errors.md, " << section << ": written anew with STEIN_WRITE_DOCS=1");
    CHECK(text.substr(from, to - from) == table);
  }
}

void check_mistakes(const std::string& section, const std::vector<Mistake>& mistakes) {
  const TemporaryFolder folder;
  write_bad_files(folder.path().string());
  std::string table = "| mistake | `stein ...` | message | exit code |\n|---|---|---|---|\n";
  for (const Mistake& mistake : mistakes) table += make(mistake, folder);
  check_docs(section, table);
}

}  // namespace

TEST_CASE("mistakes in arguments") {
  check_mistakes(
      "arguments",
      {{"no verb", "", 2, {"subcommand", "see 'stein --help'"}, false},
       {"unknown verb", "improve", 2, {"subcommand", "see 'stein --help'"}, false},
       {"no output", "denoise noisy.exr", 2, {"--output is required", "see 'stein --help'"}, false},
       {"no input", "denoise -o out.exr", 2, {"IN is required", "see 'stein --help'"}, false},
       {"unknown option", "denoise noisy.exr -o out.exr --wrong", 2, {"--wrong"}, false},
       {"not a number", "denoise noisy.exr -o out.exr --strength x", 2, {"--strength", "x"}, false},
       {"number out of range", "denoise noisy.exr -o out.exr --strength 1.5", 2, {"1.5"}},
       {"zero samples per pixel", "denoise noisy.exr -o out.exr --samples 0", 2, {"--samples", "above 0"}},
       {"samples from a channel that is not there",
        "denoise no-count.exr -o out.exr --samples spp",
        2,
        {"'no-count.exr'", "spp", "it has"}},
       {"too many threads", "denoise noisy.exr -o out.exr --threads 5000", 2, {"threads", "5000"}},
       {"memory without a number", "denoise noisy.exr -o out.exr --max-memory 2X", 2, {"--max-memory", "2X", "512M"}},
       {"too little memory", "denoise noisy.exr -o out.exr --max-memory 1M", 2, {"1048576 bytes", "134217728"}},
       {"scratch folder without a limit", "denoise noisy.exr -o out.exr --scratch .", 2, {"--scratch requires"}, false},
       {"scratch folder that is not there",
        "denoise noisy.exr -o out.exr --max-memory 2G --scratch nowhere",
        4,
        {"'nowhere'", "scratch"}},
       {"unknown filter", "denoise noisy.exr -o out.exr --filter magic", 2, {"magic", "cross-bilateral"}, false},
       {"unknown word", "denoise noisy.exr -o out.exr --bank x", 2, {"--bank"}, false},
       {"option of another filter",
        "denoise noisy.exr -o out.exr --filter cross-bilateral --order 1",
        2,
        {"'cross-bilateral' has no option order"}},
       {"option of another filter",
        "denoise noisy.exr -o out.exr --range-sigma 1",
        2,
        {"'adaptive-order', 'atrous-sure' has no option range-sigma"}},
       {"errors by which filters cannot be mixed",
        "denoise noisy.exr -o out.exr --order-error taylor",
        2,
        {"several filters", "adaptive-order alone"}},
       {"a comma too many", "denoise noisy.exr -o out.exr --filter gaussian,", 2, {"cross-bilateral"}},
       {"filter and quality",
        "denoise noisy.exr -o out.exr --filter gaussian --quality fast",
        2,
        {"leave out --filter, or --quality"}},
       {"unknown quality", "denoise noisy.exr -o out.exr --quality good", 2, {"--quality"}, false},
       {"value that the option does not have",
        "denoise noisy.exr -o out.exr --filter adaptive-order --order 2",
        2,
        {"--order"},
        false},
       {"not a size", "denoise noisy.exr -o out.exr --tile 64", 2, {"--tile", "WIDTHxHEIGHT"}},
       {"not a size", "denoise noisy.exr -o out.exr --tile 64x32x2", 2, {"--tile", "WIDTHxHEIGHT"}},
       {"sigma without a value", "denoise noisy.exr -o out.exr --feature-sigma normal", 2, {"NAME=VALUE"}},
       {"negative sigma", "denoise noisy.exr -o out.exr --feature-sigma normal=-1", 2, {"-1"}},
       {"sigma of a feature that the file does not have",
        "denoise noisy.exr -o out.exr --feature-sigma depth=1",
        2,
        {"depth", "normal"}},
       {"option of raw samples for an image",
        "denoise noisy.exr -o out.exr --randoms random.lens",
        2,
        {"--randoms", "rpf"}},
       {"option of images for raw samples",
        "denoise samples.exr -o out.exr --filter rpf --strength 0.5",
        2,
        {"--strength", "rpf"}},
       {"a candidate of unknown error",
        "denoise noisy.exr -o out.exr --candidate flat.exr",
        2,
        {"'flat.exr' has no --candidate-perturbed", "stein perturb"}},
       {"perturbed runs of nothing",
        "denoise noisy.exr -o out.exr --candidate-perturbed flat.exr",
        2,
        {"'flat.exr' has no --candidate"}},
       {"a step without a candidate", "denoise noisy.exr -o out.exr --candidate-step 0.1", 2, {"without --candidate"}},
       {"a candidate of another size",
        "denoise noisy.exr -o out.exr --candidate small.exr --candidate-perturbed small.exr",
        2,
        {"candidate 'small'", "12x16", "24x16"}},
       {"a candidate with a NaN",
        "denoise noisy.exr -o out.exr --candidate nan.exr --candidate-perturbed flat.exr",
        2,
        {"candidate 'nan'", "no colour at pixel (7, 5)"}},
       {"a candidate and another perturbation",
        "denoise noisy.exr -o out.exr --candidate noisy.exr --candidate-perturbed redrawn.exr",
        2,
        {"candidate 'noisy'", "nothing to do with the perturbation", "draw 0 of seed 1", "perturb anew"}},
       {"a candidate and layers",
        "denoise noisy.exr -o out.exr --candidate flat.exr --candidate-perturbed flat.exr --layers id.Z",
        2,
        {"'id.Z'", "'flat'", "leave out the layers, or the candidate"}},
       {"two candidates of one name",
        "denoise noisy.exr -o out.exr --candidate a=flat.exr --candidate-perturbed flat.exr --candidate a=flat.exr "
        "--candidate-perturbed flat.exr",
        2,
        {"called 'a'", "a name of its own"}},
       {"a candidate for raw samples",
        "denoise samples.exr -o out.exr --filter rpf --candidate flat.exr",
        2,
        {"--candidate", "rpf"}},
       {"output is a candidate",
        "denoise noisy.exr -o small.exr --candidate small.exr --candidate-perturbed flat.exr",
        2,
        {"small.exr is a candidate's image"}},
       {"a step too large", "perturb noisy.exr -o out.exr --step 2", 2, {"step of a perturbation is 2"}},
       {"a negative draw", "perturb noisy.exr -o out.exr --draw -1", 2, {"draw of a perturbation is -1"}},
       {"output is the input", "perturb noisy.exr -o noisy.exr", 2, {"noisy.exr is the input itself"}},
       {"unknown preset", "denoise noisy.exr -o out.exr --preset vray", 2, {"vray", "native"}},
       {"view that the file does not have", "denoise noisy.exr -o out.exr --view right", 2, {"no view right"}},
       {"map without channels", "denoise noisy.exr -o out.exr --map albedo=", 2, {"--map", "PLANE=CHANNELS"}},
       {"map with too few channels",
        "denoise noisy.exr -o out.exr --map colour=R,G",
        2,
        {"'colour'", "2 channels", "give 3"}},
       {"map to a channel that is not there",
        "denoise noisy.exr -o out.exr --map albedo=Diffuse.R,G,B",
        2,
        {"noisy.exr", "Diffuse.R", "it has"}},
       {"output is the input",
        "denoise noisy.exr -o noisy.exr",
        2,
        {"noisy.exr is the input itself", "choose another file"}},
       {"output is the input", "denoise noisy.exr -o ./noisy.exr", 2, {"is the input"}},
       {"output is the input", "preview noisy.exr -o noisy.exr", 2, {"is the input"}},
       {"report onto the input", "denoise noisy.exr -o out.exr --json noisy.exr", 2, {"is the image"}},
       {"report onto the output", "denoise noisy.exr -o out.exr --json out.exr", 2, {"is the image"}},
       {"output is the input", "sample-map noisy.exr -o noisy.exr --budget 1000", 2, {"noisy.exr is the input itself"}},
       {"output is one of the inputs", "merge noisy.exr small.exr -o small.exr", 2, {"small.exr is one of the inputs"}},
       {"one file to merge", "merge noisy.exr -o out.exr", 2, {"two files or more", "noisy.exr is alone"}},
       {"the same file twice", "merge noisy.exr noisy.exr -o out.exr", 2, {"are one file", "different seeds"}},
       {"sample counts for some files",
        "merge noisy.exr small.exr nan.exr -o out.exr --samples 4,4",
        2,
        {"2 numbers for 3 files"}},
       {"no budget", "sample-map noisy.exr -o out.exr", 2, {"--budget"}, false},
       {"budget below the least", "sample-map noisy.exr -o out.exr --budget 10 --min-samples 1", 2, {"10"}},
       {"range without an end", "preview noisy.exr -o out.exr --layer normal --range 1", 2, {"--range", "LOW,HIGH"}},
       {"exposure of what is no colour",
        "preview noisy.exr -o out.exr --layer id --exposure 1",
        2,
        {"'id' is not a colour", "--range"}}});
}

TEST_CASE("mistakes in what a file has") {
  check_mistakes(
      "planes",
      {{"no variance",
        "denoise flat.exr -o out.exr",
        3,
        {"flat.exr", "no variance.R", "have the renderer write it", "docs/inputs.md"}},
       {"variance of one channel only",
        "denoise one-variance.exr -o out.exr",
        3,
        {"one-variance.exr", "no variance.R, variance.B"}},
       {"no sample count", "denoise no-count.exr -o out.exr", 3, {"no-count.exr", "sampleCount", "--samples N"}},
       {"no sample count", "info no-count.exr", 3, {"no-count.exr", "--samples N"}},
       {"colour under another name",
        "denoise beauty.exr -o out.exr",
        3,
        {"beauty.exr", "no R, G, B", "beauty.R", "docs/inputs.md"}},
       {"a feature's variance in part",
        "denoise half-albedo.exr -o out.exr",
        3,
        {"half-albedo.exr", "albedo.variance.G"}},
       {"no features", "denoise no-features.exr -o out.exr", 0, {"no features"}},
       {"wrong layer", "preview noisy.exr -o out.exr --layer specular", 3, {"noisy.exr", "specular", "it has"}},
       {"parts with different data windows",
        "denoise windows.exr -o out.exr",
        3,
        {"windows.exr", "data window of part 'albedo'", "same data window"}},
       {"subsampled channel", "denoise subsampled.exr -o out.exr", 3, {"subsampled.exr", "chroma", "full resolution"}},
       {"deep image", "denoise deep.exr -o out.exr", 3, {"deep.exr", "R, G, B are deep", "stein accumulate"}},
       {"raw samples for a pixel filter",
        "denoise samples.exr -o out.exr",
        3,
        {"samples.exr", "R, G, B are deep", "stein accumulate"}},
       {"flat image for the filter of raw samples",
        "denoise noisy.exr -o out.exr --filter rpf",
        3,
        {"rpf reads raw samples", "noisy.exr"}},
       {"flat image for raw samples", "accumulate noisy.exr -o out.exr", 3, {"noisy.exr", "deep"}},
       {"raw samples without a colour",
        "accumulate grey-samples.exr -o out.exr",
        3,
        {"grey-samples.exr", "no channel R", "Y"}},
       {"images of different sizes", "compare noisy.exr small.exr", 3, {"differ in size", "noisy.exr", "small.exr"}},
       {"renders of different sizes",
        "merge noisy.exr small.exr -o out.exr",
        3,
        {"noisy.exr", "small.exr", "24x16 and 12x16"}},
       {"renders with different features",
        "merge noisy.exr no-features.exr -o out.exr",
        3,
        {"no-features.exr", "features"}}});
}

TEST_CASE("mistakes in values") {
  check_mistakes(
      "values",
      {{"a NaN",
        "denoise nan.exr -o out.exr",
        0,
        {"warning: 'nan.exr'", "1 pixel", "plane 'G' holds nan at pixel (7, 5)", "filled from"}},
       {"a NaN, and `--strict`",
        "denoise nan.exr -o out.exr --strict",
        3,
        {"'nan.exr'", "plane 'G' holds nan at pixel (7, 5)", "fix the renderer"}},
       {"an infinite value",
        "denoise inf.exr -o out.exr",
        0,
        {"'inf.exr'", "plane 'G' holds inf at pixel (7, 5)", "filled from"}},
       {"a value of 1e38",
        "denoise huge.exr -o out.exr",
        0,
        {"'huge.exr'", "plane 'G' holds 1e+38 at pixel (7, 5)", "filled from"}},
       {"a variance that is NaN",
        "denoise nan-variance.exr -o out.exr",
        0,
        {"plane 'variance.G' holds nan at pixel (7, 5)"}},
       {"a negative variance",
        "denoise negative-variance.exr -o out.exr",
        0,
        {"plane 'variance.G' holds -1 at pixel (7, 5)"}},
       {"a negative variance, and `--strict`",
        "denoise negative-variance.exr -o out.exr --strict",
        3,
        {"plane 'variance.G' holds -1 at pixel (7, 5)"}},
       {"a pixel without samples",
        "denoise no-samples.exr -o out.exr",
        0,
        {"plane 'sampleCount' holds 0 at pixel (7, 5)"}},
       {"one sample per pixel", "denoise one-sample.exr -o out.exr", 0, {"384 pixels have one sample"}},
       {"variances that are all 0", "denoise exact.exr -o out.exr", 0, {"'exact.exr'", "variance", "0 in all pixels"}},
       {"a NaN in a feature",
        "denoise nan-albedo.exr -o out.exr",
        0,
        {"'albedo'", "1 pixel", "'albedo.G' holds nan at pixel (7, 5)", "left out"}},
       {"a negative variance of a feature",
        "denoise negative-albedo-variance.exr -o out.exr",
        0,
        {"'albedo.variance.G' holds -1 at pixel (7, 5)"}},
       {"a NaN in a feature, and `--strict`",
        "denoise nan-albedo.exr -o out.exr --strict",
        3,
        {"plane 'albedo.G' holds nan at pixel (7, 5)"}},
       {"a feature that is NaN everywhere",
        "denoise all-nan-albedo.exr -o out.exr",
        0,
        {"'albedo'", "384 pixels", "left out"}},
       {"a covariance that is NaN",
        "denoise nan-covariance.exr -o out.exr",
        0,
        {"'covariance.R.B' holds nan at pixel (7, 5)", "count as 0"}},
       {"a colour that is NaN everywhere",
        "denoise all-nan.exr -o out.exr",
        3,
        {"'all-nan.exr'", "plane 'G' holds nan at pixel (0, 0)", "no pixel"}},
       {"a variance that is negative everywhere",
        "denoise all-negative-variance.exr -o out.exr",
        3,
        {"'variance.G' holds -1 at pixel (0, 0)", "no pixel"}},
       {"no samples anywhere",
        "denoise all-without-samples.exr -o out.exr",
        3,
        {"'sampleCount' holds 0 at pixel (0, 0)", "no pixel"}},
       {"a single pixel that is NaN",
        "denoise one-nan-pixel.exr -o out.exr",
        3,
        {"'R' holds nan at pixel (0, 0)", "no pixel"}}});
}

TEST_CASE("mistakes in files") {
  check_mistakes(
      "files",
      {{"no such file", "denoise absent.exr -o out.exr", 4, {"'absent.exr'", "no such file"}},
       {"no such file", "compare noisy.exr absent.exr", 4, {"'absent.exr'", "no such file"}},
       {"a folder", "denoise folder -o out.exr", 4, {"'folder'", "not a regular file"}},
       {"an empty file", "denoise empty.exr -o out.exr", 4, {"'empty.exr'", "truncated or not an OpenEXR file"}},
       {"not an OpenEXR file", "info text.exr", 4, {"'text.exr'", "not an OpenEXR file"}},
       {"truncated", "denoise truncated.exr -o out.exr", 4, {"'truncated.exr'", "truncated"}},
       {"truncated in its header", "denoise header-only.exr -o out.exr", 4, {"'header-only.exr'", "truncated"}},
       {"truncated samples",
        "accumulate truncated-samples.exr -o out.exr",
        4,
        {"'truncated-samples.exr'", "truncated"}},
       {"an absurd size",
        "denoise absurd-size.exr -o out.exr",
        4,
        {"'absurd-size.exr'", "1000000001 x 16", "larger than any image"}},
       {"output into no folder",
        "denoise noisy.exr -o no/such/out.exr",
        4,
        {"'no/such/out.exr'", "there is no folder"}},
       {"output is a folder", "denoise noisy.exr -o folder", 4, {"'folder'", "it is a folder"}},
       {"report into no folder",
        "denoise noisy.exr -o out.exr --json no/report.json",
        4,
        {"'no/report.json'", "there is no folder"}},
       {"picture into no folder",
        "preview noisy.exr -o no/picture.png",
        4,
        {"'no/picture.png'", "there is no folder"}}});
}

TEST_CASE("what looks like a mistake and is none: one pixel, denormal values") {
  const TemporaryFolder folder;
  write_bad_files(folder.path().string());
  for (const std::string file : {"one-pixel.exr", "all-denormal.exr"}) {
    const Outcome outcome = run_stein({"denoise", file, "-o", "out.exr", "--quiet"}, 0, folder.path().string());
    INFO(outcome.err);
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.err.find("usable") == std::string::npos);
  }
}
