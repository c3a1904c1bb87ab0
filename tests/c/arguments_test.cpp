// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "c/scene.hpp"

namespace stein::test {
namespace {

const float kValue = 1;

stein_status set_plane(stein_frame* frame, const char* name) {
  return stein_frame_set_plane(frame, name, STEIN_FLOAT32, &kValue, 0, 0);
}

Handle<stein_frame> make_frame(int32_t width, int32_t height) {
  return made<stein_frame>([&](stein_frame** f) { return stein_frame_create(width, height, f); });
}

void check_no_result(const stein_frame* frame, const stein_params* params, stein_status code,
                     const std::vector<std::string>& parts) {
  stein_result* result = reinterpret_cast<stein_result*>(0x10);
  check_failure(stein_denoise(frame, params, nullptr, nullptr, &result), code, parts);
  CHECK(result == nullptr);
}

}  // namespace

TEST_CASE("C: header and library have one version") { CHECK(stein_version() == STEIN_VERSION); }

TEST_CASE("C: destroying nothing is nothing") {
  stein_frame_destroy(nullptr);
  stein_params_destroy(nullptr);
  stein_result_destroy(nullptr);
  stein_film_destroy(nullptr);
}

TEST_CASE("C: null is refused and named") {
  const auto frame = make_frame(1, 1);
  const auto params = make_params(nullptr);
  const auto refused = [](stein_status status, const char* what) {
    check_failure(status, STEIN_INVALID_ARGUMENT, {what, "null"});
  };
  refused(stein_frame_create(1, 1, nullptr), "stein_frame_create");
  refused(stein_frame_add_feature(nullptr, "albedo", 3), "stein_frame_add_feature: the frame");
  refused(stein_frame_add_feature(frame.get(), nullptr, 3), "the name");
  refused(set_plane(nullptr, "R"), "stein_frame_set_plane: the frame");
  refused(set_plane(frame.get(), nullptr), "the name");
  refused(stein_frame_set_plane(frame.get(), "R", STEIN_FLOAT32, nullptr, 0, 0), "plane 'R'");
  refused(stein_frame_set_sample_count(nullptr, 1), "the frame");
  refused(stein_frame_set_degrees_of_freedom(nullptr, 1), "the frame");
  refused(stein_params_create(nullptr, nullptr), "stein_params_create");
  refused(stein_params_set_text(nullptr, "risk", "sure"), "the parameters");
  refused(stein_params_set_text(params.get(), nullptr, "sure"), "the name");
  refused(stein_params_set_text(params.get(), "risk", nullptr), "the value");
  refused(stein_params_set_number(nullptr, "strength", 1), "the parameters");
  refused(stein_params_set_number(params.get(), nullptr, 1), "the name");
  refused(stein_denoise(frame.get(), nullptr, nullptr, nullptr, nullptr), "stein_denoise");
  check_no_result(nullptr, nullptr, STEIN_INVALID_ARGUMENT, {"the frame is null"});
}

TEST_CASE("C: results refuse what they do not have") {
  const Scene scene;
  const auto result = made<stein_result>(
      [&](stein_result** r) { return stein_denoise(scene.c_frame().get(), nullptr, nullptr, nullptr, r); });
  const float* data = &kValue;
  ptrdiff_t stride = 0;
  double number = 0;
  const char* text = "";
  float value = 0;
  constexpr stein_status kRefused = STEIN_INVALID_ARGUMENT;
  check_failure(stein_result_plane(nullptr, "R", &data, &stride), kRefused, {"the result is null"});
  check_failure(stein_result_plane(result.get(), nullptr, &data, &stride), kRefused, {"the name is null"});
  check_failure(stein_result_plane(result.get(), "R", nullptr, &stride), kRefused, {"null"});
  check_failure(stein_result_plane(result.get(), "R", &data, nullptr), kRefused, {"the row stride is null"});
  check_failure(stein_result_plane(result.get(), "A", &data, &stride), kRefused, {"'A'", "density.V"});
  CHECK(data == nullptr);
  check_failure(stein_result_copy(result.get(), "R", nullptr, 0, 0), kRefused, {"null"});
  check_failure(stein_result_copy(result.get(), "R", &value, 3, 0), kRefused, {"pixel stride is 3"});
  check_failure(stein_result_number(result.get(), "mean_error", &number), kRefused, {"'mean_error'", "mean_error.R"});
  check_failure(stein_result_number(result.get(), "mean_error.R", nullptr), kRefused, {"null"});
  check_failure(stein_result_text(result.get(), "warnings", 0, &text), kRefused, {"'warnings'", "warning"});
  CHECK(text == nullptr);
  check_failure(stein_result_text(result.get(), "risk", -1, &text), kRefused, {"-1"});
  CHECK(stein_result_text(result.get(), "risk", 2, &text) == STEIN_OK);
  CHECK(text == nullptr);
}

TEST_CASE("C: frames refuse sizes, planes, types and strides that cannot be") {
  stein_frame* none = nullptr;
  for (const auto& [width, height] : {std::pair{0, 1}, {1, 0}, {-1, 1}, {(1 << 20) + 1, 1}}) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    check_failure(stein_frame_create(width, height, &none), STEIN_INVALID_ARGUMENT, {size, "1048576"});
    CHECK(none == nullptr);
  }
  const auto frame = make_frame(4, 4);
  check_failure(set_plane(frame.get(), "varaince.R"), STEIN_INVALID_ARGUMENT,
                {"'varaince.R'", "stein_frame_add_feature", "variance.R"});
  check_failure(set_plane(frame.get(), "albedo.R"), STEIN_INVALID_ARGUMENT, {"'albedo.R'"});
  REQUIRE(stein_frame_add_feature(frame.get(), "albedo", 3) == STEIN_OK);
  CHECK(set_plane(frame.get(), "albedo.R") == STEIN_OK);
  check_failure(set_plane(frame.get(), "albedo.X"), STEIN_INVALID_ARGUMENT, {"'albedo.X'", "covariance.B.albedo.G"});
  const auto with = [&](stein_type type, ptrdiff_t pixel, ptrdiff_t row) {
    return stein_frame_set_plane(frame.get(), "R", type, &kValue, pixel, row);
  };
  check_failure(with(3, 0, 0), STEIN_INVALID_ARGUMENT, {"type 3", "STEIN_FLOAT16"});
  check_failure(with(STEIN_FLOAT32, 3, 0), STEIN_INVALID_ARGUMENT, {"plane 'R'", "pixel stride is 3", "bytes"});
  check_failure(with(STEIN_FLOAT32, 4, -2), STEIN_INVALID_ARGUMENT, {"row stride is -2"});
  constexpr ptrdiff_t kLeast = std::numeric_limits<ptrdiff_t>::min();
  check_failure(with(STEIN_FLOAT32, kLeast, 0), STEIN_INVALID_ARGUMENT,
                {"pixel stride is -92", "more than any memory"});
  check_failure(with(STEIN_FLOAT32, 0, kLeast), STEIN_INVALID_ARGUMENT, {"row stride is -92", "more than any memory"});
  check_failure(with(STEIN_FLOAT32, ptrdiff_t{1} << 40, 0), STEIN_INVALID_ARGUMENT, {"row stride is 4398046511104"});
  CHECK(with(STEIN_FLOAT16, 2, -8) == STEIN_OK);
}

