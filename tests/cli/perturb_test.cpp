// SPDX-License-Identifier: Apache-2.0
//
// The way of another denoiser's image through files: perturb, run it on both files, hand the results in. The other
// denoiser is stein's own Gaussian here.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.hpp"
#include "exr/fixture.hpp"
#include "program.hpp"
#include "stein/exr.hpp"
#include "synthetic.hpp"

namespace {

// With covariances, so that features move as well.
Channels image_with_covariances() {
  Channels image = noisy_image(64, 48);
  for (const std::string c : {"R", "G", "B"}) {
    std::vector<float>& covariance = image.values["covariance." + c + ".albedo.R"];
    for (std::size_t i = 0; i < image.values.at("R").size(); ++i) {
      covariance.push_back(0.5F *
                           std::sqrt(image.values.at("variance." + c)[i] * image.values.at("albedo.variance.R")[i]));
    }
    for (const std::string k : {"albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"})
      image.values["covariance." + c + "." + k].assign(covariance.size(), 0.0F);
  }
  return image;
}

void must_run(const std::vector<std::string>& arguments) {
  const Outcome outcome = run_stein(arguments);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

// The file's colour alone, as a program writes it that keeps no attribute.
void write_colour(const std::string& from, const std::string& to) {
  Channels colour = flat_image(64, 48, 0);
  for (const std::string c : {"R", "G", "B"}) colour.values[c] = read_channel(from, c);
  write(to, colour);
}

nlohmann::json read_json(const std::string& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

}  // namespace

TEST_CASE("perturb: colour and features move by the step, everything else stays, and the header says how") {
  const TemporaryFolder folder;
  write(folder / "in.exr", image_with_covariances());
  const Outcome outcome = run_stein(
      {"perturb", folder / "in.exr", "-o", folder / "out.exr", "--seed", "18446744073709551615", "--draw", "3"});
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("draw 3 of seed 18446744073709551615, step 0.1") != std::string::npos);
  const auto stated = stein::exr::read_perturbation(folder / "out.exr");
  REQUIRE(stated);
  CHECK(stated->seed == 18446744073709551615U);
  CHECK(stated->draw == 3);
  CHECK(stated->step == 0.1F);
  CHECK_FALSE(stein::exr::read_perturbation(folder / "in.exr"));

  const Channels image = image_with_covariances();
  for (const auto& [name, values] : image.values) {
    INFO(name);
    const std::vector<float> moved = read_channel(folder / "out.exr", name);
    const bool moves = name == "R" || name == "G" || name == "B" || name == "albedo.R";
    if (!moves) {
      CHECK(moved == values);
      continue;
    }
    const std::vector<float>& variance = image.values.at(name == "albedo.R" ? "albedo.variance.R" : "variance." + name);
    double squares = 0;
    double most = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      squares += std::pow((moved[i] - values[i]) / 0.1, 2);
      most += variance[i];
    }
    // A feature moves by the part of its noise that it has in common with the colour.
    CHECK(squares <= 1.001 * most);
    CHECK(squares >= (name == "albedo.R" ? 0.2 : 0.99) * most);
  }
}

TEST_CASE("perturb: the same bytes again, and other draws for another number") {
  const TemporaryFolder folder;
  write(folder / "in.exr", image_with_covariances());
  must_run({"perturb", folder / "in.exr", "-o", folder / "a.exr", "--threads", "1"});
  must_run({"perturb", folder / "in.exr", "-o", folder / "b.exr", "--threads", "3"});
  must_run({"perturb", folder / "in.exr", "-o", folder / "c.exr", "--draw", "1"});
  CHECK(fixture::bytes_of(folder / "a.exr") == fixture::bytes_of(folder / "b.exr"));
  CHECK(read_channel(folder / "a.exr", "R") != read_channel(folder / "c.exr", "R"));
  const Outcome twice = run_stein({"perturb", folder / "a.exr", "-o", folder / "d.exr"});
  CHECK(twice.exit_code == 2);
  CHECK(twice.err.find("perturbed already") != std::string::npos);
}

