// SPDX-License-Identifier: Apache-2.0
#include "prefilter/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stein {
namespace {

constexpr int kBandRows = 16;  // looked at by one thread at a time; each row is loaded for its neighbours, too

// Mean over the channels, its standard error, and validity of the pixels of one row, with one pixel of margin at both
// ends.
struct BrightnessRow {
  std::vector<float> mean;
  std::vector<float> error;
  std::vector<float> valid;
};

BrightnessRow load_brightness(const Source& source, int y) {
  const auto width = static_cast<std::size_t>(source.frame().width);
  BrightnessRow row{std::vector<float>(width + 2, 0.0F), std::vector<float>(width + 2, 0.0F),
                    std::vector<float>(width + 2, 0.0F)};
  if (y < 0 || y >= source.frame().height) return row;
  std::vector<float> mean(width);
  std::vector<float> variance(width);
  for (std::size_t c = 0; c < 3; ++c) {
    source.input_row(c, y, 0, source.frame().width, mean.data(), variance.data());
    for (std::size_t x = 0; x < width; ++x) {
      row.mean[x + 1] += mean[x] / 3.0F;
      row.error[x + 1] += std::sqrt(variance[x]) / 3.0F;  // channels of one pixel err together
    }
  }
  source.mask_row(y, 0, source.frame().width, row.valid.data() + 1);
  return row;
}

struct Neighbour {
  float mean = 0;
  float error = 0;
  bool found = false;
};

Neighbour brightest_neighbour(const BrightnessRow* const (&rows)[3], std::size_t x) {
  Neighbour best;
  for (int dy = 0; dy < 3; ++dy) {
    for (std::size_t nx = x - 1; nx <= x + 1; ++nx) {
      if ((dy == 1 && nx == x) || rows[dy]->valid[nx] == 0.0F) continue;
      if (!best.found || rows[dy]->mean[nx] > best.mean) best = {rows[dy]->mean[nx], rows[dy]->error[nx], true};
    }
  }
  return best;
}

// By how much more a standard error of few degrees of freedom has to be exceeded: about the ratio of the quantiles of
// Student's t and of the normal distribution at two standard errors.
float student_factor(float degrees_of_freedom) {
  return degrees_of_freedom > 0 ? 1.0F + 2.0F / degrees_of_freedom : 1.0F;
}

// What an outlier's colour has for a derivative, in an error estimate: one that has seen a single bright path is,
// without that, a standard error less, and what it was scaled to is this times its standard error above that. (By the
// lemma for counts, docs/risk.md: the slope is that between a path less and none less.)
float response_of(float lost, float error) { return std::max(1.0F - lost / error, -1.0F); }

// Adds those of the row in the middle.
void add_outliers(const Source& source, const OutlierParams& params, const BrightnessRow* const (&rows)[3], int y,
                  OutlierReport& report) {
  const BrightnessRow& here = *rows[1];
  const float support = params.support * student_factor(source.frame().degrees_of_freedom);
  for (std::size_t x = 1; x + 1 < here.mean.size(); ++x) {
    const float mean = here.mean[x];
    if (here.valid[x] == 0.0F || mean <= 0.0F) continue;
    // Most pixels leave here: a neighbour at hand that is at least as bright.
    if ((here.valid[x - 1] != 0.0F && mean <= here.mean[x - 1]) ||
        (here.valid[x + 1] != 0.0F && mean <= here.mean[x + 1]))
      continue;
    const Neighbour neighbour = brightest_neighbour(rows, x);
    const float excess = mean - neighbour.mean;
    if (!neighbour.found || excess <= params.excess * neighbour.error || excess >= support * here.error[x]) continue;
    const float scale = std::max(neighbour.mean, 0.0F) / mean;
    ReplacedPixel pixel{static_cast<int>(x) - 1, y, {}, true, scale, response_of(mean - scale * mean, here.error[x])};
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = source.frame().colour[c].at(pixel.x, y);
      pixel.colour[c] = value * scale;
      report.removed += static_cast<double>(value) - pixel.colour[c];
    }
    report.pixels.push_back(pixel);
  }
}

OutlierReport outliers_of_rows(const Source& source, const OutlierParams& params, int first, int end) {
  OutlierReport report;
  BrightnessRow above = load_brightness(source, first - 1);
  BrightnessRow here = load_brightness(source, first);
  for (int y = first; y < end; ++y) {
    BrightnessRow below = load_brightness(source, y + 1);
    add_outliers(source, params, {&above, &here, &below}, y, report);
    above = std::move(here);
    here = std::move(below);
  }
  return report;
}

}  // namespace

OutlierReport find_outliers(const Source& source, const OutlierParams& params, exec::Runner& runner) {
  const int height = source.frame().height;
  std::vector<OutlierReport> bands(static_cast<std::size_t>((height + kBandRows - 1) / kBandRows));
  runner.for_each(static_cast<int>(bands.size()), 0.0, [&](int band, int) {
    const int first = band * kBandRows;
    bands[static_cast<std::size_t>(band)] =
        outliers_of_rows(source, params, first, std::min(first + kBandRows, height));
  });
  OutlierReport all;
  for (const OutlierReport& band : bands) {
    all.pixels.insert(all.pixels.end(), band.pixels.begin(), band.pixels.end());
    all.removed += band.removed;
  }
  return all;
}

}  // namespace stein