TEST_CASE("C: features need names and channels of their own") {
  const auto frame = make_frame(4, 4);
  REQUIRE(stein_frame_add_feature(frame.get(), "depth", 1) == STEIN_OK);
  check_failure(stein_frame_add_feature(frame.get(), "depth", 1), STEIN_INVALID_ARGUMENT, {"'depth'", "unique"});
  check_failure(stein_frame_add_feature(frame.get(), "", 1), STEIN_INVALID_ARGUMENT, {"no name"});
  check_failure(stein_frame_add_feature(frame.get(), "uv", 5), STEIN_INVALID_ARGUMENT, {"'uv'", "5 channels"});
  check_failure(stein_frame_add_feature(frame.get(), "a.b", 1), STEIN_INVALID_ARGUMENT, {"'a.b'", "dot"});
}

TEST_CASE("C: sample counts and degrees of freedom have limits") {
  const auto frame = make_frame(4, 4);
  check_failure(stein_frame_set_sample_count(frame.get(), 0.5F), STEIN_INVALID_ARGUMENT, {"sample count is 0.5"});
  check_failure(stein_frame_set_sample_count(frame.get(), NAN), STEIN_INVALID_ARGUMENT, {"nan"});
  check_failure(stein_frame_set_degrees_of_freedom(frame.get(), -1), STEIN_INVALID_ARGUMENT, {"freedom is -1"});
}

TEST_CASE("C: a frame that lacks something is refused with the plane's name") {
  const Scene scene;
  const auto frame =
      made<stein_frame>([](stein_frame** f) { return stein_frame_create(Scene::kWidth, Scene::kHeight, f); });
  const auto lacks = [&](const char* what) { check_no_result(frame.get(), nullptr, STEIN_INVALID_FRAME, {what}); };
  lacks("'R'");
  for (const char* c : kRgb) REQUIRE(scene.set(frame.get(), c, 0) == STEIN_OK);
  for (const char* c : kRgb) REQUIRE(scene.set(frame.get(), std::string("variance.") + c, 3) == STEIN_OK);
  lacks("sampleCount");
  REQUIRE(stein_frame_set_sample_count(frame.get(), 4) == STEIN_OK);
  REQUIRE(stein_frame_add_feature(frame.get(), "depth", 1) == STEIN_OK);
  lacks("'depth.Z'");
  REQUIRE(scene.set(frame.get(), "depth.Z", 4) == STEIN_OK);
  REQUIRE(scene.set(frame.get(), "covariance.G.depth.Z", 3) == STEIN_OK);
  lacks("'depth' has covariances");
  REQUIRE(scene.set(frame.get(), "depth.variance.Z", 3) == STEIN_OK);
  lacks("'covariance.R.depth.Z'");
}

