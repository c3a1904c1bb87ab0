// SPDX-License-Identifier: Apache-2.0
#include "stein/adaptive.hpp"

#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "catch.hpp"
#include "stein/error.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// A renderer of a grey wall of radiance 1 whose right third is lit by a noisy lamp: deviation of a sample 0.1, there 1.
// The albedo shows its texture.
class Renderer {
 public:
  static constexpr int kWidth = 96;
  static constexpr int kHeight = 64;
  static constexpr std::int64_t kPixels = std::int64_t{kWidth} * kHeight;

  explicit Renderer(std::uint64_t seed) : random_(seed) {}

  Frame operator()(const std::vector<std::uint32_t>& counts) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) add(x, y, counts[static_cast<std::size_t>(y * kWidth + x)]);
    }
    calls.push_back(counts);
    return film_.frame();
  }

  static bool is_noisy(int x) { return x >= 2 * kWidth / 3; }
  static double truth(int x, int y) { return 1.0 + ((x / 3 + y / 3) % 2 == 0 ? 0.2 : -0.2); }

  [[nodiscard]] double relative_error(const DenoiseResult& result) const {
    double sum = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double t = truth(x, y);
        sum += std::pow(result.colour[0].row(y)[x] - t, 2) / (t * t + 0.01);
      }
    }
    return sum / static_cast<double>(kPixels);
  }

  std::vector<std::vector<std::uint32_t>> calls;

 private:
  void add(int x, int y, std::uint32_t count) {
    const auto i = static_cast<std::size_t>(y * kWidth + x);
    for (std::uint32_t s = 0; s < count; ++s) {
      const double value = truth(x, y) + (is_noisy(x) ? 1.0 : 0.1) * random_.normal();
      sum_[i] += value;
      squares_[i] += value * value;
    }
    n_[i] += count;
    const double mean = sum_[i] / n_[i];
    const double variance = (squares_[i] - n_[i] * mean * mean) / (n_[i] * (n_[i] - 1.0));
    for (const char* c : {"R", "G", "B"}) {
      film_.at(c, x, y) = static_cast<float>(mean);
      film_.at(std::string("variance.") + c, x, y) = static_cast<float>(std::max(variance, 0.0));
    }
    film_.at("sampleCount", x, y) = static_cast<float>(n_[i]);
    for (const char* c : {"R", "G", "B"}) {
      film_.at(std::string("albedo.") + c, x, y) = static_cast<float>(truth(x, y) / 2);
      film_.at(std::string("albedo.variance.") + c, x, y) = 0.0F;
    }
  }

  OwnedFrame film_{kWidth, kHeight, {{"albedo", 3}}, false};
  Random random_;
  std::vector<double> sum_ = std::vector<double>(kPixels, 0.0);
  std::vector<double> squares_ = std::vector<double>(kPixels, 0.0);
  std::vector<double> n_ = std::vector<double>(kPixels, 0.0);
};

std::int64_t total(const std::vector<std::uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
}

AdaptiveParams params_of(std::int64_t budget) {
  AdaptiveParams params;
  params.budget = budget;
  return params;
}

AdaptiveResult run(Renderer& renderer, const AdaptiveParams& params) {
  return denoise_adaptively(
      Renderer::kWidth, Renderer::kHeight, [&](const std::vector<std::uint32_t>& counts) { return renderer(counts); },
      params);
}

void require_error(const RenderSamples& render, const AdaptiveParams& params, ErrorCode code, const std::string& part) {
  try {
    (void)denoise_adaptively(Renderer::kWidth, Renderer::kHeight, render, params);
    FAIL("no error");
  } catch (const Error& error) {
    CAPTURE(error.what());
    CHECK(error.code() == code);
    CHECK(std::string(error.what()).find(part) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("adaptive loop: the budget is spent exactly, in equal batches, most of it where the noise is") {
  Renderer renderer(1);
  const std::int64_t budget = 12 * Renderer::kPixels + 7;
  const AdaptiveResult adaptive = run(renderer, params_of(budget));
  REQUIRE(renderer.calls.size() == 4);
  std::int64_t spent = 0;
  for (std::size_t i = 0; i < renderer.calls.size(); ++i) {
    spent += total(renderer.calls[i]);
    if (i < adaptive.steps.size()) CHECK(adaptive.steps[i].samples == spent);
  }
  CHECK(spent == budget);
  CHECK(adaptive.samples == budget);
  CHECK(adaptive.steps.size() == 3);
  CHECK(std::abs(total(renderer.calls[1]) - total(renderer.calls[3])) <= 2);

  std::int64_t noisy = 0;
  for (int y = 0; y < Renderer::kHeight; ++y) {
    for (int x = 0; x < Renderer::kWidth; ++x) {
      const auto i = static_cast<std::size_t>(y * Renderer::kWidth + x);
      for (const auto& counts : renderer.calls) noisy += Renderer::is_noisy(x) ? counts[i] : 0;
    }
  }
  CHECK(noisy > budget * 2 / 3);  // of a third of the pixels
}

TEST_CASE("adaptive loop: less error than the same samples spread evenly, for the same filter") {
  const std::int64_t budget = 32 * Renderer::kPixels;
  double adaptive = 0;
  double uniform = 0;
  for (const std::uint64_t seed : {10U, 20U, 30U, 40U}) {
    Renderer renderer(seed);
    adaptive += renderer.relative_error(run(renderer, params_of(budget)).result);
    Renderer other(seed + 5);
    uniform += other.relative_error(denoise(other(std::vector<std::uint32_t>(Renderer::kPixels, 32))));
  }
  CHECK(adaptive < 0.95 * uniform);
}

TEST_CASE("adaptive loop: a regression drives it, by either density") {
  const std::int64_t budget = 32 * Renderer::kPixels;
  AdaptiveParams params = params_of(budget);
  params.denoise.filters = {AdaptiveOrderParams{}};
  params.intermediate = intermediate_adaptive_order();
  double adaptive = 0;
  double reduction = 0;
  double uniform = 0;
  for (const std::uint64_t seed : {10U, 20U}) {
    params.density = DensityRule::kAllSamples;
    Renderer renderer(seed);
    adaptive += renderer.relative_error(run(renderer, params).result);
    params.density = DensityRule::kErrorReduction;
    Renderer by_error(seed);
    const AdaptiveResult result = run(by_error, params);
    CHECK(result.samples == budget);
    reduction += by_error.relative_error(result.result);
    Renderer other(seed + 5);
    uniform += other.relative_error(denoise(other(std::vector<std::uint32_t>(Renderer::kPixels, 32)), params.denoise));
  }
  CHECK(adaptive < 0.9 * uniform);
  CHECK(reduction != adaptive);
}

TEST_CASE("adaptive loop: a second pass is the result's alone") {
  std::vector<std::vector<std::uint32_t>> calls;
  for (const bool second_pass : {false, true}) {
    Renderer renderer(6);
    AdaptiveParams params = params_of(16 * Renderer::kPixels);
    params.denoise.second_pass = second_pass;
    const AdaptiveResult adaptive = run(renderer, params);
    CHECK((adaptive.result.report.filters.back().name == "second-pass") == second_pass);
    if (second_pass) CHECK(renderer.calls == calls);
    calls = renderer.calls;
  }
}

TEST_CASE("adaptive loop: it stops when the estimated error meets the target") {
  Renderer renderer(4);
  AdaptiveParams params = params_of(64 * Renderer::kPixels);
  params.iterations = 15;
  params.target_error = 0.002;
  const AdaptiveResult adaptive = run(renderer, params);
  REQUIRE(adaptive.samples < params.budget);
  CHECK(adaptive.samples > 4 * Renderer::kPixels);
  CHECK(adaptive.steps.size() == renderer.calls.size());
  CHECK(adaptive.steps.back().mean_relative_error <= params.target_error);
  CHECK(adaptive.steps[adaptive.steps.size() - 2].mean_relative_error > params.target_error);
}

TEST_CASE("adaptive loop: a budget for the first batch alone, and one progress from 0 to 1") {
  Renderer renderer(5);
  AdaptiveParams params = params_of(4 * Renderer::kPixels);
  CHECK(run(renderer, params).steps.empty());
  CHECK(renderer.calls.size() == 1);

  std::vector<double> seen;
  params = params_of(8 * Renderer::kPixels);
  params.denoise.execution.threads = 1;
  params.denoise.execution.progress = [&](double fraction) {
    seen.push_back(fraction);
    return true;
  };
  (void)run(renderer, params);
  REQUIRE(seen.size() > 10);
  CHECK(std::is_sorted(seen.begin(), seen.end()));
  CHECK(seen.back() == 1.0);

  params.denoise.execution.progress = [](double fraction) { return fraction < 0.4; };
  require_error(std::ref(renderer), params, ErrorCode::kCancelled, "");
}

TEST_CASE("adaptive loop: what it refuses") {
  Renderer renderer(6);
  AdaptiveParams params = params_of(4 * Renderer::kPixels - 1);
  require_error(std::ref(renderer), params, ErrorCode::kInvalidArgument, "raise the budget or lower initial_samples");
  params = params_of(8 * Renderer::kPixels);
  params.initial_samples = 1;
  require_error(std::ref(renderer), params, ErrorCode::kInvalidArgument, "initial_samples is 1");
  params.initial_samples = 4;
  params.iterations = 0;
  require_error(std::ref(renderer), params, ErrorCode::kInvalidArgument, "iterations is 0");
  params.iterations = 3;
  params.target_error = -1;
  require_error(std::ref(renderer), params, ErrorCode::kInvalidArgument, "target_error is -1");
  params.target_error = 0;

  const RenderSamples without_counts = [&](const std::vector<std::uint32_t>& counts) {
    Frame frame = renderer(counts);
    frame.sample_count = {};
    frame.uniform_sample_count = 4;
    return frame;
  };
  require_error(without_counts, params, ErrorCode::kInvalidFrame, "without sample_count");
  const OwnedFrame small(8, 8, {});
  require_error([&](const std::vector<std::uint32_t>&) { return small.frame(); }, params, ErrorCode::kInvalidFrame,
                "8x8 pixels");
  const RenderSamples fails = [](const std::vector<std::uint32_t>&) -> Frame { throw std::runtime_error("no rays"); };
  CHECK_THROWS_AS(denoise_adaptively(Renderer::kWidth, Renderer::kHeight, fails, params), std::runtime_error);
}

}  // namespace stein::test
