// SPDX-License-Identifier: Apache-2.0
//
// One pixel that holds what it should not: it may change its own neighbourhood by its absence, and nothing else.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "conformance/specs.hpp"
#include "stein/denoise.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Poison {
  const char* plane;
  float value;
};

std::ostream& operator<<(std::ostream& out, const Poison& poison) {
  return out << poison.plane << " = " << poison.value;
}

/// After each of these the pixel has no usable colour: they cannot be told from each other.
constexpr Poison kInvalidColours[] = {{"G", kNan},           {"R", kInfinity},     {"B", -kInfinity},    {"G", 1e38F},
                                      {"variance.R", -1.0F}, {"variance.G", kNan}, {"variance.B", 1e38F}};

/// The depth itself is in none: it is divided by a quantile of the whole image.
constexpr Poison kOthers[] = {{"sampleCount", 0.0F},
                              {"sampleCount", 1e38F},
                              {"R", 1e-40F},
                              {"variance.G", 1e-40F},
                              {"albedo.G", kNan},
                              {"albedo.G", 1e38F},
                              {"normal.X", -kInfinity},
                              {"albedo.variance.R", -1.0F},
                              {"normal.variance.Z", 1e38F},
                              {"depth.variance.Z", kNan},
                              {"covariance.R.G", kNan},
                              {"covariance.R.B", 1e38F},
                              {"covariance.G.albedo.B", kNan},
                              {"covariance.B.normal.Y", 1e38F}};

constexpr int kX = 9;  // of the poisoned pixel
constexpr int kY = 7;

bool is_far(int x, int y, int halo) { return x > kX + halo || y > kY + halo; }

/// With room for pixels beyond the halo at the right and at the bottom.
class PoisonedFrame {
 public:
  explicit PoisonedFrame(int halo) : frame_(kX + halo + 12, kY + halo + 10, kUsualFeatures) { fill_random(frame_, 41); }

  [[nodiscard]] const Frame& frame() const { return frame_.frame(); }

  /// What work() returns while the pixel holds the poison.
  template <class Work>
  auto with(const Poison& poison, const Work& work) {
    float& value = frame_.at(poison.plane, kX, kY);
    const float sound = std::exchange(value, poison.value);
    auto result = work();
    value = sound;
    return result;
  }

 private:
  OwnedFrame frame_;
};

/// Every candidate's F and D in one list of planes.
std::vector<Plane> run_bank(const FilterSpec& spec, const Frame& frame) {
  BankResult bank = run_filter(spec, frame);
  std::vector<Plane> planes;
  for (auto* list : {&bank.result, &bank.divergence}) {
    for (auto& candidate : *list) std::move(candidate.begin(), candidate.end(), std::back_inserter(planes));
  }
  return planes;
}

/// Only local choices: what the image as a whole says enters with Selection::kEvidence, into the error and the density.
std::vector<Plane> run_locally(const FilterSpec& spec, const Frame& frame) {
  DenoiseParams params;
  params.filters = {spec};
  params.selection = Selection::kArgmin;
  DenoiseResult result = denoise(frame, params);
  std::vector<Plane> planes;
  std::move(result.colour.begin(), result.colour.end(), std::back_inserter(planes));
  planes.push_back(std::move(result.choice));
  return planes;
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Whether all planes agree bit for bit where where(x, y).
template <class Where>
bool agree(const std::vector<Plane>& a, const std::vector<Plane>& b, Where where) {
  bool all = a.size() == b.size();
  for (std::size_t p = 0; all && p < a.size(); ++p) {
    for (int y = 0; y < a[p].height(); ++y) {
      for (int x = 0; x < a[p].width(); ++x) all = all && (!where(x, y) || same_bits(a[p].row(y)[x], b[p].row(y)[x]));
    }
  }
  return all;
}

bool all_finite(const std::vector<Plane>& planes) {
  return std::all_of(planes.begin(), planes.end(), [](const Plane& plane) {
    bool finite = true;
    for (int y = 0; y < plane.height(); ++y) {
      finite =
          finite && std::all_of(plane.row(y), plane.row(y) + plane.width(), [](float v) { return std::isfinite(v); });
    }
    return finite;
  });
}

constexpr auto kAnywhere = [](int, int) { return true; };

/// run(spec, frame) with each poison; what lies beyond the halo is what it is without.
template <class Run>
void check_poisons(const FilterSpec& spec, int halo, std::span<const Poison> invalid_colours,
                   std::span<const Poison> others, const Run& run) {
  PoisonedFrame scene(halo);
  const auto planes = [&] { return run(spec, scene.frame()); };
  const auto far = [halo](int x, int y) { return is_far(x, y, halo); };
  const std::vector<Plane> sound = planes();
  const std::vector<Plane> without = scene.with(invalid_colours.front(), planes);
  CHECK(all_finite(without));
  CHECK(agree(sound, without, far));
  CHECK_FALSE(agree(sound, without, kAnywhere));
  for (const Poison& poison : invalid_colours.subspan(1)) {
    INFO(poison);
    CHECK(agree(without, scene.with(poison, planes), kAnywhere));
  }
  for (const Poison& poison : others) {
    INFO(poison);
    const std::vector<Plane> poisoned = scene.with(poison, planes);
    CHECK(all_finite(poisoned));
    CHECK(agree(sound, poisoned, far));
  }
}

}  // namespace