TEST_CASE("C: of a plane of counts and one count for all, the last one set holds") {
  Scene scene;
  scene.values[0] = 0;  // no samples in the first pixel, where R is the plane of counts
  const auto frame = scene.c_frame();
  const auto invalid = [&] {
    const auto result =
        made<stein_result>([&](stein_result** r) { return stein_denoise(frame.get(), nullptr, nullptr, nullptr, r); });
    double count = -1;
    REQUIRE(stein_result_number(result.get(), "invalid_pixels", &count) == STEIN_OK);
    return count;
  };
  CHECK(invalid() == 0);
  REQUIRE(scene.set(frame.get(), "sampleCount", 0) == STEIN_OK);
  CHECK(invalid() >= 1);
  REQUIRE(stein_frame_set_sample_count(frame.get(), 8) == STEIN_OK);
  CHECK(invalid() == 0);
}

TEST_CASE("C: options that are unknown, misplaced or out of range are refused and change nothing") {
  const Scene scene;
  const auto frame = scene.c_frame();
  stein_params* none = nullptr;
  check_failure(stein_params_create("median", &none), STEIN_INVALID_ARGUMENT, {"'median'", "cross-bilateral"});
  CHECK(none == nullptr);
  const auto params = make_params("gaussian");
  const auto text = [&](const char* name, const char* value) {
    return stein_params_set_text(params.get(), name, value);
  };
  const auto number = [&](const char* name, double value) {
    return stein_params_set_number(params.get(), name, value);
  };
  constexpr stein_status kRefused = STEIN_INVALID_ARGUMENT;
  check_failure(text("riks", "sure"), kRefused, {"'riks'", "risk", "feature-sigma.<feature>"});
  check_failure(text("strength", "1"), kRefused, {"strength is a number"});
  check_failure(number("risk", 1), kRefused, {"risk is a text"});
  check_failure(text("risk", "none"), kRefused, {"'none'", "monte-carlo"});
  check_failure(text("order", "1"), kRefused, {"'gaussian' has no option order"});
  check_failure(text("order-error", "risk"), kRefused, {"'gaussian' has no option order-error"});
  check_failure(number("range-sigma", 1), kRefused, {"'gaussian' has no option range-sigma"});
  check_failure(number("feature-sigma.albedo", 1), kRefused, {"'gaussian' has no option feature-sigma.albedo"});
  check_failure(number("feature-sigma.", 1), kRefused, {"no option 'feature-sigma.'"});
  check_failure(number("strength", 1.5), kRefused, {"strength is 1.5"});
  check_failure(number("strength", std::numeric_limits<double>::quiet_NaN()), kRefused, {"nan"});
  check_failure(number("draws", 0), kRefused, {"draws is 0"});
  check_failure(number("draws", 1.5), kRefused, {"draws is 1.5", "whole"});
  check_failure(number("seed", 1e17), kRefused, {"seed", "9007199254740992"});
  check_failure(number("strict", 2), kRefused, {"strict is 2"});
  check_failure(number("threads", -1), kRefused, {"threads is -1"});
  check_failure(number("tile-width", 3), kRefused, {"tile_width is 3"});
  const auto atrous = make_params("atrous");
  check_failure(stein_params_set_text(atrous.get(), "bank", "final"), kRefused, {"'atrous' has no option bank"});
  // Had one of them been kept, this would fail.
  stein_result* result = nullptr;
  CHECK(stein_denoise(frame.get(), params.get(), nullptr, nullptr, &result) == STEIN_OK);
  stein_result_destroy(result);
}

TEST_CASE("C: a sigma for a feature that the frame does not have is refused") {
  const Scene scene;
  const auto params = make_params(nullptr);
  REQUIRE(stein_params_set_number(params.get(), "feature-sigma.normal", 0.4) == STEIN_OK);
  check_no_result(scene.c_frame().get(), params.get(), STEIN_INVALID_ARGUMENT, {"'normal'", "it has: albedo"});
}

TEST_CASE("C: strict turns a value that would be repaired into an error that names it") {
  Scene scene;
  scene.values[7 * 3 + 1] = std::numeric_limits<float>::infinity();
  const auto params = make_params(nullptr);
  REQUIRE(stein_params_set_number(params.get(), "strict", 1) == STEIN_OK);
  check_no_result(scene.c_frame().get(), params.get(), STEIN_INVALID_FRAME, {"'G'", "(3, 0)"});
}

}  // namespace stein::test
