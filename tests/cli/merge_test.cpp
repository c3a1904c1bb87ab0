// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "stein/exr.hpp"
#include "synthetic.hpp"

namespace {

constexpr std::size_t kPixels = 20 * 14;

/// A render that says nothing of its noise: colour, albedo and normal.
Channels plain_render(unsigned seed) {
  Channels image = noisy_image(20, 14, seed);
  std::erase_if(image.values, [](const auto& plane) { return plane.first.find("variance") != std::string::npos; });
  image.values.erase("sampleCount");
  return image;
}

struct Renders {
  std::vector<Channels> images;
  std::vector<std::string> paths;
};

Renders write_renders(const TemporaryFolder& folder, unsigned count, Channels (*make)(unsigned seed)) {
  Renders renders;
  for (unsigned seed = 1; seed <= count; ++seed) {
    renders.images.push_back(make(seed));
    renders.paths.push_back(folder / ("seed" + std::to_string(seed) + ".exr"));
    write(renders.paths.back(), renders.images.back());
  }
  return renders;
}

Outcome merge(std::vector<std::string> arguments, const std::vector<std::string>& files) {
  arguments.insert(arguments.begin(), files.begin(), files.end());
  arguments.insert(arguments.begin(), "merge");
  return run_stein(arguments);
}

/// Covariance of the weighted means of two channels, from how the images differ.
double spread(const Renders& renders, const std::vector<double>& n, const std::string& a, const std::string& b,
              std::size_t pixel) {
  double total = 0;
  double mean_a = 0;
  double mean_b = 0;
  for (std::size_t k = 0; k < n.size(); ++k) {
    total += n[k];
    mean_a += n[k] * static_cast<double>(renders.images[k].values.at(a)[pixel]);
    mean_b += n[k] * static_cast<double>(renders.images[k].values.at(b)[pixel]);
  }
  double sum = 0;
  for (std::size_t k = 0; k < n.size(); ++k) {
    sum += n[k] * (static_cast<double>(renders.images[k].values.at(a)[pixel]) - mean_a / total) *
           (static_cast<double>(renders.images[k].values.at(b)[pixel]) - mean_b / total);
  }
  return sum / (static_cast<double>(n.size() - 1) * total);
}

void check_channel(const std::string& path, const std::string& name, const std::vector<double>& expected) {
  const std::vector<float> found = read_channel(path, name);
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    INFO(name << " at " << i);
    CHECK(static_cast<double>(found[i]) == Approx(expected[i]).epsilon(1e-4).margin(1e-8));
  }
}

Channels native_render(unsigned seed) { return noisy_image(20, 14, seed); }

}  // namespace

TEST_CASE("merge: renders without variances get them from how they differ") {
  const TemporaryFolder folder;
  const Renders renders = write_renders(folder, 4, plain_render);
  const std::string out = folder / "merged.exr";
  const Outcome outcome = merge({"-o", out, "--samples", "4,1,8,4"}, renders.paths);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.err.find("0%\n") != std::string::npos);
  CHECK(outcome.err.find("100%\n") != std::string::npos);
  CHECK(outcome.out.find("4 files") != std::string::npos);
  CHECK(outcome.out.find("3 degrees of freedom") != std::string::npos);

  const std::vector<double> n = {4, 1, 8, 4};
  const std::vector<std::vector<std::string>> moments = {{"variance.G", "G", "G"},
                                                         {"covariance.R.B", "R", "B"},
                                                         {"albedo.variance.G", "albedo.G", "albedo.G"},
                                                         {"covariance.B.albedo.R", "B", "albedo.R"},
                                                         {"covariance.R.normal.Z", "R", "normal.Z"}};
  for (const auto& names : moments) {
    std::vector<double> expected;
    for (std::size_t i = 0; i < kPixels; ++i) expected.push_back(spread(renders, n, names[1], names[2], i));
    check_channel(out, names[0], expected);
  }
  std::vector<double> mean(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) {
    for (std::size_t k = 0; k < 4; ++k) mean[i] += n[k] / 17 * static_cast<double>(renders.images[k].values.at("R")[i]);
  }
  check_channel(out, "R", mean);
  check_channel(out, "sampleCount", std::vector<double>(kPixels, 17));
  check_channel(out, "id.Z", std::vector<double>(kPixels, 42));

  const nlohmann::json info = nlohmann::json::parse(run_stein({"info", out, "--json"}).out);
  CHECK(info.at("samples").at("degrees_of_freedom") == 3);
  CHECK(run_stein({"denoise", out, "-o", folder / "clean.exr", "--quiet"}).exit_code == 0);
}

TEST_CASE("merge: variances of the files are pooled") {
  const TemporaryFolder folder;
  const Renders renders = write_renders(folder, 3, native_render);
  const std::string out = folder / "merged.exr";
  REQUIRE(merge({"-o", out}, renders.paths).exit_code == 0);
  std::vector<double> expected(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) {
    double within = 0;
    for (const Channels& image : renders.images)
      within += 8 * 7 * static_cast<double>(image.values.at("variance.G")[i]);
    const double between = spread(renders, {8, 8, 8}, "G", "G", i) * 2 * 24;
    expected[i] = (within + between) / (24 * 23);
  }
  check_channel(out, "variance.G", expected);
  check_channel(out, "sampleCount", std::vector<double>(kPixels, 24));
  CHECK_FALSE(has_channel(out, "covariance.R.G"));  // the files have none
  CHECK_FALSE(
      nlohmann::json::parse(run_stein({"info", out, "--json"}).out).at("samples").contains("degrees_of_freedom"));

  REQUIRE(merge({"-o", out, "--spread", "--quiet"}, renders.paths).exit_code == 0);  // replaces the file
  for (std::size_t i = 0; i < kPixels; ++i) expected[i] = spread(renders, {8, 8, 8}, "G", "G", i);
  check_channel(out, "variance.G", expected);
  CHECK(has_channel(out, "covariance.R.G"));
  CHECK(run_stein({"info", out}).out.find("2 degrees of freedom") != std::string::npos);

  const Outcome denoise = run_stein({"denoise", out, "-o", folder / "clean.exr", "--quiet"});
  CHECK(denoise.exit_code == 0);
  CHECK(denoise.err.find("the variances have 2 degrees of freedom") != std::string::npos);

  // A merge of merges knows what its parts know.
  const std::string again = folder / "again.exr";
  std::filesystem::copy(out, folder / "copy.exr");
  REQUIRE(merge({"-o", again}, {out, folder / "copy.exr"}).exit_code == 0);
  CHECK(run_stein({"info", again}).out.find("5 degrees of freedom") != std::string::npos);
}

TEST_CASE("merge: other files stand in for a pixel that one lost") {
  const TemporaryFolder folder;
  Renders renders = write_renders(folder, 3, plain_render);
  renders.images[1].at("G", 4, 2) = std::numeric_limits<float>::quiet_NaN();
  renders.images[2].at("normal.Y", 5, 2) = std::numeric_limits<float>::infinity();
  write(renders.paths[1], renders.images[1]);
  write(renders.paths[2], renders.images[2]);
  const std::string out = folder / "merged.exr";
  const Outcome outcome = merge({"-o", out, "--samples", "2", "--quiet"}, renders.paths);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find("warning: 1 pixels of the files had no usable colour") != std::string::npos);
  CHECK(outcome.err.find("warning: 1 pixels of the files had an unusable feature") != std::string::npos);
  CHECK(read_channel(out, "sampleCount")[2 * 20 + 4] == 4);
  CHECK(read_channel(out, "G")[2 * 20 + 4] ==
        Approx((renders.images[0].at("G", 4, 2) + renders.images[2].at("G", 4, 2)) / 2));
}

TEST_CASE("merge: one image twice is told") {
  const TemporaryFolder folder;
  const Renders renders = write_renders(folder, 2, plain_render);
  std::filesystem::copy(renders.paths[0], folder / "copy.exr");
  const Outcome outcome =
      merge({"-o", folder / "merged.exr", "--samples", "2"}, {renders.paths[0], renders.paths[1], folder / "copy.exr"});
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.err.find("same image") != std::string::npos);
  CHECK(outcome.err.find("copy.exr") != std::string::npos);
}

TEST_CASE("merge: files that do not belong together") {
  const TemporaryFolder folder;
  const std::string out = folder / "merged.exr";
  const Renders renders = write_renders(folder, 2, native_render);
  write(folder / "small.exr", noisy_image(14, 20));
  Channels other = native_render(5);
  write(folder / "plain.exr", plain_render(5));
  std::erase_if(other.values, [](const auto& plane) { return plane.first.rfind("albedo", 0) == 0; });
  write(folder / "poor.exr", other);
  const auto check = [&](const std::vector<std::string>& files, int code, const std::vector<std::string>& words,
                         const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments = {"-o", out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = merge(arguments, files);
    INFO(outcome.err);
    CHECK(outcome.exit_code == code);
    for (const std::string& word : words) CHECK(outcome.err.find(word) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(out));
  };
  const std::string& a = renders.paths[0];
  const std::string& b = renders.paths[1];
  check({a}, 2, {"two files", "seed1.exr"});
  check({a, a}, 2, {"one file", "seed1.exr"});
  check({a, b}, 2, {"--samples", "3 numbers"}, {"--samples", "1,2,3"});
  check({a, folder / "small.exr"}, 3, {"20x14", "14x20", "small.exr"});
  check({a, folder / "poor.exr"}, 3, {"features", "albedo (3), normal (3)", "poor.exr"});
  check({a, folder / "plain.exr"}, 3, {"--spread", "plain.exr"}, {"--samples", "8"});
  check({folder / "plain.exr", a}, 3, {"number of samples", "plain.exr"});
  check({a, folder / "absent.exr"}, 4, {"absent.exr"});
  const Outcome nowhere = merge({"-o", folder / "no/merged.exr"}, {a, b});
  CHECK(nowhere.exit_code == 4);
  CHECK(nowhere.err.find("no folder") != std::string::npos);
  const Outcome onto_input = merge({"-o", a}, {a, b});
  CHECK(onto_input.exit_code == 2);
  CHECK(onto_input.err.find("one of the inputs") != std::string::npos);
}

TEST_CASE("merge: a failure or an interrupt leaves nothing behind") {
  const TemporaryFolder folder;
  const Renders renders = write_renders(folder, 2, native_render);
  std::vector<std::string> arguments = {"merge", renders.paths[0], renders.paths[1], "-o", folder / "merged.exr"};
  const Outcome full = run_stein(arguments, 2000);
  CHECK(full.exit_code == 4);
  CHECK(full.err.find("merged.exr") != std::string::npos);
  CHECK(folder.names() == std::vector<std::string>{"seed1.exr", "seed2.exr"});

  HaltedProgram program(arguments);
  REQUIRE(program.wait_for_progress());
  program.send(SIGINT);
  program.drain();
  CHECK(program.outcome().exit_code == 5);
  CHECK(folder.names() == std::vector<std::string>{"seed1.exr", "seed2.exr"});
}
