// SPDX-License-Identifier: Apache-2.0
#include "bad_files.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "exr/deep_fixture.hpp"
#include "exr/fixture.hpp"
#include "synthetic.hpp"

namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 16;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Writer {
 public:
  explicit Writer(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }

  void image(const std::string& name, const Channels& image) const { write(path(name), image); }

  /// A sound image but for one value at (7, 5).
  void with_value(const std::string& name, const std::string& channel, float value) const {
    Channels image = noisy_image(kWidth, kHeight);
    image.at(channel, 7, 5) = value;
    write(path(name), image);
  }

  void with_plane(const std::string& name, const std::vector<std::string>& channels, float value) const {
    Channels image = noisy_image(kWidth, kHeight);
    for (const std::string& channel : channels)
      std::fill(image.values.at(channel).begin(), image.values.at(channel).end(), value);
    write(path(name), image);
  }

  void without(const std::string& name, const std::vector<std::string>& channels) const {
    Channels image = noisy_image(kWidth, kHeight);
    for (const std::string& channel : channels) image.values.erase(channel);
    write(path(name), image);
  }

 private:
  std::string folder_;
};

void write_values(const Writer& to) {
  to.image("noisy.exr", noisy_image(kWidth, kHeight));
  to.image("redrawn.exr", noisy_image(kWidth, kHeight, 8));
  to.with_value("nan.exr", "G", kNan);
  to.with_value("inf.exr", "G", kInfinity);
  to.with_value("huge.exr", "G", 1e38F);
  to.with_value("nan-variance.exr", "variance.G", kNan);
  to.with_value("negative-variance.exr", "variance.G", -1);
  to.with_value("no-samples.exr", "sampleCount", 0);
  to.with_value("nan-albedo.exr", "albedo.G", kNan);
  to.with_value("negative-albedo-variance.exr", "albedo.variance.G", -1);
  to.with_plane("one-sample.exr", {"sampleCount"}, 1);
  to.with_plane("exact.exr", {"variance.R", "variance.G", "variance.B"}, 0);
  to.with_plane("all-nan.exr", {"G"}, kNan);
  to.with_plane("all-negative-variance.exr", {"variance.G"}, -1);
  to.with_plane("all-without-samples.exr", {"sampleCount"}, 0);
  to.with_plane("all-nan-albedo.exr", {"albedo.G"}, kNan);
  to.with_plane("all-denormal.exr", {"R", "G", "B"}, 1e-40F);
  Channels covariance = noisy_image(kWidth, kHeight);
  for (const char* pair : {"covariance.R.G", "covariance.R.B", "covariance.G.B"})
    covariance.values[pair] = covariance.values["variance.R"];
  covariance.at("covariance.R.B", 7, 5) = kNan;
  to.image("nan-covariance.exr", covariance);
  to.image("one-pixel.exr", noisy_image(1, 1));
  Channels pixel = noisy_image(1, 1);
  pixel.at("R", 0, 0) = kNan;
  to.image("one-nan-pixel.exr", pixel);
}

void write_planes(const Writer& to) {
  to.image("flat.exr", flat_image(kWidth, kHeight, 1));
  to.image("small.exr", noisy_image(kWidth / 2, kHeight));
  to.without("no-count.exr", {"sampleCount"});
  to.without("one-variance.exr", {"variance.R", "variance.B"});
  to.without("half-albedo.exr", {"albedo.variance.G"});
  to.without("no-features.exr",
             {"albedo.R", "albedo.G", "albedo.B", "albedo.variance.R", "albedo.variance.G", "albedo.variance.B",
              "normal.X", "normal.Y", "normal.Z", "normal.variance.X", "normal.variance.Y", "normal.variance.Z"});
  Channels renamed = noisy_image(kWidth, kHeight);
  for (const char* c : {"R", "G", "B"}) {
    renamed.values[std::string("beauty.") + c] = renamed.values[c];
    renamed.values.erase(c);
  }
  to.image("beauty.exr", renamed);
}

void write_structures(const Writer& to) {
  using fixture::colour_channels;
  using fixture::layer;
  const auto part = [](const std::string& name, std::vector<fixture::ChannelSpec> channels) {
    return fixture::PartSpec{name, std::move(channels), {0, 0, 22, 12}};
  };
  fixture::PartSpec shifted = part("albedo", layer("", "RGB", Imf::HALF));
  shifted.window = {1, 0, 23, 12};
  fixture::write_file(to.path("windows.exr"), {part("main", colour_channels()), shifted});
  auto subsampled = colour_channels();
  subsampled.push_back({"chroma", Imf::HALF, false, 2});
  fixture::PartSpec even = part("", subsampled);
  even.window = {0, 0, 23, 15};
  fixture::write_file(to.path("subsampled.exr"), {even});
  fixture::PartSpec deep = part("main", layer("", "RGB", Imf::FLOAT));
  deep.storage = fixture::Storage::kDeep;
  deep.compression = Imf::ZIPS_COMPRESSION;
  fixture::write_file(to.path("deep.exr"), {deep});
  fixture::write_deep_file(to.path("samples.exr"), {{{"R"}, {"G"}, {"B"}, {"random.lens.X"}, {"random.lens.Y"}}});
  fixture::write_deep_file(to.path("grey-samples.exr"), {{{"Y"}}});
}

/// The file of that name with its bytes changed by edit(bytes).
template <class Edit>
void damage(const Writer& files, const std::string& from, const std::string& to, const Edit& edit) {
  std::vector<unsigned char> bytes = fixture::bytes_of(files.path(from));
  edit(bytes);
  fixture::write_bytes(files.path(to), bytes);
}

void write_damaged(const Writer& to) {
  damage(to, "noisy.exr", "truncated.exr", [](auto& bytes) { bytes.resize(bytes.size() / 2); });
  damage(to, "noisy.exr", "header-only.exr", [](auto& bytes) { bytes.resize(200); });
  damage(to, "samples.exr", "truncated-samples.exr", [](auto& bytes) { bytes.resize(bytes.size() - 40); });
  damage(to, "noisy.exr", "absurd-size.exr", [](auto& bytes) {
    constexpr std::string_view key("dataWindow\0box2i", 17);  // each ends with a zero
    const auto at = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
    const std::int32_t right = 1'000'000'000;
    std::memcpy(&*at + key.size() + 4 + 8, &right, sizeof right);
  });
  std::ofstream(to.path("empty.exr")).flush();
  std::ofstream(to.path("text.exr")) << "not an image, but long enough to hold a header";
  std::filesystem::create_directory(to.path("folder"));
}

}  // namespace

void write_bad_files(const std::string& folder) {
  const Writer to(folder);
  write_values(to);
  write_planes(to);
  write_structures(to);
  write_damaged(to);
}
