// SPDX-License-Identifier: Apache-2.0
//
// One pass of the smoothing of maps as its description reads, in double, one pixel at a time.
#pragma once

#include <array>

#include "prefilter/source.hpp"
#include "select/guided_pass.hpp"
#include "stein/filters.hpp"

namespace stein::test {

inline constexpr int kMaps = 3;

/// Maps of the size of a frame.
struct Maps {
  explicit Maps(const Frame& frame) : ring(kMaps, frame.width, frame.height) {}
  [[nodiscard]] MapRows rows() const { return {&ring, kMaps}; }
  exec::RowRing ring;
};

/// A frame, and its guides in memory, all rows of them.
struct Setting {
  CrossBilateralParams params;
  Source source;
  GuideRows guides;
  explicit Setting(const Frame& frame) : source(frame, inspect(frame)), guides(make_rows(frame)) {
    exec::TileScratch scratch;
    guides.prepare({0, 0, frame.width, frame.height}, scratch);
  }
  [[nodiscard]] const Frame& frame() const { return source.frame(); }

 private:
  GuideRows make_rows(const Frame& frame) {
    return {source, params.guides, 0.0F, {frame.height, frame.width, frame.height}};
  }
};

/// The weighted means of all maps at pixel (x, y).
std::array<double, kMaps> guided_pass_reference(const GuidedPass& pass, const Setting& setting, const Maps& in, int x,
                                                int y);

}  // namespace stein::test
