// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "c/scene.hpp"

namespace stein::test {
namespace {

Handle<stein_result> run(const stein_frame* frame, const stein_params* params = nullptr) {
  return made<stein_result>([&](stein_result** r) { return stein_denoise(frame, params, nullptr, nullptr, r); });
}

std::vector<float> copied(const stein_result* result, const std::string& name) {
  std::vector<float> values(std::size_t{Scene::kWidth} * Scene::kHeight);
  REQUIRE(stein_result_copy(result, name.c_str(), values.data(), 0, 0) == STEIN_OK);
  return values;
}

double bad_layer_pixels(const stein_result* result) {
  double value = -1;
  REQUIRE(stein_result_number(result, "bad_layer_pixels", &value) == STEIN_OK);
  return value;
}

}  // namespace

TEST_CASE("C: layers come back filtered, with the weights of the colour") {
  const Scene scene;
  const auto frame = scene.c_frame();
  REQUIRE(stein_frame_add_layer(frame.get(), "key", 3) == STEIN_OK);
  REQUIRE(stein_frame_add_layer(frame.get(), "A", 1) == STEIN_OK);
  for (std::size_t c = 0; c < 3; ++c) REQUIRE(scene.set(frame.get(), std::string("key.") + kRgb[c], c) == STEIN_OK);
  std::vector<float> alpha(std::size_t{Scene::kWidth} * Scene::kHeight, 0.75F);
  alpha[60] = std::numeric_limits<float>::quiet_NaN();
  REQUIRE(stein_frame_set_plane(frame.get(), "A", STEIN_FLOAT32, alpha.data(), 0, 0) == STEIN_OK);
  const auto params = make_params("cross-bilateral");
  const auto result = run(frame.get(), params.get());
  for (const char* c : kRgb) CHECK(copied(result.get(), std::string("key.") + c) == copied(result.get(), c));
  CHECK(copied(result.get(), "R")[0] != scene.values[0]);
  for (const float value : copied(result.get(), "A")) CHECK(value == Approx(0.75).epsilon(2e-6));
  CHECK(bad_layer_pixels(result.get()) == 1);
  CHECK(bad_layer_pixels(run(scene.c_frame().get()).get()) == 0);
}

TEST_CASE("C: layers that cannot be") {
  const Scene scene;
  const auto frame = scene.c_frame();
  const auto add = [&](const char* name, int32_t channels) {
    return stein_frame_add_layer(frame.get(), name, channels);
  };
  check_failure(add("key", 2), STEIN_INVALID_ARGUMENT, {"stein_frame_add_layer", "'key'", "2 channels"});
  check_failure(add("", 1), STEIN_INVALID_ARGUMENT, {"name"});
  check_failure(add(nullptr, 1), STEIN_INVALID_ARGUMENT, {"name"});
  check_failure(stein_frame_add_layer(nullptr, "key", 3), STEIN_INVALID_ARGUMENT, {"frame"});
  check_failure(add("G", 1), STEIN_INVALID_ARGUMENT, {"'G'", "already"});
  REQUIRE(add("key", 3) == STEIN_OK);
  check_failure(add("key", 3), STEIN_INVALID_ARGUMENT, {"'key.R'", "already"});
  check_failure(stein_frame_set_plane(frame.get(), "fill.R", STEIN_FLOAT32, scene.values.data(), 0, 0),
                STEIN_INVALID_ARGUMENT, {"'fill.R'", "key.R key.G key.B"});
  stein_result* result = nullptr;
  check_failure(stein_denoise(frame.get(), nullptr, nullptr, nullptr, &result), STEIN_INVALID_FRAME,
                {"'key.R'", "missing"});
}

}  // namespace stein::test
