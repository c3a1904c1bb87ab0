// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

void denoise(const TemporaryFolder& folder, const std::vector<std::string>& options) {
  std::vector<std::string> arguments = {"denoise", folder / "noisy.exr", "-o", folder / "clean.exr"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome outcome = run_stein(arguments);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

double spread(const std::vector<float>& values) {  // of the left half, which has one true value
  double sum = 0;
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % kWidth < kWidth / 2) {
      sum += values[i];
      squares += static_cast<double>(values[i]) * values[i];
      ++count;
    }
  }
  return squares / count - (sum / count) * (sum / count);
}

}  // namespace

TEST_CASE("denoise: writes a cleaner image with its error, choice and density") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  denoise(folder, {});
  const std::string out = folder / "clean.exr";
  for (const char* name :
       {"R", "G", "B", "error.R", "error.G", "error.B", "choice.V", "density.V", "albedo.R", "id.Z"}) {
    CHECK(has_channel(out, name));
  }
  for (const char* name : {"variance.R", "albedo.variance.R", "sampleCount", "noisy.R"}) {
    CHECK_FALSE(has_channel(out, name));
  }
  CHECK(spread(read_channel(out, "R")) < 0.2 * spread(read_channel(folder / "noisy.exr", "R")));
  CHECK(read_channel(out, "id.Z") == read_channel(folder / "noisy.exr", "id.Z"));
}

TEST_CASE("denoise: options choose what is written") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  denoise(folder, {"--no-error", "--no-choice", "--no-density", "--keep-noisy", "--keep-inputs", "--half"});
  const std::string out = folder / "clean.exr";
  for (const char* name : {"error.R", "choice.V", "density.V"}) {
    CHECK_FALSE(has_channel(out, name));
  }
  for (const char* name : {"variance.R", "albedo.variance.R", "sampleCount"}) {
    CHECK(read_channel(out, name) == read_channel(folder / "noisy.exr", name));
  }
  CHECK(read_channel(out, "noisy.R") == read_channel(folder / "noisy.exr", "R"));
  const std::vector<float> red = read_channel(out, "R");
  CHECK(std::all_of(red.begin(), red.end(), [](float v) { return std::fmod(v * 65536.0F, 1.0F) == 0; }));  // half
}

TEST_CASE("denoise: parameters reach the filter") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  denoise(folder, {});
  const std::vector<float> plain = read_channel(folder / "clean.exr", "R");
  const auto changes = [&](const std::vector<std::string>& options) {
    denoise(folder, options);
    return read_channel(folder / "clean.exr", "R") != plain;
  };
  CHECK(changes({"--bank", "intermediate"}));
  CHECK(changes({"--filter", "cross-bilateral"}));
  CHECK(changes({"--filter", "adaptive-order,gaussian"}));
  CHECK(changes({"--quality", "fast"}));
  CHECK(changes({"--feature-sigma", "normal=0,albedo=0"}));
  CHECK(changes({"--feature-smoothing", "0"}));
  CHECK(changes({"--selection", "argmin"}));
  CHECK(changes({"--strength", "0.5"}));
  CHECK_FALSE(changes({"--filter", "auto", "--quality", "default", "--bank", "final", "--selection", "evidence"}));
  CHECK_FALSE(changes({"--threads", "2", "--tile", "16x8"}));
  denoise(folder, {"--filter", "cross-bilateral"});
  const std::vector<float> bilateral = read_channel(folder / "clean.exr", "R");
  denoise(folder, {"--filter", "cross-bilateral", "--range-sigma", "0.1"});
  CHECK(read_channel(folder / "clean.exr", "R") != bilateral);
}

TEST_CASE("denoise: the order of a regression is that of all fits, or differs from pixel to pixel") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  const auto run = [&](const std::vector<std::string>& options) {
    std::vector<std::string> all = {"--filter", "adaptive-order", "--bank", "intermediate"};
    all.insert(all.end(), options.begin(), options.end());
    denoise(folder, all);
    return read_channel(folder / "clean.exr", "R");
  };
  const std::vector<float> adaptive = run({});
  CHECK(run({"--order", "adaptive"}) == adaptive);
  CHECK(run({"--order-error", "risk"}) == adaptive);
  const std::vector<float> linear = run({"--order", "1"});
  CHECK(linear != adaptive);
  CHECK(run({"--order", "0"}) != linear);
  CHECK(run({"--order", "3"}) != linear);
}

