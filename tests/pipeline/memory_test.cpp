// SPDX-License-Identifier: Apache-2.0
//
// Under a memory limit that sends everything to scratch files results have the bits that they have without.
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "catch.hpp"
#include "exr/expect_error.hpp"
#include "exr/file_size_limit.hpp"
#include "stein/denoise.hpp"
#include "stein/options.hpp"
#include "support/same_bits.hpp"
#include "support/sanitizers.hpp"
#include "support/synthetic.hpp"
#include "support/temporary_folder.hpp"

namespace stein::test {
namespace {

constexpr std::int64_t kLeast = std::int64_t{1} << 27;

using stein::test::same_bits;  // of planes, beside that of results

bool same_bits(const DenoiseResult& a, const DenoiseResult& b) {
  bool same = same_bits(a.choice, b.choice) && same_bits(a.density, b.density) && a.layers.size() == b.layers.size();
  for (std::size_t c = 0; c < 3; ++c) same = same && same_bits(a.colour[c], b.colour[c]);
  for (std::size_t c = 0; c < 3; ++c) same = same && same_bits(a.error[c], b.error[c]);
  for (std::size_t l = 0; same && l < a.layers.size(); ++l) {
    for (std::size_t c = 0; c < 3; ++c) same = same && same_bits(a.layers[l].mean[c], b.layers[l].mean[c]);
  }
  return same && same_errors(a.report, b.report) && a.report.choice_share == b.report.choice_share;
}

// With an outlier, holes, and a layer.
class Scene {
 public:
  Scene(int width, int height) : owned_(width, height, kUsualFeatures) {
    fill_random(owned_, 41);
    owned_.at("R", 20, 20) = 500.0F;
    owned_.at("variance.R", 20, 20) = 250000.0F;
    owned_.at("G", 9, 13) = std::numeric_limits<float>::quiet_NaN();
    owned_.at("sampleCount", 0, 5) = 0.0F;
    owned_.at("normal.X", 30, 30) = std::numeric_limits<float>::infinity();
    const std::array<ConstPlaneView, 3>& colour = owned_.frame().colour;
    owned_.frame().layers.push_back({"key", {colour.begin(), colour.end()}});
  }
  [[nodiscard]] const Frame& frame() const { return owned_.frame(); }

