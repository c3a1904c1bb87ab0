// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

TEST_CASE("info: says what was understood, counted and missed") {
  const TemporaryFolder folder;
  Channels image = noisy_image(24, 16);
  image.at("G", 3, 2) = std::numeric_limits<float>::quiet_NaN();
  image.at("albedo.B", 5, 5) = std::numeric_limits<float>::infinity();
  image.at("sampleCount", 0, 0) = 4;
  write(folder / "noisy.exr", image);

  const Outcome outcome = run_stein({"info", folder / "noisy.exr", "--json"});
  REQUIRE(outcome.exit_code == 0);
  const nlohmann::json info = nlohmann::json::parse(outcome.out);
  CHECK(info.at("width") == 24);
  CHECK(info.at("height") == 16);
  CHECK(info.at("data_window") == nlohmann::json({0, 0, 23, 15}));
  CHECK(info.at("invalid_pixels") == 1);
  CHECK(info.at("bad_feature_pixels").at("albedo") == 1);
  CHECK(info.at("bad_feature_pixels").at("normal") == 0);
  CHECK(info.at("samples").at("min") == 4);
  CHECK(info.at("samples").at("max") == 8);
  CHECK(info.at("planes").at("G").at("non_finite") == 1);
  CHECK(info.at("planes").at("normal.X").at("min") == -1);
  CHECK(info.at("planes").at("normal.X").at("mean") == -0.5);
  CHECK(info.at("planes").at("normal.X").at("max") == 0);
  CHECK_FALSE(info.at("missing").empty());  // covariances
  bool found = false;
  for (const nlohmann::json& channel : info.at("channels")) {
    found = found || (channel.at("name") == "variance.G" && !channel.at("role").get<std::string>().empty());
  }
  CHECK(found);
}

TEST_CASE("info: prints the same for people") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(24, 16));
  const Outcome outcome = run_stein({"info", folder / "noisy.exr"});
  REQUIRE(outcome.exit_code == 0);
  for (const char* text : {"24x16", "8 per pixel", "invalid pixels: 0", "albedo.variance.R", "id.Z", "missing"}) {
    CHECK(outcome.out.find(text) != std::string::npos);
  }
}

TEST_CASE("info: maps and kinds of variances against the schema") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(24, 16));
  const auto info = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"info", folder / "noisy.exr", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    REQUIRE(outcome.exit_code == 0);
    return nlohmann::json::parse(outcome.out);
  };
  const nlohmann::json mapped = info({"--map", "gloss=normal.X,Y:var=normal.variance.X,Y", "--variance-of", "sample"});
  const nlohmann::json plain = info({"--preset", "native"});
  CHECK(mapped.dump().find("feature gloss, variance of single samples") != std::string::npos);
  CHECK(plain.dump().find("gloss") == std::string::npos);
  const double variance = plain.at("planes").at("variance.G").at("mean");
  CHECK(mapped.at("planes").at("variance.G").at("mean").get<double>() == Approx(variance / 8));
  CHECK(run_stein({"info", folder / "noisy.exr", "--map", "gloss"}).err.find("--map") != std::string::npos);
}
