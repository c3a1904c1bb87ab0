// SPDX-License-Identifier: Apache-2.0
//
// What every filter of the list must do. A filter that is added to FilterSpec is tested here without a further line.
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "conformance/specs.hpp"
#include "support/half_views.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

// NaN counts as larger than anything.
double larger(double a, double b) { return b <= a ? a : b; }

// Largest difference of two banks' results, relative to `scale`; map gives for (x, y) of `a` the pixel of `b`.
template <class Map>
double difference(const BankResult& a, const BankResult& b, double factor, Map map) {
  double largest = 0;
  for (std::size_t s = 0; s < a.result.size(); ++s) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < a.result[s][c].height(); ++y) {
        for (int x = 0; x < a.result[s][c].width(); ++x) {
          const auto [bx, by] = map(x, y);
          const double value = factor * a.result[s][c].row(y)[x];
          largest = larger(largest, std::abs(value - b.result[s][c].row(by)[bx]) / factor);
          if (a.divergence.empty()) continue;
          const double divergence = factor * factor * a.divergence[s][c].row(y)[x];
          largest = larger(largest, std::abs(divergence - b.divergence[s][c].row(by)[bx]) / (factor * factor * 0.01));
        }
      }
    }
  }
  return largest;
}

constexpr auto kSamePixel = [](int x, int y) { return std::pair(x, y); };

bool identical(const BankResult& a, const BankResult& b) { return difference(a, b, 1.0, kSamePixel) == 0.0; }

// Parameters that are in units of radiance follow the image's scale.
FilterSpec scaled(FilterSpec spec, float factor) {
  std::visit(
      [&](auto& params) {
        if constexpr (requires { params.range_sigma; }) params.range_sigma *= factor;
        if constexpr (requires { params.distance; }) {
          for (float& sigma : params.range_sigmas) sigma *= params.distance == PatchDistance::kAbsolute ? factor : 1.0F;
        }
      },
      spec);
  return spec;
}

// The power of the colour that a plane is of: its unit.
int colours_in(const std::string& name) {
  if (name.size() == 1) return 1;
  if (name.rfind("variance.", 0) == 0) return 2;
  if (name.rfind("covariance.", 0) == 0) return name.size() == std::string("covariance.R.G").size() ? 2 : 1;
  return 0;
}

std::vector<FilterSpec> specs() {
  std::vector<FilterSpec> all = listed_specs();
  CrossBilateralParams with_range;
  with_range.range_sigma = 0.5F;
  all.emplace_back(with_range);
  AtrousSureParams half_kept;
  half_kept.fixed_weight = 0.5F;
  half_kept.plain = true;
  all.emplace_back(half_kept);
  CrossNlmParams absolute;
  absolute.distance = PatchDistance::kAbsolute;
  absolute.range_sigmas = {0.05F, 0.3F};
  all.push_back(in_small_window(absolute));
  CrossBilateralParams smoothed;
  smoothed.guides.smoothing_radius = 2;
  all.emplace_back(smoothed);
  return all;
}

}  // namespace

TEST_CASE("every filter: a constant image comes back unchanged") {
  for (const FilterSpec& spec : specs()) {
    OwnedFrame frame(45, 33, kUsualFeatures);
    const BankResult bank = run_filter(spec, frame.frame());
    for (const auto& candidate : bank.result) {
      for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 45; ++x) CHECK(candidate[0].row(y)[x] == Approx(0.5).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("every filter: scaling the colour by k and the variance by k^2 scales the result") {
  for (const FilterSpec& spec : specs()) {
    for (const float k : {1e-3F, 64.0F, 1e4F}) {
      OwnedFrame frame(41, 23, kUsualFeatures);
      fill_random(frame, 21);
      const BankResult plain = run_filter(spec, frame.frame());
      for (const std::string& name : frame.names()) {
        for (int y = 0; y < 23; ++y) {
          for (int x = 0; x < 41; ++x) frame.at(name, x, y) *= std::pow(k, static_cast<float>(colours_in(name)));
        }
      }
      CHECK(difference(plain, run_filter(scaled(spec, k), frame.frame()), k, kSamePixel) < 2e-4);
    }
  }
}

TEST_CASE("every filter: flipped and transposed input gives flipped and transposed output") {
  for (const FilterSpec& spec : specs()) {
    OwnedFrame frame(39, 26, kUsualFeatures);
    fill_random(frame, 22);
    const BankResult plain = run_filter(spec, frame.frame());
    OwnedFrame mirrored(39, 26, kUsualFeatures);
    const auto flip = [](int x, int y) { return std::pair(38 - x, 25 - y); };
    copy_mapped(frame, mirrored, flip);
    CHECK(difference(plain, run_filter(spec, mirrored.frame()), 1.0, flip) < 1e-4);
    OwnedFrame transposed(26, 39, kUsualFeatures);
    const auto swap = [](int x, int y) { return std::pair(y, x); };
    copy_mapped(frame, transposed, swap);
    CHECK(difference(plain, run_filter(spec, transposed.frame()), 1.0, swap) < 1e-4);
  }
}

TEST_CASE("every filter: pixels beyond the declared halo cannot change a tile") {
  for (const FilterSpec& spec : specs()) {
    // The tile [x0, x0 + 8) x [y0, y0 + 6), with room around it for pixels that are beyond its halo.
    const int halo = reach(spec);
    const int x0 = halo + 20;
    const int y0 = halo + 17;
    const int width = x0 + halo + 28;
    const int height = y0 + halo + 23;
    OwnedFrame frame(width, height, kUsualFeatures);
    fill_random(frame, 23);
    const BankResult before = run_filter(spec, frame.frame());
    // Changes every plane outside of the halo; quantiles for the depth stay as they are.
    for (const std::string& name : frame.names()) {
      if (name == "sampleCount" || name.rfind("depth", 0) == 0) continue;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const bool far = x < x0 - halo || x >= x0 + 8 + halo || y < y0 - halo || y >= y0 + 6 + halo;
          if (far) frame.at(name, x, y) += 1.0F;
        }
      }
    }
    const BankResult after = run_filter(spec, frame.frame());
    bool changed_elsewhere = false;
    for (std::size_t s = 0; s < before.result.size(); ++s) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const bool same = before.result[s][1].row(y)[x] == after.result[s][1].row(y)[x];
          if (x >= x0 && x < x0 + 8 && y >= y0 && y < y0 + 6) CHECK(same);
          changed_elsewhere = changed_elsewhere || !same;
        }
      }
    }
    CHECK(changed_elsewhere);
  }
}

