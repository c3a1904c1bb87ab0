// SPDX-License-Identifier: Apache-2.0
//
// Files as renderers write them, by their names and conventions.
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <map>

#include "catch.hpp"
#include "expect_error.hpp"
#include "fixture.hpp"

namespace fixture {

using stein::ErrorCode;
using stein::Feature;
using stein::Frame;
using stein::Plane;
using stein::exr::LoadedFrame;
using stein::exr::read_frame;
using stein::exr::VarianceOf;

namespace {

constexpr int kSide = 5;

/// A file of constant planes, but for what `edit` changes.
class ConstantFile {
 public:
  ConstantFile& add(const std::string& name, float value) {
    Plane plane(kSide, kSide);
    for (int y = 0; y < kSide; ++y) std::fill_n(plane.row(y), kSide, value);
    planes_[name] = std::move(plane);
    return *this;
  }
  ConstantFile& add(const std::string& prefix, const std::string& components, std::array<float, 3> values) {
    for (std::size_t i = 0; i < components.size(); ++i) add(prefix + components[i], values[i]);
    return *this;
  }
  Plane& operator[](const std::string& name) { return planes_.at(name); }
  void write(const std::string& path) const {
    std::vector<std::pair<std::string, stein::ConstPlaneView>> views;
    for (const auto& [name, plane] : planes_) views.emplace_back(name, plane.view());
    stein::exr::write_planes(path, views);
  }

 private:
  std::map<std::string, Plane> planes_;
};

const Feature& feature(const Frame& frame, const std::string& name) {
  for (const Feature& f : frame.features) {
    if (f.name == name) return f;
  }
  FAIL("no feature " << name);
  return frame.features.front();
}

bool is_schema(const LoadedFrame& loaded, const std::string& name) { return loaded.schema().rfind(name + " ", 0) == 0; }

bool assumes(const LoadedFrame& loaded, const std::string& words) {
  return std::any_of(loaded.assumptions().begin(), loaded.assumptions().end(),
                     [&](const std::string& text) { return text.find(words) != std::string::npos; });
}

ConstantFile pbrt_file() {
  ConstantFile file;
  // 0.9505, 1, 1.0888: the white of Rec. 709. One random factor of standard deviation 2 for all wavelengths.
  file.add("", "RGB", {1, 1, 1})
      .add("Variance.", "RGB", {4 * 0.9505F * 0.9505F, 4, 4 * 1.0888F * 1.0888F})
      .add("RelativeVariance.", "RGB", {4, 4, 4})
      .add("Albedo.", "RGB", {0.5F, 0.4F, 0.3F})
      .add("Ns.", "XYZ", {0, 1, 0})
      .add("P.", "XYZ", {1, 2, 3});
  return file;
}

std::vector<ChannelSpec> cycles_channels() {
  return layer("View.Layer.Combined", "RGBA", Imf::FLOAT) + layer("View.Layer.Denoising Albedo", "RGB", Imf::FLOAT) +
         layer("View.Layer.Denoising Normal", "XYZ", Imf::FLOAT) +
         layer("View.Layer.Denoising Depth", "Z", Imf::FLOAT) + layer("View.Layer.Depth", "Z", Imf::FLOAT) +
         layer("View.Layer.DiffCol", "RGB", Imf::FLOAT) + layer("Other.Combined", "RGBA", Imf::FLOAT);
}

}  // namespace

TEST_CASE("pbrt: variances of single samples in XYZ") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  pbrt_file().write(path);
  const LoadedFrame loaded = read_frame(path, {.samples_per_pixel = 8});
  CHECK(is_schema(loaded, "pbrt"));
  CHECK(assumes(loaded, "X, Y, Z"));
  for (const auto& variance : loaded.frame().colour_variance) CHECK(variance.at(2, 2) == Approx(0.5).epsilon(2e-3));
  CHECK(feature(loaded.frame(), "albedo").mean[1].at(0, 0) == 0.4F);
  CHECK(feature(loaded.frame(), "normal").mean[1].at(0, 0) == 1);
  CHECK(feature(loaded.frame(), "position").mean[2].at(0, 0) == 3);
  CHECK(feature(loaded.frame(), "albedo").variance.empty());
  expect_error(ErrorCode::kInvalidFrame, {path, "--samples"}, [&] { (void)read_frame(path); });
}

