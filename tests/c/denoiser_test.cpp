// SPDX-License-Identifier: Apache-2.0
//
// A denoiser of the caller's among the filters.
#include <cstring>

#include "c/scene.hpp"

namespace stein::test {
namespace {

constexpr std::size_t kPixels = std::size_t{Scene::kWidth} * Scene::kHeight;

struct Calls {
  int count = 0;
  int fail_at = -1;
  std::vector<float> first_red;  // of the last call
};

// The albedo, which is what the scene shows without noise.
int truth(const stein_frame* frame, float* const colour[3], std::ptrdiff_t row_stride, void* user) {
  auto& calls = *static_cast<Calls*>(user);
  if (calls.count++ == calls.fail_at) return 0;
  calls.first_red.resize(kPixels);
  if (stein_frame_copy(frame, "R", calls.first_red.data(), 0, 0) != STEIN_OK) return 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name = std::string("albedo.") + kRgb[c];
    if (stein_frame_copy(frame, name.c_str(), colour[c], 0, row_stride) != STEIN_OK) return 0;
  }
  return 1;
}

}  // namespace

TEST_CASE("C: an added denoiser is called for frame and draws, and mixed") {
  const Scene scene;
  const auto frame = scene.c_frame();
  const auto params = make_params("cross-bilateral");
  Calls calls;
  REQUIRE(stein_params_add_denoiser(params.get(), "truth", truth, &calls, 2, 0.0F, 1) == STEIN_OK);
  const auto result = made<stein_result>(
      [&](stein_result** r) { return stein_denoise(frame.get(), params.get(), nullptr, nullptr, r); });
  CHECK(calls.count == 3);
  std::vector<float> red(kPixels);
  REQUIRE(stein_frame_copy(frame.get(), "R", red.data(), 0, 0) == STEIN_OK);
  CHECK(red[11] == scene.values[7 * 11]);
  CHECK(calls.first_red != red);
  const char* text = nullptr;
  REQUIRE(stein_result_text(result.get(), "filter", 1, &text) == STEIN_OK);
  CHECK(std::strcmp(text, "truth") == 0);
  REQUIRE(stein_result_copy(result.get(), "G", red.data(), 0, 0) == STEIN_OK);
  double error = 0;
  for (std::size_t i = 0; i < kPixels; ++i) error += std::pow(red[i] - scene.values[7 * i + 5], 2) / kPixels;
  CHECK(error < 1e-4);
}

TEST_CASE("C: denoisers that fail, and that cannot be") {
  const Scene scene;
  const auto frame = scene.c_frame();
  const auto params = make_params("cross-bilateral");
  Calls calls;
  const auto add = [&](const char* name, stein_denoiser run, int32_t draws, float step) {
    return stein_params_add_denoiser(params.get(), name, run, &calls, draws, step, 1);
  };
  check_failure(add("", truth, 1, 0), STEIN_INVALID_ARGUMENT, {"stein_params_add_denoiser", "no name"});
  check_failure(add(nullptr, truth, 1, 0), STEIN_INVALID_ARGUMENT, {"the name is null"});
  check_failure(add("truth", nullptr, 1, 0), STEIN_INVALID_ARGUMENT, {"the denoiser is null"});
  check_failure(add("truth", truth, 0, 0), STEIN_INVALID_ARGUMENT, {"'truth'", "0"});
  check_failure(add("truth", truth, 1, 5), STEIN_INVALID_ARGUMENT, {"step", "5"});
  REQUIRE(add("truth", truth, 1, 0) == STEIN_OK);
  check_failure(add("truth", truth, 1, 0), STEIN_INVALID_ARGUMENT, {"'truth'", "of its own"});
  calls.fail_at = 1;
  stein_result* result = nullptr;
  check_failure(stein_denoise(frame.get(), params.get(), nullptr, nullptr, &result), STEIN_INVALID_ARGUMENT,
                {"'truth' failed"});
  CHECK(result == nullptr);
  float value = 0;
  check_failure(stein_frame_copy(frame.get(), "albedo.variance.R", &value, 0, 0), STEIN_INVALID_ARGUMENT,
                {"no plane 'albedo.variance.R'", "albedo.R"});
  check_failure(stein_frame_copy(frame.get(), "R", nullptr, 0, 0), STEIN_INVALID_ARGUMENT, {"memory"});
  check_failure(stein_frame_copy(nullptr, "R", &value, 0, 0), STEIN_INVALID_ARGUMENT, {"frame"});
}

}  // namespace stein::test
