// SPDX-License-Identifier: Apache-2.0
#include "filters/blurred_rows.hpp"

#include <algorithm>

namespace stein {
namespace {

constexpr int kChunk = 256;

// A row of the image and a pixel at either side; 0 beyond its borders.
struct Line {
  float at[kChunk + 2];

  template <class Read>
  void load(const Frame& frame, int y, int x, int count, Read read) {
    std::fill_n(at, count + 2, 0.0F);
    if (y < 0 || y >= frame.height) return;
    const int x0 = std::max(x - 1, 0);
    const int x1 = std::min(x + count + 1, frame.width);
    read(y, x0, x1 - x0, at + (x0 - (x - 1)));
  }
  // Adds the three pixels around each, with weights side, centre, side, times the mask.
  void spread(const Line& mask, float centre, float side, int count, float* sum) const {
    for (int i = 0; i < count; ++i) {
      sum[i] += centre * (mask.at[i + 1] * at[i + 1]) + side * (mask.at[i] * at[i] + mask.at[i + 2] * at[i + 2]);
    }
  }
};

void blurred_part(const Source& source, float blur, int y, int x, int count, float* const* rows) {
  for (int k = 0; k < kBlurredPlanes; ++k) std::fill_n(rows[k], count, 0.0F);
  const Frame& frame = source.frame();
  Line ones;
  std::fill_n(ones.at, count + 2, 1.0F);
  for (int dy = -1; dy <= 1; ++dy) {
    const float centre = dy == 0 ? 1.0F : blur;
    const float side = centre * blur;
    Line mask;
    Line line;
    mask.load(frame, y + dy, x, count, [&](int v, int u, int n, float* out) { source.mask_row(v, u, n, out); });
    mask.spread(ones, centre, side, count, rows[3]);
    for (std::size_t c = 0; c < 3; ++c) {
      line.load(frame, y + dy, x, count, [&](int v, int u, int n, float* out) { source.colour_row(c, v, u, n, out); });
      line.spread(mask, centre, side, count, rows[c]);
      line.load(frame, y + dy, x, count,
                [&](int v, int u, int n, float* out) { source.variance_row(c, v, u, n, out); });
      line.spread(mask, centre * centre, side * side, count, rows[4]);
    }
  }
  for (int i = 0; i < count; ++i) {
    const float gain = rows[3][i] > 0.0F ? 1.0F / rows[3][i] : 0.0F;
    for (int c = 0; c < 3; ++c) rows[c][i] *= gain;
    rows[3][i] = gain;
    rows[4][i] *= gain * gain;
  }
}

}  // namespace

void blurred_row(const Source& source, float blur, int y, int x, int count, float* const* rows) {
  for (int start = 0; start < count; start += kChunk) {
    float* part[kBlurredPlanes];
    for (int k = 0; k < kBlurredPlanes; ++k) part[k] = rows[k] + start;
    blurred_part(source, blur, y, x + start, std::min(kChunk, count - start), part);
  }
}

}  // namespace stein
