// SPDX-License-Identifier: Apache-2.0
//
// Help, arguments and errors: a render farm decides by the exit code, a person by the message.
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

void check_failure(const std::vector<std::string>& arguments, int exit_code, const std::string& message) {
  const Outcome outcome = run_stein(arguments);
  INFO(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.err.find("stein: ") != std::string::npos);
  CHECK(outcome.err.find(message) != std::string::npos);
}

}  // namespace

TEST_CASE("help and version") {
  const Outcome general = run_stein({"--help"});
  CHECK(general.exit_code == 0);
  CHECK(general.out.find("Exit codes:") != std::string::npos);
  for (const std::string verb : {"denoise", "accumulate", "info", "compare", "merge", "preview"}) {
    const Outcome help = run_stein({verb, "--help"});
    CHECK(help.exit_code == 0);
    CHECK(help.err.empty());
    CHECK(help.out.find("Examples:\n  stein " + verb) != std::string::npos);
    CHECK(general.out.find("\n  " + verb) != std::string::npos);
  }
  CHECK(run_stein({"denoise", "--help"}).out.find("cross-bilateral") != std::string::npos);
  const Outcome version = run_stein({"--version"});
  CHECK(version.exit_code == 0);
  CHECK(version.out.rfind("stein ", 0) == 0);
}

TEST_CASE("bad arguments: exit code 2") {
  const TemporaryFolder folder;
  const std::string in = folder / "noisy.exr";
  const std::string out = folder / "clean.exr";
  write(in, noisy_image(24, 16));
  check_failure({}, 2, "subcommand");
  check_failure({"improve"}, 2, "");
  check_failure({"denoise", in}, 2, "--output");
  check_failure({"denoise", "-o", out}, 2, "IN");
  check_failure({"denoise", in, "-o", out, "--wrong"}, 2, "--wrong");
  check_failure({"info", in, "--wrong"}, 2, "--wrong");
  check_failure({"denoise", in, "-o", out, "--strength", "1.5"}, 2, "1.5");
  check_failure({"denoise", in, "-o", out, "--strength", "x"}, 2, "--strength");
  check_failure({"denoise", in, "-o", out, "--filter", "magic"}, 2, "cross-bilateral");
  check_failure({"denoise", in, "-o", out, "--bank", "x"}, 2, "--bank");
  check_failure({"denoise", in, "-o", out, "--filter", "adaptive-order", "--order", "2"}, 2, "--order");
  check_failure({"denoise", in, "-o", out, "--order", "1"}, 2, "the filter 'cross-bilateral' has no option order");
  check_failure({"denoise", in, "-o", out, "--order-error", "taylor"}, 2, "no option order-error");
  check_failure({"denoise", in, "-o", out, "--tile", "64"}, 2, "--tile");
  check_failure({"denoise", in, "-o", out, "--tile", "64x32x2"}, 2, "--tile");
  check_failure({"denoise", in, "-o", out, "--feature-sigma", "normal"}, 2, "NAME=VALUE");
  check_failure({"denoise", in, "-o", out, "--feature-sigma", "depth=1"}, 2, "normal");
  check_failure({"denoise", in, "-o", out, "--feature-sigma", "normal=-1"}, 2, "-1");
  check_failure({"sample-map", in, "-o", out}, 2, "--budget");
  check_failure({"sample-map", in, "-o", out, "--budget", "10", "--min-samples", "1"}, 2, "10");
  check_failure({"sample-map", in, "-o", in, "--budget", "1000"}, 2, "is the input");
  check_failure({"denoise", in, "-o", in}, 2, "is the input");
  CHECK(folder.names() == std::vector<std::string>{"noisy.exr"});
}

TEST_CASE("unusable input: exit code 3") {
  const TemporaryFolder folder;
  const std::string out = folder / "clean.exr";
  Channels image = noisy_image(24, 16);
  image.at("G", 7, 5) = std::numeric_limits<float>::quiet_NaN();
  write(folder / "nan.exr", image);
  write(folder / "flat.exr", flat_image(24, 16, 1));
  check_failure({"denoise", folder / "flat.exr", "-o", out}, 3, "variance");
  check_failure({"denoise", folder / "nan.exr", "-o", out, "--strict"}, 3, "G");
  check_failure({"info", folder / "flat.exr"}, 3, "--samples N");
  CHECK(folder.names() == std::vector<std::string>{"flat.exr", "nan.exr"});
}

TEST_CASE("files that cannot be read or written: exit code 4") {
  const TemporaryFolder folder;
  const std::string in = folder / "noisy.exr";
  write(in, noisy_image(24, 16));
  std::ofstream(folder / "text.exr") << "not an image";
  std::filesystem::create_directory(folder / "folder");
  check_failure({"denoise", folder / "absent.exr", "-o", folder / "clean.exr"}, 4, "absent.exr");
  check_failure({"info", folder / "text.exr"}, 4, "text.exr");
  check_failure({"compare", in, folder / "absent.exr"}, 4, "absent.exr");
  check_failure({"denoise", in, "-o", folder / "no/such/clean.exr"}, 4, "clean.exr");
  check_failure({"denoise", in, "-o", folder / "folder"}, 4, "folder");
  check_failure({"denoise", in, "-o", folder / "clean.exr", "--json", folder / "no/report.json"}, 4, "report.json");
  check_failure({"preview", in, "-o", folder / "no/picture.png"}, 4, "picture.png");
  CHECK(folder.names() == std::vector<std::string>{"folder", "noisy.exr", "text.exr"});
}

TEST_CASE("a full disk leaves no half file") {
  const TemporaryFolder folder;
  const std::string in = folder / "noisy.exr";
  write(in, noisy_image(64, 48));
  constexpr long kLimit = 2000;  // bytes per file
  const Outcome preview = run_stein({"preview", in, "-o", folder / "picture.png"}, kLimit);
  CHECK(preview.exit_code == 4);
  CHECK(preview.err.find("picture.png") != std::string::npos);
  const Outcome denoise = run_stein({"denoise", in, "-o", folder / "clean.exr", "--quiet"}, kLimit);
  CHECK(denoise.exit_code == 4);
  CHECK(denoise.err.find("clean.exr") != std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"noisy.exr"});
}