 private:
  OwnedFrame owned_;
};

}  // namespace

TEST_CASE("denoise: everything in scratch files gives identical bits, for every filter and for several") {
#if STEIN_HAS_TSAN || STEIN_HAS_ASAN
  const Scene scene(50, 70);
#else
  const Scene scene(70, 300);
#endif
  const TemporaryFolder folder;
  // With this many pages in use the files are trimmed after each tile.
  const std::vector<char> ballast(static_cast<std::size_t>(kLeast), 'b');
  std::vector<DenoiseParams> all(2);
  all[0].filters = {CrossBilateralParams{}, AtrousSureParams{}};
  all[1].filters = {CrossBilateralParams{}};
  all[1].risk = Risk::kMonteCarlo;
  for (const std::string_view name : filter_names()) all.emplace_back().filters = {make_filter(name)};
  for (DenoiseParams& params : all) {
    if (auto* nlm = std::get_if<CrossNlmParams>(&params.filters.front())) nlm->window_radius = 4;  // time
    if (auto* regression = std::get_if<AdaptiveOrderParams>(&params.filters.front())) regression->window_radius = 4;
    params.execution.tile_width = 32;
    params.execution.tile_height = 8;
    const DenoiseResult reference = denoise(scene.frame(), params);
    CHECK(reference.report.scratch_bytes == 0);
    for (const int threads : {1, 3}) {
      params.execution.threads = threads;
      params.execution.memory = std::make_shared<Memory>(MemoryLimit{kLeast, folder.path().string(), 0.0});
      const DenoiseResult limited = denoise(scene.frame(), params);
      INFO(filter_name(params.filters.front()) << ", " << threads << " threads");
      CHECK(same_bits(reference, limited));
      CHECK(limited.report.scratch_bytes > 11LL * 4 * scene.frame().width * scene.frame().height);
    }
  }
  CHECK(folder.entries() == 0);
  CHECK(ballast.back() == 'b');
}

TEST_CASE("denoise: other denoisers' images and weights in scratch files give identical bits") {
  OwnedFrame owned(90, 170, kUsualFeatures);
  fill_random(owned, 41);
  owned.at("G", 9, 13) = std::numeric_limits<float>::quiet_NaN();
  const Frame& frame = owned.frame();
  const TemporaryFolder folder;
  DenoiseParams params;
  params.filters = {GaussianParams{}, AtrousParams{}};
  std::vector<std::int64_t> held;  // in scratch files, when the denoiser is called
  params.candidates.push_back({"other", ExternalDenoiser{.run = [&](const Frame& given) {
                                 std::array<Plane, 3> image = Plane::triple(given.width, given.height);
                                 for (std::size_t c = 0; c < 3; ++c) {
                                   for (int y = 0; y < given.height; ++y)
                                     given.colour[c].read_row(y, 0, given.width, image[c].row(y));
                                 }
                                 if (params.execution.memory)
                                   held.push_back(params.execution.memory->usage().scratch_bytes);
                                 return image;
                               }}});
  const DenoiseResult reference = denoise(frame, params);
  const std::vector<char> ballast(static_cast<std::size_t>(kLeast), 'b');
  params.execution.memory = std::make_shared<Memory>(MemoryLimit{kLeast, folder.path().string(), 0.0});
  CHECK(same_bits(reference, denoise(frame, params)));
  REQUIRE(held.size() == 2);
  constexpr std::int64_t kPlane = std::int64_t{90} * 170 * 4;
  CHECK(held[1] - held[0] >= 3 * kPlane);  // the moved colour at least
  CHECK(ballast.back() == 'b');
}

TEST_CASE("denoise: windows in scratch files are warned of, with what would hold them") {
  const Scene scene(70, 60);
  const TemporaryFolder folder;
  DenoiseParams params;
  params.filters = {GaussianParams{}};
  params.execution.memory = std::make_shared<Memory>(MemoryLimit{kLeast, folder.path().string(), 0.0});
  const DenoiseReport report = denoise(scene.frame(), params).report;
  const std::string allow = "allow " + std::to_string(2 * params.execution.memory->usage().window_bytes) + " bytes";
  CHECK(std::any_of(report.warnings.begin(), report.warnings.end(),
                    [&](const std::string& text) { return text.find(allow) != std::string::npos; }));
}

TEST_CASE("denoise: a limit by name") {
  const TemporaryFolder folder;
  DenoiseParams params;
  set_option(params, "max-memory", 2147483648.0);
  set_option(params, "scratch", folder.path().string());
  REQUIRE(params.execution.memory);
  CHECK(params.execution.memory->limit().bytes == std::int64_t{1} << 31);
  CHECK(params.execution.memory->limit().scratch_folder == folder.path().string());
  CHECK_NOTHROW(check(params));
  set_option(params, "max-memory", 0.0);
  expect_error(ErrorCode::kInvalidArgument, {"scratch", "max-memory"}, [&] { check(params); });
  expect_error(ErrorCode::kInvalidArgument, {"1000000 bytes"}, [&] { set_option(params, "max-memory", 1e6); });
  expect_error(ErrorCode::kInvalidArgument, {"max-memory"}, [&] { set_option(params, "max-memory", 2.5); });
  expect_error(ErrorCode::kIo, {"/nowhere"}, [&] { set_option(params, "scratch", std::string("/nowhere")); });
}

TEST_CASE("denoise: cancelled or out of room, it leaves no scratch files") {
  const Scene scene(70, 300);
  const TemporaryFolder folder;
  DenoiseParams params;
  params.filters = {GaussianParams{}};
  params.execution.memory = std::make_shared<Memory>(MemoryLimit{kLeast, folder.path().string(), 0.0});
  params.execution.progress = [](double done) { return done < 0.5; };
  expect_error(ErrorCode::kCancelled, {}, [&] { (void)denoise(scene.frame(), params); });
  params.execution.progress = {};
  {
    const FileSizeLimit limit(100'000);
    expect_error(ErrorCode::kIo, {"no room for", "bytes"}, [&] { (void)denoise(scene.frame(), params); });
  }
  CHECK(folder.entries() == 0);
}

}  // namespace stein::test
