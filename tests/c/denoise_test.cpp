// SPDX-License-Identifier: Apache-2.0
#include "stein/denoise.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "c/scene.hpp"

namespace stein::test {
namespace {

Handle<stein_result> run(const stein_frame* frame, const stein_params* params = nullptr) {
  return made<stein_result>([&](stein_result** r) { return stein_denoise(frame, params, nullptr, nullptr, r); });
}

std::vector<float> copied(const stein_result* result, const char* name) {
  std::vector<float> values(std::size_t{Scene::kWidth} * Scene::kHeight);
  REQUIRE(stein_result_copy(result, name, values.data(), 0, 0) == STEIN_OK);
  return values;
}

bool same_bits(const stein_result* result, const char* name, const Plane& expected) {
  const float* data = nullptr;
  ptrdiff_t row_stride = 0;
  REQUIRE(stein_result_plane(result, name, &data, &row_stride) == STEIN_OK);
  const std::vector<float> copy = copied(result, name);
  for (int y = 0; y < expected.height(); ++y) {
    const float* row = data + y * (row_stride / static_cast<ptrdiff_t>(sizeof(float)));
    if (!std::equal(row, row + expected.width(), expected.row(y))) return false;
    if (!std::equal(row, row + expected.width(), copy.data() + y * expected.width())) return false;
  }
  return true;
}

void check_same(const stein_result* result, const DenoiseResult& expected) {
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(same_bits(result, kRgb[c], expected.colour[c]));
    CHECK(same_bits(result, (std::string("error.") + kRgb[c]).c_str(), expected.error[c]));
  }
  CHECK(same_bits(result, "choice.V", expected.choice));
  CHECK(same_bits(result, "density.V", expected.density));
}

double number(const stein_result* result, const char* name) {
  double value = -1;
  REQUIRE(stein_result_number(result, name, &value) == STEIN_OK);
  return value;
}

std::vector<std::string> texts(const stein_result* result, const char* name) {
  std::vector<std::string> all;
  const char* text = nullptr;
  for (int32_t i = 0; stein_result_text(result, name, i, &text) == STEIN_OK && text != nullptr; ++i)
    all.emplace_back(text);
  return all;
}

}  // namespace

TEST_CASE("C: all planes and the report are bit for bit those of stein::denoise") {
  const Scene scene;
  const auto result = run(scene.c_frame().get());
  const DenoiseResult expected = denoise(scene.frame());
  check_same(result.get(), expected);
  CHECK(number(result.get(), "mean_error.G") == expected.report.mean_error[1]);
  CHECK(number(result.get(), "mean_relative_error") == expected.report.mean_relative_error);
  CHECK(number(result.get(), "invalid_pixels") == 0);
  CHECK(texts(result.get(), "candidate") == expected.report.candidates);
  CHECK(texts(result.get(), "warning") == expected.report.warnings);
  REQUIRE(texts(result.get(), "filter").size() == expected.report.filters.size());
  for (std::size_t f = 0; f < expected.report.filters.size(); ++f) {
    CHECK(texts(result.get(), "filter")[f] == expected.report.filters[f].name);
    CHECK(texts(result.get(), "risk")[f] == expected.report.filters[f].risk);
    CHECK(texts(result.get(), "risk_reason")[f] == expected.report.filters[f].risk_reason);
    const FilterShare& share = expected.report.filters[f];
    CHECK(number(result.get(), ("weight." + share.name).c_str()) == share.weight);
    CHECK(number(result.get(), ("mean_relative_error." + share.name).c_str()) == share.mean_relative_error.value());
  }
}

TEST_CASE("C: planes of features' variances and covariances, and of counts, arrive where they belong") {
  Scene scene;
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0F, 0.05F);
  for (std::size_t i = 0; i < scene.values.size(); ++i) {
    if (i % 7 > 3) scene.values[i] += noise(random);
  }
  const auto params = make_params("cross-nlm");  // its result depends on neighbours' colours and features alike
  const auto c_frame = scene.c_frame();
  Frame frame = scene.frame();
  Feature& albedo = frame.features[0];
  std::vector<std::vector<float>> planes;  // each of another value
  const auto set = [&](const std::string& name, float scale = 1e-4F) {
    planes.emplace_back(std::size_t{Scene::kWidth} * Scene::kHeight, scale * static_cast<float>(planes.size() + 1));
    REQUIRE(stein_frame_set_plane(c_frame.get(), name.c_str(), STEIN_FLOAT32, planes.back().data(), 0, 0) == STEIN_OK);
    return ConstPlaneView(planes.back().data(), Scene::kWidth, Scene::kHeight);
  };
  for (const char* k : kRgb) albedo.variance.push_back(set(std::string("albedo.variance.") + k, 1e-2F));
  for (const char* c : kRgb) {
    for (const char* k : kRgb) albedo.colour_covariance.push_back(set(std::string("covariance.") + c + ".albedo." + k));
  }
  frame.colour_covariance = {set("covariance.R.G"), set("covariance.R.B"), set("covariance.G.B")};
  const std::vector<std::uint32_t> counts(planes[0].size(), 5);
  frame.sample_count = ConstPlaneView(counts.data(), ScalarType::kUint32, Scene::kWidth, Scene::kHeight);
  REQUIRE(stein_frame_set_plane(c_frame.get(), "sampleCount", STEIN_UINT32, counts.data(), 0, 0) == STEIN_OK);
  DenoiseParams cross_nlm;
  cross_nlm.filters = {CrossNlmParams{}};
  const auto result = run(c_frame.get(), params.get());
  check_same(result.get(), denoise(frame, cross_nlm));
  // Mixed up they would make another result.
  const auto differs = [&] { return !same_bits(result.get(), "error.R", denoise(frame, cross_nlm).error[0]); };
  std::swap(frame.colour_covariance[0], frame.colour_covariance[1]);
  CHECK(differs());
  std::swap(frame.colour_covariance[0], frame.colour_covariance[1]);
  std::swap(albedo.colour_covariance[1], albedo.colour_covariance[2]);
  CHECK(differs());
  std::swap(albedo.colour_covariance[1], albedo.colour_covariance[2]);
  albedo.variance[2] = albedo.variance[0];
  CHECK(differs());
}

TEST_CASE("C: strides may be negative and the result may replace the input") {
  Scene scene;
  const auto upright = run(scene.c_frame().get());
  const auto flipped = run(scene.c_frame(true).get());
  REQUIRE(stein_result_copy(flipped.get(), "G", scene.values.data() + 1, Scene::kPixelStride, 0) == STEIN_OK);
  const auto expected = copied(flipped.get(), "G");
  for (std::size_t i = 0; i < expected.size(); ++i) REQUIRE(scene.values[7 * i + 1] == expected[i]);
  // The step is upright: what is above is below.
  CHECK(std::abs(copied(upright.get(), "G").front() - expected[expected.size() - Scene::kWidth]) < 0.05F);
}

TEST_CASE("C: options change what they say") {
  const Scene scene;
  const auto frame = scene.c_frame();
  const auto params = make_params("cross-nlm");
  REQUIRE(stein_params_set_text(params.get(), "bank", "intermediate") == STEIN_OK);
  REQUIRE(stein_params_set_text(params.get(), "selection", "argmin") == STEIN_OK);
  REQUIRE(stein_params_set_text(params.get(), "risk", "monte-carlo") == STEIN_OK);
  for (const auto& [name, value] : std::vector<std::pair<const char*, double>>{{"feature-sigma.albedo", 0.5},
                                                                               {"strength", 0.75},
                                                                               {"draws", 2},
                                                                               {"seed", 7},
                                                                               {"outliers", 0},
                                                                               {"strict", 1},
                                                                               {"threads", 2},
                                                                               {"tile-width", 32},
                                                                               {"tile-height", 16}}) {
    INFO(name);
    REQUIRE(stein_params_set_number(params.get(), name, value) == STEIN_OK);
  }
  CrossNlmParams filter = intermediate_cross_nlm();
  filter.guides.feature_sigmas = {{"albedo", 0.5F}};
  DenoiseParams expected;
  expected.filters = {filter};
  expected.selection = Selection::kArgmin;
  expected.risk = Risk::kMonteCarlo;
  expected.strength = 0.75F;
  expected.monte_carlo.draws = 2;
  expected.monte_carlo.seed = 7;
  expected.outliers.enabled = false;
  check_same(run(frame.get(), params.get()).get(), denoise(scene.frame(), expected));
}

