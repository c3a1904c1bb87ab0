// SPDX-License-Identifier: Apache-2.0
//
// A small valid frame to break, for the tests of frames.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <list>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "stein/error.hpp"
#include "stein/frame.hpp"

inline constexpr int kWidth = 5;
inline constexpr int kHeight = 4;
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();

/// A valid frame with the memory behind it: colour with covariances, normal (3), depth (1, no noise), counts.
struct Scene {
  stein::Frame frame;
  std::list<std::vector<float>> memory;

  Scene() {
    frame.width = kWidth;
    frame.height = kHeight;
    for (std::size_t c = 0; c < 3; ++c) {
      frame.colour[c] = plane(0.5F);
      frame.colour_variance[c] = plane(0.01F);
      frame.colour_covariance[c] = plane(0.005F);
    }
    frame.sample_count = plane(8.0F);
    stein::Feature normal{"normal", {}, {}, {}};
    for (int k = 0; k < 3; ++k) {
      normal.mean.push_back(plane(0.6F));
      normal.variance.push_back(plane(0.02F));
    }
    for (int i = 0; i < 9; ++i) normal.colour_covariance.push_back(plane(0.001F));
    frame.features = {normal, stein::Feature{"depth", {plane(3.0F)}, {}, {}}};
  }

  stein::ConstPlaneView plane(float value, int width = kWidth, int height = kHeight) {
    memory.emplace_back(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value);
    return {memory.back().data(), width, height};
  }
};

/// Views are read-only; the memory behind them is the scene's own.
inline void poke(stein::ConstPlaneView view, int x, int y, float value) {
  const_cast<float*>(static_cast<const float*>(view.data()))[y * view.width() + x] = value;
}

inline std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const stein::Error& error) {
    CHECK(error.code() == stein::ErrorCode::kInvalidFrame);
    return error.what();
  }
  return {};
}

inline bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }
