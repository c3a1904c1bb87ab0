// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/large_array.hpp"
#include "pipeline/relative_risk.hpp"
#include "select/selection.hpp"

namespace stein {
namespace {

constexpr int kRows = 8;     // looked at in a row, so that a filter's first pass can leave out rows as well
constexpr int kPeriod = 64;  // of so many, or of a multiple in images of many rows
constexpr int kPeriods = 8;  // so many there are before they get longer
constexpr int kSmall = 256;  // images of fewer rows are looked at as a whole

// From one group of rows to the next; doubles with the image's height.
int period_of(int height) {
  int period = kPeriod;
  while (height >= 2 * kPeriods * period) period *= 2;
  return period;
}

int first_row_of(int period) { return (period - kRows) / 2; }

// Whether a row is looked at, or within reach of one.
bool is_surveyed(int y, int height, int reach) {
  if (height < kSmall) return true;
  const int period = period_of(height);
  const int beyond = (y + period - first_row_of(period)) % period - (kRows - 1);  // the last row before
  return beyond <= reach || period - (kRows - 1) - beyond <= reach;
}

// How many rows are looked at, or a few more.
int surveyed_rows(int height) { return height < kSmall ? height : (height / period_of(height) + 1) * kRows; }

// Of the rows that are looked at, how many lie before row y, which is one.
int surveyed_before(int y, int height) {
  if (height < kSmall) return y;
  const int period = period_of(height);
  const int from_first = y - first_row_of(period);
  return from_first / period * kRows + from_first % period;
}

// Sums over the pixels of a block.
struct BlockSums {
  std::array<double, kMaxEntries> clipped{};
  std::array<double, kMaxEntries> risk{};
  double noise = 0;
  double residual = 0;
  double product = 0;
  double pixels = 0;

  void add(const BlockSums& other) {
    for (std::size_t e = 0; e < clipped.size(); ++e) {
      clipped[e] += other.clipped[e];
      risk[e] += other.risk[e];
    }
    noise += other.noise;
    residual += other.residual;
    product += other.product;
    pixels += other.pixels;
  }
};

}  // namespace

struct Surveyor::State {
  State(const Source& from, const FilterRuns& filter_runs, const exec::RowPipelineGeometry& geometry, int slots)
      : source(from),
        runs(filter_runs),
        height(geometry.height),
        pitch(geometry.tile_width),
        blocks((geometry.width + kSumBlock - 1) / kSumBlock),
        sums(static_cast<std::size_t>(blocks) * static_cast<std::size_t>(surveyed_rows(geometry.height)),
             from.memory()),
        lines(static_cast<std::size_t>(slots),
              std::vector<float>(static_cast<std::size_t>((kRelativeRiskLines + kMaxEntries) * pitch))) {}

  [[nodiscard]] BlockSums& sums_at(int x, int y) {
    return sums[static_cast<std::size_t>(surveyed_before(y, height)) * static_cast<std::size_t>(blocks) +
                static_cast<std::size_t>(x / kSumBlock)];
  }
  void add_row(const Rect& part, int y, float* row_lines);
  void add_noise(const Rect& part, int y, float* row_lines);
  [[nodiscard]] std::vector<BlockSums> areas() const;

  const Source& source;
  const FilterRuns& runs;
  int height;
  std::ptrdiff_t pitch;
  int blocks;
  LargeArray<BlockSums> sums;             // [row that is looked at][block]
  std::vector<std::vector<float>> lines;  // per slot
};

Surveyor::Surveyor(const Source& source, const FilterRuns& runs, const exec::RowPipelineGeometry& geometry, int slots)
    : state_(std::make_unique<State>(source, runs, geometry, slots)) {}

Surveyor::~Surveyor() = default;

std::vector<Rect> Surveyor::parts(const Rect& tile, int reach) const {
  std::vector<Rect> parts;
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (!is_surveyed(y, state_->height, reach)) continue;
    if (!parts.empty() && parts.back().y1 == y) {
      ++parts.back().y1;
    } else {
      parts.push_back({tile.x0, y, tile.x1, y + 1});
    }
  }
  return parts;
}

void Surveyor::add(const Rect& part, int slot) {
  for (int y = part.y0; y < part.y1; ++y)
    state_->add_row(part, y, state_->lines[static_cast<std::size_t>(slot)].data());
}

void Surveyor::State::add_row(const Rect& part, int y, float* row_lines) {
  const int entries = runs.entries();
  float* risks[kMaxEntries];
  for (int e = 0; e < entries; ++e) risks[e] = row_lines + (kRelativeRiskLines + e) * pitch;
  relative_risk_rows(source, runs.candidates(), entries, runs.common_candidate(), part, y, row_lines, pitch, risks);
  const float limit = runs.risk_limit();
  float* mask = row_lines;
  source.mask_row(y, part.x0, part.width(), mask);
  for (int i = 0; i < part.width(); ++i) {
    if (mask[i] == 0.0F) continue;
    BlockSums& block = sums_at(part.x0 + i, y);
    block.pixels += 1.0;
    for (int e = 0; e < entries; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      block.clipped[entry] += std::clamp(risks[e][i], -limit, limit);
      block.risk[entry] += risks[e][i];
    }
  }
  add_noise(part, y, row_lines);
}

