// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "program.hpp"
#include "synthetic.hpp"

namespace {

using Rgb8 = std::array<std::uint8_t, 3>;
constexpr Rgb8 kMagenta = {255, 0, 255};

struct Png {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] Rgb8 at(int x, int y) const {
    const auto i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return {bytes.at(i), bytes.at(i + 1), bytes.at(i + 2)};
  }
};

Png read_png(const std::string& path) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&image, path.c_str()) != 0);
  image.format = PNG_FORMAT_RGB;
  Png result{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  result.bytes.resize(PNG_IMAGE_SIZE(image));
  REQUIRE(png_image_finish_read(&image, nullptr, result.bytes.data(), 0, nullptr) != 0);
  return result;
}

Png preview(const TemporaryFolder& folder, const Channels& image, const std::vector<std::string>& options) {
  write(folder / "image.exr", image);
  std::vector<std::string> arguments = {"preview", folder / "image.exr", "-o", folder / "picture.png"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome outcome = run_stein(arguments);
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return read_png(folder / "picture.png");
}

double luminance(Rgb8 c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

}  // namespace

TEST_CASE("preview: colours are exposed, clipped and sRGB-encoded, and what is not finite is magenta") {
  const TemporaryFolder folder;
  Channels image = flat_image(20, 10, 0.25F);
  image.at("R", 1, 0) = 7;
  image.at("G", 1, 0) = -1;
  image.at("B", 2, 0) = std::numeric_limits<float>::quiet_NaN();
  image.at("R", 3, 0) = std::numeric_limits<float>::infinity();
  const Png plain = preview(folder, image, {});
  CHECK(plain.width == 20);
  CHECK(plain.height == 10);
  CHECK(plain.at(19, 9) == Rgb8{137, 137, 137});
  CHECK(plain.at(1, 0) == Rgb8{255, 0, 137});
  CHECK(plain.at(2, 0) == kMagenta);
  CHECK(plain.at(3, 0) == kMagenta);
  CHECK(preview(folder, image, {"--exposure", "1"}).at(19, 9) == Rgb8{188, 188, 188});
  CHECK(preview(folder, image, {"--exposure", "-100"}).at(19, 9) == Rgb8{0, 0, 0});
}

TEST_CASE("preview: unit vectors become colours around grey") {
  const TemporaryFolder folder;
  const Png png = preview(folder, noisy_image(20, 10), {"--layer", "normal"});
  CHECK(png.at(0, 0) == Rgb8{0, 128, 128});
  CHECK(png.at(19, 0) == Rgb8{128, 128, 255});
}

TEST_CASE("preview: other vectors are shown by their range") {
  const TemporaryFolder folder;
  Channels image = flat_image(4, 4, 0);
  image.values["position.X"].assign(16, 10);
  image.values["position.Y"].assign(16, -10);
  image.values["position.Z"].assign(16, 0);
  CHECK(preview(folder, image, {"--layer", "position"}).at(2, 2) == Rgb8{255, 0, 128});
  CHECK(preview(folder, image, {"--layer", "position", "--range", "-10,30"}).at(2, 2) == Rgb8{128, 0, 64});
}

TEST_CASE("preview: other layers have false colours of rising lightness, and a scale") {
  const TemporaryFolder folder;
  Channels image = flat_image(100, 130, 0);
  for (int y = 0; y < 130; ++y) {
    for (int x = 0; x < 100; ++x) {
      image.values["depth.Z"].push_back(static_cast<float>(x));
    }
  }
  image.at("depth.Z", 50, 0) = -std::numeric_limits<float>::infinity();
  const Png png = preview(folder, image, {"--layer", "depth", "--range", "0,99"});
  CHECK(png.width > 100);
  CHECK(png.height == 130);
  CHECK(png.at(50, 0) == kMagenta);
  for (int x = 4; x < 100; x += 4) {
    CHECK(luminance(png.at(x, 1)) > luminance(png.at(x - 4, 1)));
  }
  bool scale_has_both_ends = false;
  bool has_text = false;
  for (int x = 100; x < png.width; ++x) {
    std::set<Rgb8> column;
    for (int y = 0; y < png.height; ++y) {
      column.insert(png.at(x, y));
    }
    scale_has_both_ends = scale_has_both_ends || (column.contains(png.at(0, 1)) && column.contains(png.at(99, 1)));
    has_text = has_text || column.contains(Rgb8{255, 255, 255});
  }
  CHECK(scale_has_both_ends);
  CHECK(has_text);
  const Png automatic = preview(folder, image, {"--layer", "depth"});  // from 0 to the 99 % quantile
  CHECK(automatic.at(0, 1) == png.at(0, 1));
  CHECK(automatic.at(98, 1) == png.at(99, 1));
}

TEST_CASE("preview: choices have distinct colours") {
  const TemporaryFolder folder;
  Channels image = flat_image(8, 3, 0);
  for (int i = 0; i < 24; ++i) {
    image.values["choice.V"].push_back(static_cast<float>(i % 8));
  }
  const Png png = preview(folder, image, {"--layer", "choice"});
  std::set<Rgb8> colours;
  for (int x = 0; x < 8; ++x) {
    colours.insert(png.at(x, 0));
    CHECK(png.at(x, 0) == png.at(x, 2));
  }
  CHECK(colours.size() == 8);
}

TEST_CASE("preview: a one-pixel and a constant layer work") {
  const TemporaryFolder folder;
  const Png png = preview(folder, flat_image(1, 1, 3), {"--layer", "R"});
  CHECK(png.width > 1);
  CHECK(png.height >= 64);
}

TEST_CASE("compare: the error picture marks where the error is") {
  const TemporaryFolder folder;
  Channels image = flat_image(40, 130, 1);
  for (int y = 0; y < 130; ++y) {
    for (int x = 20; x < 40; ++x) {
      image.at("R", x, y) = 2;
    }
  }
  write(folder / "image.exr", image);
  write(folder / "reference.exr", flat_image(40, 130, 1));
  REQUIRE(
      run_stein({"compare", folder / "image.exr", folder / "reference.exr", "--error-picture", folder / "error.png"})
          .exit_code == 0);
  const Png png = read_png(folder / "error.png");
  CHECK(luminance(png.at(30, 7)) > luminance(png.at(5, 7)) + 100);
}

TEST_CASE("preview: options that do not fit the layer are refused") {
  const TemporaryFolder folder;
  write(folder / "image.exr", noisy_image(8, 8));
  const auto code = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"preview", folder / "image.exr", "-o", folder / "picture.png"});
    return run_stein(options).exit_code;
  };
  CHECK(code({"--layer", "normal", "--exposure", "1"}) == 2);
  CHECK(code({"--range", "0,1"}) == 2);
  CHECK(code({"--layer", "R", "--range", "1,0"}) == 2);
  CHECK(code({"--layer", "R", "--range", "1"}) == 2);
  CHECK(code({"--layer", "nothing"}) == 3);
  CHECK(folder.names() == std::vector<std::string>{"image.exr"});
}