TEST_CASE("every filter: a poisoned pixel changes no bit beyond its halo") {
  for (const FilterSpec& spec : listed_specs()) {
    INFO(filter_name(spec));
    check_poisons(spec, reach(spec) + 1, kInvalidColours, kOthers,
                  run_bank);  // 1: an invalid pixel is filled from its neighbours
  }
}

TEST_CASE("denoise: with local choices, a poisoned pixel changes no bit beyond filter and smoothing") {
  constexpr int kSmoothing = 2 * (1 + 2 + 4);
  constexpr int kNeighbours = 1 + 1;  // of the fill, and of the search for outliers
  constexpr Poison kInvalid[] = {{"G", kNan}, {"R", kInfinity}, {"variance.B", -1.0F}, {"R", 1e38F}};
  constexpr Poison kFeature[] = {{"albedo.G", kNan}};
  for (const FilterSpec& spec : listed_specs()) {
    INFO(filter_name(spec));
    check_poisons(spec, reach(spec) + 2 * kSmoothing + kNeighbours, kInvalid, kFeature, run_locally);
  }
}

namespace {

/// Smooth with an edge that the albedo shows; noise of the variance that the frame states.
class Scene {
 public:
  static constexpr int kWidth = 120;
  static constexpr int kHeight = 90;
  OwnedFrame frame{kWidth, kHeight, kUsualFeatures};

  Scene() {
    Random random(42);
    for (const std::string& name : frame.names()) {
      const bool is_noise = name.find("variance") != std::string::npos;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          if (is_noise) frame.at(name, x, y) = name.size() == 10 ? kDeviation * kDeviation : 0.0F;
          if (name.size() == 1) frame.at(name, x, y) = static_cast<float>(truth(x, y) + kDeviation * random.normal());
          if (name == "albedo.R") frame.at(name, x, y) = x > 90 ? 0.9F : 0.1F;
          if (name == "depth.Z") frame.at(name, x, y) = 2.0F + 0.01F * static_cast<float>(x + y);
        }
      }
    }
  }

  /// Relative squared error of what lies beyond the halo.
  [[nodiscard]] static double error(const DenoiseResult& result, int halo) {
    double sum = 0;
    for (const Plane& plane : result.colour) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const double t = truth(x, y);
          if (is_far(x, y, halo)) sum += std::pow(plane.row(y)[x] - t, 2) / (t * t + 0.01);
        }
      }
    }
    return sum;
  }

 private:
  static constexpr float kDeviation = 0.2F;
  static double truth(int x, int y) {
    return 0.5 + 0.3 * std::sin(0.03 * x) + 0.1 * std::cos(0.05 * y) + (x > 90 ? 1.0 : 0.0);
  }
};

}  // namespace

TEST_CASE("every filter: with choices of the whole image, a poisoned pixel leaves the error of the rest as it is") {
  constexpr int kSmoothing = 2 * (1 + 2 + 4) + 2 * (1 + 2);  // of risks and weights
  constexpr Poison kPoisons[] = {{"G", kNan}, {"depth.Z", 1e38F}};
  for (const FilterSpec& spec : listed_specs()) {
    Scene scene;
    DenoiseParams params;
    params.filters = {spec};
    const int halo = reach(spec) + kSmoothing + 2;
    const double sound = Scene::error(denoise(scene.frame.frame(), params), halo);
    REQUIRE(sound > 0);
    for (const Poison& poison : kPoisons) {
      INFO(filter_name(spec) << ", " << poison);
      const float before = std::exchange(scene.frame.at(poison.plane, kX, kY), poison.value);
      const DenoiseResult result = denoise(scene.frame.frame(), params);
      scene.frame.at(poison.plane, kX, kY) = before;
      CHECK(Scene::error(result, halo) == Approx(sound).epsilon(1e-3));
      CHECK(result.report.frame.invalid_pixels == (poison.plane == std::string_view("depth.Z") ? 0 : 1));
      for (const Plane& plane : result.colour) CHECK(std::abs(plane.row(kY)[kX] - 0.7) < 0.5);
    }
  }
}

}  // namespace stein::test
