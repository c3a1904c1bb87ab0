// SPDX-License-Identifier: Apache-2.0
//
// Help and full disks; the mistakes of users are in mistakes_test.cpp.
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

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
