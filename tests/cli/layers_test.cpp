// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

// A noisy image with two parts of its colour, alpha and a Cryptomatte layer.
Channels image_with_layers() {
  Channels image = noisy_image(64, 48);
  std::mt19937 random(3);
  for (const std::string c : {"R", "G", "B"}) {
    std::vector<float> key;
    std::vector<float> fill;
    for (const float value : image.values.at(c)) {
      key.push_back(value * static_cast<float>(random() % 1000) / 1000.0F);
      fill.push_back(value - key.back());
    }
    image.values["key." + c] = key;
    image.values["fill." + c] = fill;
    image.values["crypto00." + c] = key;
  }
  image.values["A"].assign(64 * 48, 1.0F);
  return image;
}

double distance_of_sum(const std::string& path) {
  double largest = 0;
  for (const std::string c : {"R", "G", "B"}) {
    const std::vector<float> whole = read_channel(path, c);
    const std::vector<float> key = read_channel(path, "key." + c);
    const std::vector<float> fill = read_channel(path, "fill." + c);
    for (std::size_t i = 0; i < whole.size(); ++i)
      largest = std::max(largest, std::abs(static_cast<double>(key[i]) + fill[i] - whole[i]) / whole[i]);
  }
  return largest;
}

}  // namespace

TEST_CASE("denoise: without --layers they are carried over as they are") {
  const TemporaryFolder folder;
  write(folder / "in.exr", image_with_layers());
  const Outcome outcome = run_stein({"denoise", folder / "in.exr", "-o", folder / "out.exr"});
  REQUIRE(outcome.exit_code == 0);
  for (const char* name : {"key.R", "fill.B", "A", "crypto00.G"})
    CHECK(read_channel(folder / "out.exr", name) == read_channel(folder / "in.exr", name));
  CHECK(outcome.out.find("filtered as the colour is") == std::string::npos);
}

TEST_CASE("denoise: --layers filters those, and they sum up to the colour") {
  const TemporaryFolder folder;
  write(folder / "in.exr", image_with_layers());
  const std::string wanted = GENERATE("all", "key,fill,A");
  const Outcome outcome = run_stein(
      {"denoise", folder / "in.exr", "-o", folder / "out.exr", "--layers", wanted, "--json", folder / "report.json"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(read_channel(folder / "out.exr", "key.R") != read_channel(folder / "in.exr", "key.R"));
  CHECK(read_channel(folder / "out.exr", "crypto00.R") == read_channel(folder / "in.exr", "crypto00.R"));
  CHECK(distance_of_sum(folder / "out.exr") < 1e-5);
  for (const float alpha : read_channel(folder / "out.exr", "A")) CHECK(alpha == Approx(1).epsilon(2e-6));
  for (const char* line : {"key, filtered", "fill, filtered", "A, filtered"})
    CHECK(outcome.out.find(line) != std::string::npos);
  std::ifstream file(folder / "report.json");
  const nlohmann::json report = nlohmann::json::parse(file);
  REQUIRE(report.at("layers").size() == 3);
  CHECK(report.at("layers").at("fill").at("bad_pixels") == 0);
}

TEST_CASE("denoise: layers with unusable values are told of, wrong names refused") {
  const TemporaryFolder folder;
  Channels image = image_with_layers();
  image.at("fill.G", 10, 20) = std::numeric_limits<float>::infinity();
  write(folder / "in.exr", image);
  const Outcome repaired = run_stein({"denoise", folder / "in.exr", "-o", folder / "out.exr", "--layers", "fill"});
  CHECK(repaired.exit_code == 0);
  CHECK(repaired.out.find("1 pixels without a usable layer fill") != std::string::npos);
  CHECK(repaired.err.find("'fill.G' at (10, 20)") != std::string::npos);
  const std::vector<std::string> strict = {"denoise", folder / "in.exr", "-o", folder / "strict.exr", "--layers",
                                           "fill",    "--strict"};
  CHECK(run_stein(strict).err.find("'fill.G' holds inf") != std::string::npos);
  const Outcome unknown = run_stein({"denoise", folder / "in.exr", "-o", folder / "none.exr", "--layers", "rim"});
  CHECK(unknown.exit_code != 0);
  CHECK(unknown.err.find("fill, key, A") != std::string::npos);
  CHECK(run_stein({"denoise", folder / "in.exr", "-o", folder / "none.exr", "--layers", "crypto00"}).exit_code != 0);
}

TEST_CASE("denoise: --straight-alpha gives what the premultiplied image gives, divided by the filtered alpha") {
  const TemporaryFolder folder;
  Channels image = image_with_layers();
  std::vector<float>& alpha = image.values.at("A");
  for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] = i % 64 < 20 ? 0.0F : i % 64 < 24 ? 0.25F : 1.0F;
  Channels straight = image;
  // Powers of 2: what is empty stays away, and the rest is exact.
  for (auto& [name, values] : image.values) {
    const bool is_colour = name.size() == 1 && name != "A";
    const bool is_layer = name.rfind("key.", 0) == 0 || name.rfind("fill.", 0) == 0;
    const bool is_variance = name.rfind("variance.", 0) == 0;
    if (!is_colour && !is_layer && !is_variance) continue;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= is_variance ? alpha[i] * alpha[i] : alpha[i];
  }
  write(folder / "premultiplied.exr", image);
  write(folder / "straight.exr", straight);
  REQUIRE(run_stein({"denoise", folder / "premultiplied.exr", "-o", folder / "a.exr", "--layers", "key,A"}).exit_code ==
          0);
  const Outcome outcome = run_stein({"denoise", folder / "straight.exr", "-o", folder / "b.exr", "--layers", "key",
                                     "--straight-alpha", "--keep-noisy"});
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("the colour is straight: it was multiplied by A") != std::string::npos);
  const std::vector<float> filtered_alpha = read_channel(folder / "a.exr", "A");
  CHECK(read_channel(folder / "b.exr", "A") == filtered_alpha);
  for (const char* name : {"R", "B", "key.G", "error.G"}) {
    INFO(name);
    const std::vector<float> premultiplied = read_channel(folder / "a.exr", name);
    const std::vector<float> divided = read_channel(folder / "b.exr", name);
    const bool is_error = std::string(name) == "error.G";
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < divided.size(); ++i) {
      const float divisor = is_error ? filtered_alpha[i] * filtered_alpha[i] : filtered_alpha[i];
      wrong += divided[i] == (divisor > 0 ? premultiplied[i] / divisor : 0.0F) ? 0 : 1;
    }
    CHECK(wrong == 0);
  }
  CHECK(read_channel(folder / "b.exr", "noisy.R") == straight.values.at("R"));
}

TEST_CASE("denoise: --straight-alpha without alpha is refused") {
  const TemporaryFolder folder;
  write(folder / "in.exr", noisy_image(32, 24));
  const Outcome outcome = run_stein({"denoise", folder / "in.exr", "-o", folder / "out.exr", "--straight-alpha"});
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.err.find("it has no alpha") != std::string::npos);
}
