// SPDX-License-Identifier: Apache-2.0
//
// Stereo: each eye is filtered by itself.
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.hpp"
#include "exr/fixture.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

void write_stereo(const std::string& path) {
  const auto eye = [](const char* name) {
    return fixture::PartSpec{name,
                             fixture::colour_channels(),
                             {0, 0, 22, 12},
                             fixture::Storage::kScanlines,
                             Imf::ZIP_COMPRESSION,
                             [name](Imf::Header& header) { header.setView(name); }};
  };
  fixture::write_file(path, {eye("left"), eye("right")});
}

bool has(const std::string& path, int part, const std::string& channel) {
  const std::vector<std::string> names = fixture::channel_names(path, part);
  return std::find(names.begin(), names.end(), channel) != names.end();
}

}  // namespace

TEST_CASE("denoise: both eyes of a stereo pair, or the one that is asked for") {
  const TemporaryFolder folder;
  write_stereo(folder / "in.exr");
  const Outcome both =
      run_stein({"denoise", folder / "in.exr", "-o", folder / "out.exr", "--json", folder / "report.json"});
  INFO(both.err);
  REQUIRE(both.exit_code == 0);
  CHECK(both.out.find("view      left") != std::string::npos);
  CHECK(both.out.find("view      right") != std::string::npos);
  for (const int part : {0, 1}) CHECK(has(folder / "out.exr", part, "error.R"));
  std::ifstream file(folder / "report.json");
  const nlohmann::json report = nlohmann::json::parse(file);
  REQUIRE(report.at("views").size() == 2);
  CHECK(report.at("views")[1].at("view") == "right");

  REQUIRE(run_stein({"denoise", folder / "in.exr", "-o", folder / "right.exr", "--view", "right"}).exit_code == 0);
  CHECK_FALSE(has(folder / "right.exr", 0, "error.R"));
  CHECK(fixture::read_raw(folder / "right.exr", 0, "R") == fixture::read_raw(folder / "in.exr", 0, "R"));
  CHECK(fixture::read_raw(folder / "right.exr", 1, "R") == fixture::read_raw(folder / "out.exr", 1, "R"));
  CHECK(run_stein({"info", folder / "in.exr"}).out.find("view: left, of left, right") != std::string::npos);
}