TEST_CASE("denoise: every filter runs with every risk that it has, and the report says which one it was") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  struct Case {
    std::vector<std::string> options;
    std::string risk;
  };
  const std::vector<Case> cases = {
      {{"--filter", "cross-bilateral"}, "SURE"},
      {{"--filter", "cross-bilateral", "--risk", "monte-carlo", "--draws", "1", "--seed", "5"}, "Monte Carlo SURE"},
      {{"--filter", "cross-nlm", "--risk", "sure"}, "SURE"},
      {{"--filter", "gaussian", "--risk", "joint"}, "SURE"},  // nothing that guides it is noisy
      {{"--filter", "atrous"}, "Monte Carlo SURE"},
      {{"--filter", "adaptive-order", "--bank", "intermediate"}, "SURE"},
      {{"--filter", "adaptive-order", "--bank", "intermediate", "--order-error", "taylor"}, "Taylor expansion"},
      {{"--filter", "atrous-sure", "--risk", "monte-carlo"}, "Monte Carlo SURE"},
  };
  for (const Case& k : cases) {
    std::vector<std::string> options = k.options;
    options.insert(options.end(), {"--json", folder / "report.json"});
    denoise(folder, options);
    std::ifstream file(folder / "report.json");
    const nlohmann::json report = nlohmann::json::parse(file);
    CHECK(report.at("filter") == k.options[1]);
    const nlohmann::json& filter = report.at("filters").at(0);
    CHECK(filter.at("name") == k.options[1]);
    CHECK(filter.at("risk") == k.risk);
    CHECK(filter.at("mean_estimated_relative_error") == report.at("mean_estimated_relative_error"));
    CHECK_FALSE(filter.at("risk_reason").get<std::string>().empty());
    for (const char* name : {"error.R", "choice.V", "density.V"}) CHECK(has_channel(folder / "clean.exr", name));
  }
}

TEST_CASE("denoise: the error of each filter's picture alone, where there are several") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  const auto told = [&](const std::vector<std::string>& options, bool in_text) {
    std::vector<std::string> arguments = {"denoise", folder / "noisy.exr",  "-o", folder / "o.exr",
                                          "--json",  folder / "report.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    REQUIRE(outcome.exit_code == 0);
    CHECK((outcome.out.find(" alone\n") != std::string::npos) == in_text);
    std::ifstream file(folder / "report.json");
    return nlohmann::json::parse(file);
  };
  const std::string key = "mean_estimated_relative_error";
  const nlohmann::json report = told({"--filter", "gaussian,cross-bilateral"}, true);
  REQUIRE(report.at("filters").size() == 2);
  for (const nlohmann::json& filter : report.at("filters"))
    CHECK(filter.at(key).get<double>() >= report.at(key).get<double>());
  CHECK(told({"--filter", "gaussian"}, false).at("filters").at(0).at(key).get<double>() > 0);
  const nlohmann::json mixed = told({"--filter", "gaussian,cross-bilateral", "--strength", "0.5"}, false);
  for (const nlohmann::json& filter : mixed.at("filters")) CHECK_FALSE(filter.contains(key));
}

TEST_CASE("denoise: a risk that filter or file do not allow is an error that says so") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  const auto refusal = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"denoise", folder / "noisy.exr", "-o", folder / "clean.exr"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = run_stein(arguments);
    CHECK(outcome.exit_code != 0);
    CHECK_FALSE(std::filesystem::exists(folder / "clean.exr"));
    return outcome.err;
  };
  CHECK(refusal({"--filter", "cross-bilateral", "--risk", "joint"}).find("covariances of the colour with") !=
        std::string::npos);
  CHECK(refusal({"--filter", "atrous", "--risk", "sure"}).find("no risk in closed form") != std::string::npos);
  CHECK(refusal({"--filter", "cross-nlm", "--risk", "sure", "--feature-smoothing", "2"})
            .find("no risk in closed form with smoothed features; choose") != std::string::npos);
  CHECK(refusal({"--feature-smoothing", "6"}).find("smoothing_radius is 6") != std::string::npos);
  CHECK(refusal({"--risk", "monte-carlo", "--draws", "0"}).find("draws") != std::string::npos);
}