TEST_CASE("denoise: a candidate through files, with and without what the header says") {
  const TemporaryFolder folder;
  write(folder / "in.exr", image_with_covariances());
  const auto other = [&](const std::string& from, const std::string& to) {
    must_run({"denoise", folder / from, "-o", folder / to, "--filter", "gaussian", "--quiet"});
  };
  other("in.exr", "other.exr");
  for (const std::string draw : {"0", "1"}) {
    must_run({"perturb", folder / "in.exr", "-o", folder / ("p" + draw + ".exr"), "--draw", draw, "--quiet"});
    other("p" + draw + ".exr", "o" + draw + ".exr");
    write_colour(folder / ("o" + draw + ".exr"), folder / ("plain" + draw + ".exr"));
  }
  const auto denoise = [&](const std::string& to, const std::string& perturbed, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {
        "denoise", folder / "in.exr", "-o", folder / to, "--candidate", folder / "other.exr", "--candidate-perturbed",
        perturbed};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_stein(arguments);
  };
  const std::string stated = folder / "o1.exr," + (folder / "o0.exr");  // in any order, as the headers say which
  const std::string plain = folder / "plain0.exr," + (folder / "plain1.exr");
  const Outcome outcome = denoise("a.exr", stated, {"--json", folder / "a.json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("other, Monte Carlo joint SURE: from 2 perturbed runs") != std::string::npos);
  const nlohmann::json report = read_json(folder / "a.json");
  CHECK(report.at("filters").back().at("name") == "other");
  CHECK(report.at("choice_share").contains("other"));
  REQUIRE(denoise("b.exr", plain).exit_code == 0);
  const std::vector<float> a = read_channel(folder / "a.exr", "G");
  const std::vector<float> b = read_channel(folder / "b.exr", "G");
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == Approx(b[i]).epsilon(1e-4));

  const Outcome seed = denoise("c.exr", stated, {"--candidate-seed", "7"});
  CHECK(seed.exit_code == 2);
  CHECK(seed.err.find("says that its seed was 1") != std::string::npos);
  const Outcome step = denoise("c.exr", stated, {"--candidate-step", "0.5"});
  CHECK(step.err.find("says that its step was 0.1") != std::string::npos);
  const Outcome same = denoise("c.exr", folder / "o0.exr," + (folder / "o0.exr"));
  CHECK(same.err.find("same draw") != std::string::npos);
  const Outcome swapped = run_stein({"denoise", folder / "in.exr", "-o", folder / "c.exr", "--candidate",
                                     folder / "o0.exr", "--candidate-perturbed", folder / "other.exr"});
  CHECK(swapped.exit_code == 2);
  CHECK(swapped.err.find("made of a perturbed file") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "c.exr"));
}

TEST_CASE("denoise: candidates of a sequence have the frame's number, and names as given") {
  const TemporaryFolder folder;
  for (const std::string frame : {"01", "02"}) {
    write(folder / ("in." + frame + ".exr"), noisy_image(64, 48));
    must_run({"denoise", folder / ("in." + frame + ".exr"), "-o", folder / ("o." + frame + ".exr"), "--filter",
              "gaussian", "--quiet"});
  }
  must_run({"perturb", folder / "in.##.exr", "-o", folder / "p.##.exr", "--frames", "1-2", "--quiet"});
  for (const std::string frame : {"01", "02"}) {
    must_run({"denoise", folder / ("p." + frame + ".exr"), "-o", folder / ("op." + frame + ".exr"), "--filter",
              "gaussian", "--quiet"});
  }
  const auto arguments = [&](const std::string& candidate) {
    return std::vector<std::string>{"denoise",
                                    folder / "in.##.exr",
                                    "-o",
                                    folder / "out.##.exr",
                                    "--frames",
                                    "1-2",
                                    "--json",
                                    folder / "report.##.json",
                                    "--candidate",
                                    candidate,
                                    "--candidate-perturbed",
                                    folder / "op.##.exr"};
  };
  must_run(arguments("smooth=" + (folder / "o.##.exr")));
  for (const std::string frame : {"01", "02"}) {
    CHECK(std::filesystem::exists(folder / ("out." + frame + ".exr")));
    CHECK(read_json(folder / ("report." + frame + ".json")).at("filters").back().at("name") == "smooth");
  }
  const Outcome fixed = run_stein(arguments(folder / "o.01.exr"));
  CHECK(fixed.exit_code == 2);
  CHECK(fixed.err.find("no place for the number of the frame") != std::string::npos);
}