TEST_CASE("pbrt: a variance of zero is how the neighbours differ") {
  const TemporaryFolder folder;
  ConstantFile file = pbrt_file();
  file["R"].row(2)[2] = 10;  // all around it have 1
  for (const char* name : {"Variance.R", "Variance.G", "Variance.B"}) file[name].row(2)[2] = 0;
  file.write(folder / "in.exr");
  const LoadedFrame loaded = read_frame(folder / "in.exr", {.samples_per_pixel = 8});
  CHECK(loaded.frame().colour_variance[0].at(2, 2) == Approx(81).epsilon(1e-3));
  CHECK(loaded.frame().colour_variance[1].at(2, 2) == Approx(0).margin(1e-4));
  CHECK(loaded.frame().colour_variance[0].at(1, 1) == Approx(0.5).epsilon(2e-3));
}

TEST_CASE("pbrt: a variance of zero is how neighbours without variance differ, where there are two") {
  const TemporaryFolder folder;
  ConstantFile file = pbrt_file();
  const auto unknown = [&](int x, int y, float red) {
    file["R"].row(y)[x] = red;
    for (const char* name : {"Variance.R", "Variance.G", "Variance.B"}) file[name].row(y)[x] = 0;
  };
  for (int y = 1; y <= 3; ++y) unknown(2, y, 5.0F);
  file["R"].row(3)[2] = 5.5F;  // the surface beside has 1
  file.write(folder / "in.exr");
  const LoadedFrame loaded = read_frame(folder / "in.exr", {.samples_per_pixel = 8});
  CHECK(loaded.frame().colour_variance[0].at(2, 2) == Approx(0.25).epsilon(1e-3));  // the greater of the two
  CHECK(loaded.frame().colour_variance[0].at(2, 1) == Approx(16).epsilon(1e-3));    // knows one such neighbour only
}

TEST_CASE("pbrt: the older names, and samples in the header") {
  const TemporaryFolder folder;
  std::vector<ChannelSpec> channels =
      layer("", "RGB", Imf::HALF) + layer("Variance", "RGB", Imf::HALF) + layer("Albedo", "RGB", Imf::HALF);
  for (const char* name : {"Px", "Py", "Pz", "Nx", "Ny", "Nz", "Nsx", "Nsy", "Nsz"}) channels.push_back({name});
  write_file(folder / "in.exr", {{.name = "", .channels = channels, .edit = [](Imf::Header& header) {
                                    header.insert("samplesPerPixel", Imf::IntAttribute(4));
                                  }}});
  const LoadedFrame loaded = read_frame(folder / "in.exr");
  CHECK(loaded.frame().uniform_sample_count == 4);
  CHECK(holds(feature(loaded.frame(), "normal").mean[2], "Nsz"));
  CHECK(holds(feature(loaded.frame(), "position").mean[1], "Py"));
}

TEST_CASE("Mitsuba: means of squares of colour and features") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  ConstantFile file;
  file.add("", "RGB", {1, 2, 3}).add("n.img.", "RGB", {1, 2, 3}).add("n.img.A", 1).add("m2_n.img.A", 1);
  file.add("n.", "XYZ", {1, 1, 1}).add("m2_n.", "XYZ", {9, 9, 9}).add("m2_n.img.", "RGB", {1 + 3, 4 + 6, 9 - 1e-6F});
  file.add("n.al.", "RGB", {0.5F, 0.5F, 0.5F}).add("m2_n.al.", "RGB", {0.25F + 0.75F, 0.25F, 0.25F});
  file.add("n.nn.", "XYZ", {0, 0, 1}).add("m2_n.nn.", "XYZ", {1.5F, 0, 1}).add("n.dd.T", 3).add("m2_n.dd.T", 12);
  file.add("n.pp.", "XYZ", {1, 2, 3}).add("m2_n.pp.", "XYZ", {1, 4, 9}).add("n.uv.U", 1).add("m2_n.uv.U", 1);
  file.write(path);
  expect_error(ErrorCode::kInvalidFrame, {path, "--samples N"}, [&] { (void)read_frame(path); });
  const LoadedFrame loaded = read_frame(path, {.samples_per_pixel = 4});
  const Frame& frame = loaded.frame();
  CHECK(is_schema(loaded, "mitsuba"));
  CHECK(frame.colour_variance[0].at(0, 0) == 1);
  CHECK(frame.colour_variance[1].at(0, 0) == 2);
  CHECK(frame.colour_variance[2].at(0, 0) == 0);
  REQUIRE(frame.features.size() == 4);
  CHECK(feature(frame, "albedo").variance[0].at(0, 0) == 0.25F);
  CHECK(feature(frame, "normal").variance[0].at(0, 0) == 0.5F);
  CHECK(feature(frame, "depth").mean[0].at(0, 0) == 3);
  CHECK(feature(frame, "depth").variance[0].at(0, 0) == 1);
}