TEST_CASE("denoise: a file without a sample count needs --samples") {
  const TemporaryFolder folder;
  Channels image = noisy_image(kWidth, kHeight);
  image.values.erase("sampleCount");
  write(folder / "noisy.exr", image);
  denoise(folder, {"--samples", "8"});
  CHECK(has_channel(folder / "clean.exr", "error.R"));
  const std::vector<float> density = read_channel(folder / "clean.exr", "density.V");
  image.values["spp"] = std::vector<float>(std::size_t{kWidth} * kHeight, 8.0F);
  write(folder / "noisy.exr", image);
  denoise(folder, {"--samples", "spp"});
  CHECK(read_channel(folder / "clean.exr", "density.V") == density);
  image.at("spp", 3, 3) = 800.0F;
  write(folder / "noisy.exr", image);
  denoise(folder, {"--samples", "spp"});
  CHECK(read_channel(folder / "clean.exr", "density.V") != density);
}

TEST_CASE("denoise: the report holds what was done") {
  const TemporaryFolder folder;
  Channels image = noisy_image(kWidth, kHeight);
  image.at("G", 7, 5) = std::numeric_limits<float>::quiet_NaN();
  image.at("normal.X", 9, 9) = std::numeric_limits<float>::quiet_NaN();
  write(folder / "noisy.exr", image);
  denoise(folder, {"--json", folder / "report.json", "--threads", "2"});
  std::ifstream file(folder / "report.json");
  const nlohmann::json report = nlohmann::json::parse(file);
  CHECK(report.at("width") == kWidth);
  CHECK(report.at("height") == kHeight);
  CHECK(report.at("input") == folder / "noisy.exr");
  CHECK(report.at("output") == folder / "clean.exr");
  CHECK(report.at("threads") == 2);
  CHECK(report.at("invalid_pixels") == 1);
  CHECK(report.at("bad_feature_pixels") == nlohmann::json({{"normal", 1}, {"albedo", 0}}));
  CHECK(report.at("peak_memory_bytes") > 1000000);
  CHECK(report.at("mean_estimated_error").size() == 3);
  CHECK(report.at("mean_estimated_relative_error").is_number());
  double shares = 0;
  for (const auto& [name, share] : report.at("choice_share").items()) {
    shares += share.get<double>();
  }
  CHECK(shares == Approx(1));
  CHECK(report.at("choice_share").contains("input"));
  const nlohmann::json& seconds = report.at("seconds");
  CHECK(seconds.at("total").get<double>() ==
        Approx(seconds.at("read").get<double>() + seconds.at("compute").get<double>() +
               seconds.at("write").get<double>()));
  CHECK_FALSE(seconds.at("stages").empty());
  for (const char* name : {"version", "instruction_set", "filter"}) {
    CHECK_FALSE(report.at(name).get<std::string>().empty());
  }
  double weights = 0;
  for (const nlohmann::json& filter : report.at("filters")) weights += filter.at("weight").get<double>();
  CHECK(report.at("filters").size() > 1);
  CHECK(weights > 0.5);
  CHECK(weights < 1.0 + 1e-5);
  CHECK(report.at("warnings").is_array());
  CHECK(report.at("missing").is_array());
}

TEST_CASE("denoise: progress in lines, and a summary, unless --quiet") {
  const TemporaryFolder folder;
  write(folder / "noisy.exr", noisy_image(kWidth, kHeight));
  const std::vector<std::string> arguments = {"denoise", folder / "noisy.exr", "-o", folder / "clean.exr"};
  const Outcome loud = run_stein(arguments);
  std::istringstream lines(loud.err);
  std::vector<int> percents;
  for (std::string line; std::getline(lines, line);) {
    if (line.find('%') != std::string::npos) {
      percents.push_back(std::stoi(line));
    }
  }
  REQUIRE_FALSE(percents.empty());
  CHECK(percents.front() == 0);
  CHECK(percents.back() == 100);
  CHECK(percents.size() <= 11);
  CHECK(std::is_sorted(percents.begin(), percents.end()));
  for (const char* text : {"64x48", "8 per pixel", "normal", "invalid pixels", "choice", "estimated", "time"}) {
    CHECK(loud.out.find(text) != std::string::npos);
  }

  std::vector<std::string> quiet_arguments = arguments;
  quiet_arguments.emplace_back("--quiet");
  const Outcome quiet = run_stein(quiet_arguments);
  CHECK(quiet.out.empty());
  CHECK(quiet.err.find('%') == std::string::npos);
}