TEST_CASE("every filter: tiles of any size give identical bits") {
  for (const FilterSpec& spec : specs()) {
    OwnedFrame frame(101, 43, kUsualFeatures);
    fill_random(frame, 24);
    frame.at("R", 60, 20) = std::numeric_limits<float>::quiet_NaN();
    const BankResult reference = run_filter(spec, frame.frame(), {112, 43});
    CHECK(identical(reference, run_filter(spec, frame.frame(), {16, 1})));
    CHECK(identical(reference, run_filter(spec, frame.frame(), {48, 13})));
    CHECK(identical(reference, run_filter(spec, frame.frame(), {64, 32})));
  }
}

TEST_CASE("every filter: half, interleaved and negatively strided input gives the bits of packed float") {
  for (const FilterSpec& spec : specs()) {
    OwnedFrame frame(35, 18, kUsualFeatures);
    fill_random(frame, 25);
    for (const std::string& name : frame.names()) {
      for (int y = 0; y < 18; ++y) {
        for (int x = 0; x < 35; ++x) frame.at(name, x, y) = round_to_half(frame.at(name, x, y));
      }
    }
    const BankResult packed = run_filter(spec, frame.frame());
    for (const bool is_interleaved : {false, true}) {
      Frame half = frame.frame();
      std::vector<std::uint16_t> memory;
      hold_as_half(half, is_interleaved, memory);
      REQUIRE(half.colour[1].at(34, 17) == frame.at("G", 34, 17));
      CHECK(identical(packed, run_filter(spec, half)));
    }
    constexpr std::size_t kRowFloats = std::size_t{35} * 3;
    std::vector<float> interleaved(kRowFloats * 18);
    for (int y = 0; y < 18; ++y) {
      for (int x = 0; x < 35; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
          interleaved[static_cast<std::size_t>(17 - y) * kRowFloats + static_cast<std::size_t>(x) * 3 + c] =
              frame.frame().colour[c].at(x, y);
        }
      }
    }
    constexpr std::ptrdiff_t kRow = sizeof(float) * kRowFloats;
    for (std::size_t c = 0; c < 3; ++c)
      frame.frame().colour[c] = ConstPlaneView(interleaved.data() + 17 * kRowFloats + c, 35, 18, 12, -kRow);
    CHECK(identical(packed, run_filter(spec, frame.frame())));
  }
}

TEST_CASE("every filter: images of one pixel, one row and one column") {
  for (const FilterSpec& spec : specs()) {
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(57, 1), std::pair(1, 57)}) {
      OwnedFrame frame(width, height, kUsualFeatures);
      fill_random(frame, 26);
      const BankResult bank = run_filter(spec, frame.frame());
      for (const auto& candidate : bank.result) {
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) CHECK(std::isfinite(candidate[2].row(y)[x]));
        }
      }
      if (width * height == 1) CHECK(bank.result[0][0].row(0)[0] == Approx(frame.at("R", 0, 0)));
    }
  }
}

TEST_CASE(
    "every filter: an invalid pixel changes no other pixel than by its absence, and is filled from its neighbours") {
  for (const FilterSpec& spec : specs()) {
    OwnedFrame frame(40, 40, kUsualFeatures);
    fill_random(frame, 27);
    for (const char* c : {"R", "G", "B"}) {
      for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) frame.at(c, x, y) = 2.0F;
      }
    }
    frame.at("G", 20, 20) = std::numeric_limits<float>::infinity();
    frame.at("R", 3, 39) = std::numeric_limits<float>::quiet_NaN();
    frame.at("sampleCount", 0, 0) = 0.0F;
    const BankResult bank = run_filter(spec, frame.frame());
    for (const auto& candidate : bank.result) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (int y = 0; y < 40; ++y) {
          for (int x = 0; x < 40; ++x) CHECK(candidate[c].row(y)[x] == Approx(2.0).epsilon(1e-5));
        }
      }
    }
  }
}

}  // namespace stein::test
