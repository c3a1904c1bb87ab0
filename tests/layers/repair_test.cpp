// SPDX-License-Identifier: Apache-2.0
//
// Layers with values that cannot be used, and layers that cannot be a layer.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "catch.hpp"
#include "layers/split.hpp"
#include "stein/error.hpp"

namespace stein::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::string message_of(const Frame& frame, const DenoiseParams& params = {}) {
  try {
    static_cast<void>(denoise(frame, params));
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::kInvalidFrame);
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("layers: a value that cannot be used is filled from its neighbours, counted and told of") {
  SplitFrame split(40, 30, 51);
  split.add_constant("A", 0.5F);
  split.add_parts(1);
  split.plane("A", 0).row(11)[10] = kNan;
  split.plane("A", 0).row(12)[10] = 2e15F;
  split.plane("key", 2).row(20)[30] = -kInfinity;
  for (const std::vector<FilterSpec>& filters : layer_filters()) {
    DenoiseParams params;
    params.filters = filters;
    const DenoiseResult result = denoise(split.frame(), params);
    CHECK(result.report.frame.invalid_pixels == 0);
    CHECK(result.report.frame.bad_layer_pixels == std::vector<std::int64_t>{2, 1, 0, 0});
    const BadValue& first = result.report.frame.first_bad_layer.at(0);
    CHECK((first.plane == "A" && first.x == 10 && first.y == 11));
    CHECK(result.report.frame.first_bad_layer.at(1).plane == "key.B");
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        CHECK(result.layers[0].mean[0].row(y)[x] == Approx(0.5).epsilon(2e-6));
        for (std::size_t c = 0; c < 3; ++c) CHECK(std::isfinite(result.layers[1].mean[c].row(y)[x]));
      }
    }
    std::size_t told = 0;
    for (const std::string& warning : result.report.warnings) told += warning.find("layer '") == 0 ? 1U : 0U;
    CHECK(told == 2);
  }
}

TEST_CASE("layers: where the colour is unusable the layers are filled as it is, whatever they hold") {
  SplitFrame split(40, 30, 52);
  split.add_parts(2);
  split.owned().at("G", 7, 7) = kNan;
  for (const char* name : {"key", "fill", "rim"}) split.plane(name, 1).row(7)[7] = kNan;
  split.owned().at("sampleCount", 20, 20) = 0.0F;
  split.plane("key", 0).row(20)[20] = 1e4F;
  const DenoiseResult result = denoise(split.frame());
  CHECK(result.report.frame.invalid_pixels == 2);
  CHECK(result.report.frame.bad_layer_pixels == std::vector<std::int64_t>{0, 0, 0});
  CHECK(error_of_sum(result) < 1e-5);
}

TEST_CASE("layers: strict refuses what would be repaired") {
  SplitFrame split(20, 20, 53);
  split.add_parts(3);
  split.plane("fill", 1).row(3)[4] = kNan;
  DenoiseParams strict;
  strict.strict = true;
  const std::string message = message_of(split.frame(), strict);
  for (const char* part : {"'fill.G'", "(4, 3)", "layer 'fill'"}) CHECK(message.find(part) != std::string::npos);
}

TEST_CASE("layers: one without a usable value is refused") {
  SplitFrame split(20, 20, 54);
  split.add_constant("A", kNan);
  CHECK(message_of(split.frame()).find("layer 'A'") != std::string::npos);
}

}  // namespace stein::test