TEST_CASE("Mitsuba: means of squares of X, Y, Z alone") {
  const TemporaryFolder folder;
  ConstantFile file;
  const std::array<float, 3> white = {0.9505F, 1, 1.0888F};
  file.add("", "RGB", {2, 2, 2});
  for (std::size_t i = 0; i < 3; ++i) file.add(std::string("m2_p.") + "XYZ"[i], (4 + 3) * white[i] * white[i]);
  file.write(folder / "in.exr");
  const LoadedFrame loaded = read_frame(folder / "in.exr", {.samples_per_pixel = 4});
  CHECK(is_schema(loaded, "mitsuba"));
  for (const auto& variance : loaded.frame().colour_variance) CHECK(variance.at(1, 1) == Approx(1).epsilon(5e-3));
}

TEST_CASE("Cycles: layers, the first of several") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  const auto edit = [](Imf::Header& header) { header.insert("cycles.View.Layer.samples", Imf::StringAttribute("12")); };
  write_file(path, {{.name = "", .channels = cycles_channels(), .edit = edit}});
  expect_error(ErrorCode::kInvalidFrame, {path, "merge"}, [&] { (void)read_frame(path, {.preset = "cycles"}); });
  SECTION("without variances") {
    // Names are in alphabetical order in a file.
    const LoadedFrame loaded = read_frame(path, {.require_variance = false});
    CHECK(is_schema(loaded, "cycles"));
    CHECK(holds(loaded.frame().colour[1], "Other.Combined.G"));
  }
  SECTION("with the features that Cycles made for denoising") {
    auto channels = cycles_channels();
    channels.resize(channels.size() - 4);
    write_file(path, {{.name = "",
                       .channels = channels + layer("View.Layer.Denoising Variance", "RGB", Imf::FLOAT) +
                                   layer("View.Layer.Noisy Image", "RGBA", Imf::FLOAT),
                       .edit = edit}});
    const LoadedFrame loaded = read_frame(path);
    CHECK(holds(loaded.frame().colour[0], "View.Layer.Noisy Image.R"));
    CHECK(holds(loaded.frame().colour_variance[2], "View.Layer.Denoising Variance.B"));
    CHECK(holds(feature(loaded.frame(), "depth").mean[0], "View.Layer.Denoising Depth.Z"));
    CHECK(holds(feature(loaded.frame(), "albedo").mean[2], "View.Layer.Denoising Albedo.B"));
    CHECK(loaded.frame().uniform_sample_count == 12);
    const std::string out = folder / "out.exr";
    stein::exr::write_result(out, loaded, fixture::result_for(loaded.frame()));
    const auto names = fixture::channel_names(out);
    CHECK(std::count(names.begin(), names.end(), "View.Layer.Noisy Image.R") == 1);
    CHECK(std::count(names.begin(), names.end(), "R") == 0);
    CHECK(std::count(names.begin(), names.end(), "View.Layer.Denoising Variance.R") == 0);
    CHECK(fixture::read_raw(out, 0, "View.Layer.DiffCol.R") == fixture::read_raw(path, 0, "View.Layer.DiffCol.R"));
    CHECK(stein::exr::read_planes(out).planes[0].row(0)[0] == 1000);
  }
}

TEST_CASE("Tungsten: one file per buffer") {
  const TemporaryFolder folder;
  const auto part = [](const std::string& components) {
    return std::vector<fixture::PartSpec>{{"", layer("", components, Imf::HALF)}};
  };
  const std::string path = folder / "shot_color.exr";
  write_file(path, part("RGB"));
  expect_error(ErrorCode::kInvalidFrame, {path, "variance.R"}, [&] { (void)read_frame(path); });
  expect_error(ErrorCode::kInvalidArgument, {path, "tungsten", "beside"},
               [&] { (void)read_frame(path, {.preset = "tungsten"}); });
  for (const char* name : {"shot_colorVariance", "shot_albedo", "shot_albedoVariance"}) {
    write_file(folder / (std::string(name) + ".exr"), part("RGB"));
  }
  write_file(folder / "shot_depth.exr", part("Y"));
  const LoadedFrame loaded = read_frame(path);
  CHECK(is_schema(loaded, "tungsten"));
  CHECK(assumes(loaded, "number of samples"));
  CHECK(holds(loaded.frame().colour_variance[1], "G"));
  CHECK(holds(feature(loaded.frame(), "albedo").variance[2], "B"));
  CHECK(holds(feature(loaded.frame(), "depth").mean[0], "Y"));
  stein::exr::write_result(folder / "out.exr", loaded, fixture::result_for(loaded.frame()));
  CHECK(fixture::parts_of(folder / "out.exr") == 1);
  const auto names = fixture::channel_names(folder / "out.exr");
  CHECK(std::count(names.begin(), names.end(), "Y") == 0);
  CHECK(stein::exr::read_planes(folder / "out.exr").planes[0].row(0)[0] == 1000);
}

