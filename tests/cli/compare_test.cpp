// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

nlohmann::json compare_json(const std::string& a, const std::string& b) {
  const Outcome outcome = run_stein({"compare", a, b, "--json"});
  REQUIRE(outcome.exit_code == 0);
  return nlohmann::json::parse(outcome.out);
}

}  // namespace

TEST_CASE("compare: equal files have no error") {
  const TemporaryFolder folder;
  write(folder / "a.exr", noisy_image(20, 14));
  const nlohmann::json figures = compare_json(folder / "a.exr", folder / "a.exr");
  CHECK(figures.at("relative_mse") == 0.0);
  CHECK(figures.at("trimmed_relative_mse") == 0.0);
  CHECK(figures.at("mse") == 0.0);
  CHECK(figures.at("psnr").is_null());  // infinite
  CHECK(figures.at("ssim") == 1.0);
  CHECK_FALSE(figures.contains("estimated_mse"));
  const Outcome text = run_stein({"compare", folder / "a.exr", folder / "a.exr"});
  CHECK(text.out.find("relative MSE  0\n") != std::string::npos);
}

TEST_CASE("compare: the second file is the reference") {
  const TemporaryFolder folder;
  write(folder / "one.exr", flat_image(16, 16, 1));
  write(folder / "three.exr", flat_image(16, 16, 3));
  CHECK(compare_json(folder / "three.exr", folder / "one.exr").at("relative_mse") == Approx(4 / 1.01));
  CHECK(compare_json(folder / "one.exr", folder / "three.exr").at("relative_mse") == Approx(4 / 9.01));
}

TEST_CASE("compare: the error that an image claims stands next to the true one") {
  const TemporaryFolder folder;
  write(folder / "reference.exr", flat_image(16, 12, 2));
  Channels image = flat_image(16, 12, 2.5F);
  for (const auto& [name, value] : {std::pair{"error.R", 0.1F}, {"error.G", 0.2F}, {"error.B", 0.6F}}) {
    image.values[name].assign(16 * 12, value);
  }
  write(folder / "image.exr", image);
  const nlohmann::json figures = compare_json(folder / "image.exr", folder / "reference.exr");
  CHECK(figures.at("mse") == Approx(0.25));
  CHECK(figures.at("estimated_mse") == Approx(0.3));
  CHECK(figures.at("estimated_relative_mse") == Approx(0.3 / 4.01));
  const Outcome text = run_stein({"compare", folder / "image.exr", folder / "reference.exr"});
  CHECK(text.out.find("  estimated   0.3\n") != std::string::npos);
}

TEST_CASE("compare: what the reference says of its noise is taken off") {
  const TemporaryFolder folder;
  Channels reference = flat_image(16, 12, 2);
  for (const auto& [name, value] : {std::pair{"variance.R", 0.01F}, {"variance.G", 0.02F}, {"variance.B", 0.06F}}) {
    reference.values[name].assign(16 * 12, value);
  }
  write(folder / "reference.exr", reference);
  write(folder / "image.exr", flat_image(16, 12, 2.5F));
  const nlohmann::json figures = compare_json(folder / "image.exr", folder / "reference.exr");
  CHECK(figures.at("mse") == Approx(0.25));
  CHECK(figures.at("mse_without_reference_noise") == Approx(0.22));
  CHECK(figures.at("relative_mse_without_reference_noise") == Approx(0.22 / 4.01));
  const Outcome text = run_stein({"compare", folder / "image.exr", folder / "reference.exr"});
  CHECK(text.out.find("  true        0.22 without the reference's noise of 0.03\n") != std::string::npos);

  reference.values["variance.G"][7] = -1;
  write(folder / "unknown.exr", reference);
  const Outcome unknown = run_stein({"compare", folder / "image.exr", folder / "unknown.exr"});
  CHECK(unknown.exit_code == 0);
  CHECK(unknown.out.find("true") == std::string::npos);
  CHECK(unknown.err.find("unknown.exr: variances that are negative or no numbers") != std::string::npos);
}

TEST_CASE("compare: images of different sizes are refused") {
  const TemporaryFolder folder;
  write(folder / "a.exr", flat_image(8, 6, 1));
  write(folder / "b.exr", flat_image(6, 8, 1));
  const Outcome outcome = run_stein({"compare", folder / "a.exr", folder / "b.exr"});
  CHECK(outcome.exit_code == 3);
  CHECK(outcome.err.find("8x6") != std::string::npos);
  CHECK(outcome.err.find("6x8") != std::string::npos);
}
