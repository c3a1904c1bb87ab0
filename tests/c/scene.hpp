// SPDX-License-Identifier: Apache-2.0
//
// A small noisy image in interleaved memory, and the same as a frame of C and of C++.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "catch.hpp"
#include "stein.h"
#include "stein/frame.hpp"

namespace stein::test {

struct Destroy {
  void operator()(stein_frame* handle) const { stein_frame_destroy(handle); }
  void operator()(stein_params* handle) const { stein_params_destroy(handle); }
  void operator()(stein_result* handle) const { stein_result_destroy(handle); }
  void operator()(stein_film* handle) const { stein_film_destroy(handle); }
};
template <class T>
using Handle = std::unique_ptr<T, Destroy>;

/// What a function makes, that must succeed.
template <class T, class Make>
Handle<T> made(const Make& make) {
  T* handle = nullptr;
  const stein_status status = make(&handle);
  INFO(stein_error_message());
  REQUIRE(status == STEIN_OK);
  REQUIRE(handle != nullptr);
  return Handle<T>(handle);
}

inline Handle<stein_params> make_params(const char* filter) {
  return made<stein_params>([&](stein_params** p) { return stein_params_create(filter, p); });
}

/// `call` fails with this code, and says all of `parts`.
inline void check_failure(stein_status status, stein_status code, const std::vector<std::string>& parts) {
  const std::string message = stein_error_message();
  CHECK(status == code);
  for (const std::string& part : parts) {
    INFO("'" << part << "' in: " << message);
    CHECK(message.find(part) != std::string::npos);
  }
}

inline constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};

/// Grey noise around a step that the albedo shows. A pixel has 7 values: R, G, B, the variance of all three, albedo.
struct Scene {
  static constexpr int kWidth = 50;
  static constexpr int kHeight = 40;
  static constexpr std::ptrdiff_t kPixelStride = 7 * sizeof(float);
  std::vector<float> values = std::vector<float>(std::size_t{7} * kWidth * kHeight);

  explicit Scene(unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0.0F, 0.1F);
    for (std::size_t i = 0; i < values.size(); i += 7) {
      const float albedo = i / 7 % kWidth < 20 ? 0.2F : 0.8F;
      for (std::size_t c = 0; c < 3; ++c) values[i + c] = albedo + noise(random);
      values[i + 3] = 0.01F;
      for (std::size_t c = 0; c < 3; ++c) values[i + 4 + c] = albedo;
    }
  }

  /// From the last row up, with a negative row stride, where `flipped`.
  [[nodiscard]] stein_status set(stein_frame* frame, const std::string& name, std::size_t value,
                                 bool flipped = false) const {
    const std::ptrdiff_t row = kPixelStride * kWidth;
    const float* first = values.data() + value + (flipped ? std::size_t{7} * kWidth * (kHeight - 1) : 0);
    return stein_frame_set_plane(frame, name.c_str(), STEIN_FLOAT32, first, kPixelStride, flipped ? -row : row);
  }

  [[nodiscard]] Handle<stein_frame> c_frame(bool flipped = false) const {
    auto frame = made<stein_frame>([](stein_frame** f) { return stein_frame_create(kWidth, kHeight, f); });
    REQUIRE(stein_frame_add_feature(frame.get(), "albedo", 3) == STEIN_OK);
    REQUIRE(stein_frame_set_sample_count(frame.get(), 8) == STEIN_OK);
    for (std::size_t c = 0; c < 3; ++c) {
      REQUIRE(set(frame.get(), kRgb[c], c, flipped) == STEIN_OK);
      REQUIRE(set(frame.get(), std::string("variance.") + kRgb[c], 3, flipped) == STEIN_OK);
      REQUIRE(set(frame.get(), std::string("albedo.") + kRgb[c], 4 + c, flipped) == STEIN_OK);
    }
    return frame;
  }

  [[nodiscard]] Frame frame() const {
    const auto view = [&](std::size_t value) {
      return ConstPlaneView(values.data() + value, kWidth, kHeight, kPixelStride);
    };
    Frame frame;
    frame.width = kWidth;
    frame.height = kHeight;
    frame.uniform_sample_count = 8;
    frame.colour = {view(0), view(1), view(2)};
    frame.colour_variance = {view(3), view(3), view(3)};
    frame.features.push_back({"albedo", {view(4), view(5), view(6)}, {}, {}});
    return frame;
  }
};

}  // namespace stein::test