// Relative variance and squared residual of each pixel, and the product of its residual with that of its right
// neighbour in the block.
void Surveyor::State::add_noise(const Rect& part, int y, float* row_lines) {
  const int n = part.width();
  float* mask = row_lines;
  float* mean = row_lines + pitch;
  float* variance = row_lines + 2 * pitch;
  source.mask_row(y, part.x0, n, mask);
  for (int c = 0; c < 3; ++c) {
    source.input_row(static_cast<std::size_t>(c), y, part.x0, n, mean, variance);
    const float* F = runs.candidates().result(runs.common_candidate(), c, y) + part.x0;
    const auto weight = [F](int i) { return 1.0 / (3.0 * (static_cast<double>(F[i]) * F[i] + kRelativeEpsilon)); };
    for (int i = 0; i < n; ++i) {
      if (mask[i] == 0.0F) continue;
      BlockSums& block = sums_at(part.x0 + i, y);
      block.noise += variance[i] * weight(i);
      block.residual += std::pow(static_cast<double>(mean[i]) - F[i], 2) * weight(i);
      const bool has_neighbour = i + 1 < n && (part.x0 + i + 1) % kSumBlock != 0 && mask[i + 1] != 0.0F;
      if (!has_neighbour) continue;
      const double product = (static_cast<double>(mean[i]) - F[i]) * (static_cast<double>(mean[i + 1]) - F[i + 1]);
      block.product += product * std::sqrt(weight(i) * weight(i + 1)) * kSumBlock / (kSumBlock - 1.0);
    }
  }
}

// Sums over areas of four blocks by the eight rows that are looked at together: the units of standard errors, wide
// enough for neighbours that err together.
std::vector<BlockSums> Surveyor::State::areas() const {
  constexpr int kBlocksOfArea = 4;
  const int columns = (blocks + kBlocksOfArea - 1) / kBlocksOfArea;
  const int first =
      height < kSmall ? (kPeriod - first_row_of(kPeriod)) % kRows : 0;  // small images too have areas as large ones do
  const int rows = surveyed_rows(height);
  std::vector<BlockSums> areas(static_cast<std::size_t>(columns * ((rows - 1 + first) / kRows + 1)));
  for (int y = 0; y < rows; ++y) {
    for (int b = 0; b < blocks; ++b) {
      const auto area = static_cast<std::size_t>((y + first) / kRows * columns + b / kBlocksOfArea);
      areas[area].add(
          sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks) + static_cast<std::size_t>(b)]);
    }
  }
  return areas;
}

namespace {

// Ratio of the sums of `quantity` and of the pixels, over all areas, with the standard error of a ratio.
template <class Quantity>
Estimate mean_of(const std::vector<BlockSums>& areas, Quantity quantity) {
  double sum = 0;
  double pixels = 0;
  for (const BlockSums& area : areas) {
    sum += quantity(area);
    pixels += area.pixels;
  }
  Estimate estimate{pixels > 0 ? sum / pixels : 0.0, 0.0};
  double squares = 0;
  for (const BlockSums& area : areas) squares += std::pow(quantity(area) - estimate.value * area.pixels, 2);
  if (pixels > 0) estimate.standard_error = std::sqrt(squares) / pixels;
  return estimate;
}

std::string percent(double fraction) { return std::to_string(static_cast<int>(std::lround(100.0 * fraction))) + " %"; }

}  // namespace

Survey Surveyor::result() const {
  const std::vector<BlockSums> all = state_->areas();
  Survey survey;
  for (std::size_t e = 0; e < static_cast<std::size_t>(state_->runs.entries()); ++e) {
    survey.risk.push_back(mean_of(all, [e](const BlockSums& area) { return area.risk[e]; }));
    const Estimate clipped = mean_of(all, [e](const BlockSums& area) { return area.clipped[e]; });
    survey.mean_risk.push_back(static_cast<float>(clipped.value));
  }
  survey.common = state_->runs.common_candidate();
  survey.noise = mean_of(all, [](const BlockSums& area) { return area.noise; }).value;
  survey.residual = mean_of(all, [](const BlockSums& area) { return area.residual; }).value;
  survey.correlation = mean_of(all, [](const BlockSums& area) { return area.product; });
  survey.best =
      static_cast<int>(std::min_element(survey.mean_risk.begin(), survey.mean_risk.end()) - survey.mean_risk.begin());
  return survey;
}

Survey survey(Surveyor& surveyor, FilterRuns& runs, const exec::RowPipelineGeometry& geometry, exec::Runner& runner,
              double progress_weight) {
  std::vector<exec::RowStage> stages;
  runs.add_stages([&surveyor](const Rect& tile, int reach) { return surveyor.parts(tile, reach); },
                  [&surveyor](const Rect& part, int slot) { surveyor.add(part, slot); }, stages);
  exec::run_row_pipeline(geometry, stages, runner, progress_weight);
  return surveyor.result();
}

// The true error cannot be negative, and the product of two neighbours' residuals cannot exceed it while their noise is
// independent.
std::vector<std::string> doubts(const Survey& survey, bool joint) {
  constexpr double kTolerance = 0.1;
  constexpr double kStandardErrors = 4.0;
  std::vector<std::string> texts;
  if (survey.noise <= 0) return texts;
  const double bias = std::max(survey.risk[static_cast<std::size_t>(survey.common) + 1].value, 0.0);
  const double shared = survey.correlation.value - bias;
  if (shared > kTolerance * survey.residual + kStandardErrors * survey.correlation.standard_error) {
    texts.push_back("the noise of neighbouring pixels is correlated (coefficient " + percent(shared / survey.residual) +
                    "), as a wide pixel filter makes it: the estimated error is too low; render with a box filter of "
                    "one pixel");
    return texts;
  }
  double lowest = 0;
  for (const Estimate& risk : survey.risk)
    lowest = std::min(lowest, risk.value + kStandardErrors * risk.standard_error);
  if (joint && lowest < -kTolerance * survey.noise) {
    texts.push_back("the variance given is more than the noise is, by " + percent(-lowest / survey.noise) +
                    " or more, as of stratified or low-discrepancy samples: the estimated error is too low");
  }
  return texts;
}

}  // namespace stein