TEST_CASE("Arnold and RenderMan") {
  const TemporaryFolder folder;
  const std::string path = folder / "in.exr";
  SECTION("noice") {
    write_file(path, {{"", layer("", "RGBA", Imf::HALF) + layer("variance", "RGB", Imf::HALF) +
                               layer("denoise_albedo", "RGB", Imf::HALF) + layer("N", "XYZ", Imf::FLOAT) +
                               layer("N_noice", "XYZ", Imf::FLOAT) + std::vector<ChannelSpec>{{"Z", Imf::FLOAT}}}});
    const LoadedFrame loaded = read_frame(path);
    CHECK(is_schema(loaded, "arnold"));
    CHECK(holds(feature(loaded.frame(), "albedo").mean[0], "denoise_albedo.R"));
    CHECK(holds(feature(loaded.frame(), "normal").mean[1], "N_noice.Y"));
    CHECK(holds(feature(loaded.frame(), "depth").mean[0], "Z"));
  }
  SECTION("denoise_batch") {
    write_file(path, {{"", layer("Ci", "rgb", Imf::HALF) + layer("mse", "rgb", Imf::HALF) +
                               layer("albedo", "rgb", Imf::HALF) + layer("albedo_mse", "rgb", Imf::HALF) +
                               layer("normal", "rgb", Imf::HALF) + layer("normal_mse", "rgb", Imf::HALF) +
                               std::vector<ChannelSpec>{{"a", Imf::HALF}, {"sampleCount", Imf::FLOAT}}}});
    const LoadedFrame loaded = read_frame(path);
    CHECK(is_schema(loaded, "renderman"));
    CHECK(holds(loaded.frame().colour[2], "Ci.b"));
    CHECK(holds(loaded.frame().colour_variance[0], "mse.r"));
    CHECK(holds(feature(loaded.frame(), "albedo").variance[1], "albedo_mse.g"));
    CHECK(holds(loaded.frame().sample_count, "sampleCount"));
  }
  SECTION("denoise") {
    ConstantFile file;
    file.add("", "RGB", {1, 1, 1}).add("mse.", "RGB", {2, 2, 2}).add("normal.", "XYZ", {0, 0, 1});
    file.add("normal_var.", "XYZ", {8, 8, 8}).add("z", 1).add("z_var", 8).add("zfiltered", 5);
    file.add("zfiltered_var", 16).write(path);
    expect_error(ErrorCode::kInvalidFrame, {path, "--samples"}, [&] { (void)read_frame(path); });
    const LoadedFrame loaded = read_frame(path, {.samples_per_pixel = 4});
    CHECK(loaded.frame().colour_variance[0].at(0, 0) == 2);
    CHECK(feature(loaded.frame(), "normal").variance[2].at(0, 0) == 2);
    CHECK(feature(loaded.frame(), "depth").mean[0].at(0, 0) == 5);
    CHECK(feature(loaded.frame(), "depth").variance[0].at(0, 0) == 4);
  }
}

TEST_CASE("variances against the schema") {
  const TemporaryFolder folder;
  ConstantFile file;
  file.add("", "RGB", {1, 1, 1}).add("variance.", "RGB", {9, 9, 9});
  file.write(folder / "in.exr");
  const auto variance = [&](VarianceOf of) {
    const LoadedFrame loaded = read_frame(folder / "in.exr", {.samples_per_pixel = 3, .variance_of = of});
    return loaded.frame().colour_variance[1].at(0, 0);
  };
  CHECK(variance(VarianceOf::kAsStated) == 9);
  CHECK(variance(VarianceOf::kMean) == 9);
  CHECK(variance(VarianceOf::kSample) == 3);
  CHECK(variance(VarianceOf::kSecondMoment) == 4);
}

}  // namespace fixture