TEST_CASE("C: options of the regression") {
  const Scene scene;
  const auto params = make_params("adaptive-order");
  REQUIRE(stein_params_set_text(params.get(), "order", "1") == STEIN_OK);
  REQUIRE(stein_params_set_text(params.get(), "order-error", "taylor") == STEIN_OK);
  REQUIRE(stein_params_set_text(params.get(), "bank", "intermediate") == STEIN_OK);
  AdaptiveOrderParams filter = intermediate_adaptive_order();
  filter.orders = {1};
  filter.error = OrderError::kTaylor;
  DenoiseParams expected;
  expected.filters = {filter};
  check_same(run(scene.c_frame().get(), params.get()).get(), denoise(scene.frame(), expected));
}

TEST_CASE("C: an option set back to its default gives the default's result") {
  const Scene scene;
  const auto frame = scene.c_frame();
  const auto params = make_params(nullptr);
  const auto by_default = copied(run(frame.get()).get(), "R");
  REQUIRE(stein_params_set_text(params.get(), "bank", "intermediate") == STEIN_OK);
  CHECK(copied(run(frame.get(), params.get()).get(), "R") != by_default);
  REQUIRE(stein_params_set_text(params.get(), "bank", "final") == STEIN_OK);
  CHECK(copied(run(frame.get(), params.get()).get(), "R") == by_default);
  REQUIRE(stein_params_set_number(params.get(), "window-radius", 3) == STEIN_OK);
  CHECK(copied(run(frame.get(), params.get()).get(), "R") != by_default);
  REQUIRE(stein_params_set_text(params.get(), "quality", "default") == STEIN_OK);
  CHECK(copied(run(frame.get(), params.get()).get(), "R") == by_default);
}

TEST_CASE("C: the callback sees the progress, and cancels") {
  const Scene scene;
  const auto frame = scene.c_frame();
  struct Calls {
    std::vector<double> done;
    std::size_t most = 0;
  };
  const auto count = [](double done, void* user) -> int {
    auto& calls = *static_cast<Calls*>(user);
    calls.done.push_back(done);
    return calls.done.size() < calls.most ? 1 : 0;
  };
  Calls all{{}, 1000000};
  stein_result* result = nullptr;
  REQUIRE(stein_denoise(frame.get(), nullptr, count, &all, &result) == STEIN_OK);
  stein_result_destroy(result);
  REQUIRE(all.done.size() > 3);
  CHECK(std::is_sorted(all.done.begin(), all.done.end()));
  CHECK(all.done.back() == Approx(1.0));

  Calls few{{}, 2};
  check_failure(stein_denoise(frame.get(), nullptr, count, &few, &result), STEIN_CANCELLED,
                {"stein_denoise", "cancelled"});
  CHECK(few.done.size() == 2);
  CHECK(result == nullptr);
}

TEST_CASE("C: an exception of a callback does not cross") {
  const Scene scene;
  const auto frame = scene.c_frame();
  stein_result* result = nullptr;
  const auto throw_standard = [](double, void*) -> int { throw std::runtime_error("out of paper"); };
  check_failure(stein_denoise(frame.get(), nullptr, throw_standard, nullptr, &result), STEIN_INTERNAL,
                {"out of paper"});
  const auto throw_number = [](double, void*) -> int { throw 1; };
  check_failure(stein_denoise(frame.get(), nullptr, throw_number, nullptr, &result), STEIN_INTERNAL,
                {"not of the standard library"});
  CHECK(result == nullptr);
}

TEST_CASE("C: threads use the same frame and parameters at once, each with messages of its own") {
  const Scene scene;
  const auto frame = scene.c_frame();
  const auto params = make_params("gaussian");
  const auto expected = copied(run(frame.get(), params.get()).get(), "B");
  constexpr std::size_t kThreads = 4;
  std::array<bool, kThreads> good{};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      const std::string unknown = "plane" + std::to_string(t);
      stein_result* result = nullptr;
      std::vector<float> values(expected.size());
      good[t] = std::string(stein_error_message()).empty() &&
                stein_denoise(frame.get(), params.get(), nullptr, nullptr, &result) == STEIN_OK &&
                stein_result_copy(result, unknown.c_str(), values.data(), 0, 0) == STEIN_INVALID_ARGUMENT &&
                stein_result_copy(result, "B", values.data(), 0, 0) == STEIN_OK && values == expected &&
                std::string(stein_error_message()).find(unknown) != std::string::npos;
      stein_result_destroy(result);
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(good == std::array<bool, kThreads>{true, true, true, true});
}

}  // namespace stein::test
