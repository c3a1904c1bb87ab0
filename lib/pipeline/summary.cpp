// SPDX-License-Identifier: Apache-2.0
#include "pipeline/summary.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <vector>

#include "core/memory_warnings.hpp"
#include "core/validity.hpp"
#include "kernels/guides.hpp"

namespace stein {
namespace {

constexpr float kFewDegrees = 3.0F;

// Sums of one row, in double; rows are added in order, so that threads do not change the result.
struct RowSums {
  double density = 0;
  double radiance = 0;
  std::vector<std::int64_t> choices;
};

RowSums sums_of_row(const DenoiseResult& result, std::size_t entries, int y) {
  RowSums sums;
  sums.choices.assign(entries, 0);
  const int width = result.density.width();
  for (std::size_t c = 0; c < 3; ++c) {
    const float* colour = result.colour[c].row(y);
    for (int x = 0; x < width; ++x) sums.radiance += colour[x];
  }
  for (int x = 0; x < width; ++x) {
    sums.density += result.density.row(y)[x];
    ++sums.choices[static_cast<std::size_t>(result.choice.row(y)[x])];
  }
  return sums;
}

// Trims memory now and then between the steps of serial work.
class Trimmer {
 public:
  explicit Trimmer(const Source& source) : memory_(source.memory()) {}
  void step() {
    constexpr int kSteps = 64;
    if (memory_ != nullptr && ++steps_ % kSteps == 0) memory_->trim();
  }

 private:
  const Memory* memory_;
  int steps_ = 0;
};

// A pixel without usable colour knows nothing of its variance: it is worth as much as its best valid neighbour, or the
// image's mean where there is none.
void fill_density(const Source& source, Plane& density) {
  Trimmer trimmer(source);
  std::vector<std::pair<const ReplacedPixel*, float>> fills;
  double mean = 0;
  for (int y = 0; y < density.height() && !source.replaced().list().empty(); ++y) {
    trimmer.step();
    mean += std::accumulate(density.row(y), density.row(y) + density.width(), 0.0) / density.width() / density.height();
  }
  for (const ReplacedPixel& pixel : source.replaced().list()) {
    if (pixel.is_source) continue;
    trimmer.step();
    float best = 0;
    float mask[3] = {};
    for (int y = std::max(pixel.y - 1, 0); y <= std::min(pixel.y + 1, density.height() - 1); ++y) {
      const int x0 = std::max(pixel.x - 1, 0);
      const int count = std::min(pixel.x + 1, density.width() - 1) - x0 + 1;
      source.mask_row(y, x0, count, mask);
      for (int i = 0; i < count; ++i) best = mask[i] != 0.0F ? std::max(best, density.row(y)[x0 + i]) : best;
    }
    fills.emplace_back(&pixel, best > 0.0F ? best : static_cast<float>(mean));
  }
  for (const auto& [pixel, value] : fills) {
    trimmer.step();
    density.row(pixel->y)[pixel->x] = value;
  }
}

/// Whether all pixels claim to be exact. Ends at the first that does not.
bool has_no_variance(const Source& source) {
  const Frame& frame = source.frame();
  Trimmer trimmer(source);
  std::vector<float> row(static_cast<std::size_t>(frame.width));
  for (int y = 0; y < frame.height; ++y) {
    trimmer.step();
    for (const ConstPlaneView& variance : frame.colour_variance) {
      variance.read_row(y, 0, frame.width, row.data());
      if (std::any_of(row.begin(), row.end(), [](float v) { return v != 0.0F; })) return false;
    }
  }
  return true;
}

void mark_filled(const Source& source, Plane& choice) {
  Trimmer trimmer(source);
  for (const ReplacedPixel& pixel : source.replaced().list()) {
    if (pixel.is_source) continue;
    trimmer.step();
    choice.row(pixel.y)[pixel.x] = -1.0F;
  }
}

void scale_density(Plane& density, double sum, exec::Runner& runner) {
  const double pixels = static_cast<double>(density.width()) * density.height();
  runner.for_each(density.height(), 0.0, [&](int y, int) {
    float* row = density.row(y);
    for (int x = 0; x < density.width(); ++x) row[x] = sum > 0 ? static_cast<float>(row[x] * (pixels / sum)) : 1.0F;
  });
}

template <class... Parts>
void warn(DenoiseReport& report, const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  report.warnings.push_back(text.str());
}

void add_warnings(const Frame& frame, bool is_exact, DenoiseReport& report) {
  const FrameReport& found = report.frame;
  if (found.invalid_pixels > 0) {
    warn(report, found.invalid_pixels, " pixels had no usable colour (first: ", describe(found.first_invalid),
         "); they were filled from their neighbours, and are -1 in the choice");
  }
  if (found.bad_covariance_pixels > 0) {
    warn(report, found.bad_covariance_pixels,
         " pixels have unusable covariances (first: ", describe(found.first_bad_covariance), "); they count as 0");
  }
  for (std::size_t f = 0; f < frame.features.size(); ++f) {
    if (found.bad_feature_pixels[f] > 0) {
      warn(report, "feature '", frame.features[f].name, "' is unusable in ", found.bad_feature_pixels[f],
           " pixels (first: ", describe(found.first_bad_feature[f]),
           "); it was taken from the pixels around them, or left out of their distances where these do not have it");
    }
    if (frame.features[f].variance.empty()) {
      warn(report, "feature '", frame.features[f].name, "' has no variance; it was taken as free of noise");
    }
  }
  if (is_exact) {
    warn(report,
         "the variance of the colour is 0 in all pixels: the input was taken as exact and stays as it is; have the "
         "renderer write its variance");
  }
  if (found.single_sample_pixels > 0) {
    warn(report, found.single_sample_pixels,
         " pixels have one sample: their variance cannot come from it, and the estimated error is only as good as what "
         "was given");
  }
  if (frame.degrees_of_freedom > 0 && frame.degrees_of_freedom < kFewDegrees) {
    warn(report, "the variances have ", frame.degrees_of_freedom,
         " degrees of freedom: choice and estimated error are uncertain; merge four renders or more");
  }
  if (frame.features.empty()) warn(report, "there are no features; edges are not protected");
}

}  // namespace

void tell_of_memory(const MemoryUsage& usage, DenoiseReport& report) {
  report.scratch_bytes = usage.scratch_bytes;
  add_memory_warnings(usage, report.warnings);
}

void summarise(const Source& source, const DenoiseParams& params, exec::Runner& runner, double progress_weight,
               DenoiseResult& result) {
  const Frame& frame = source.frame();
  DenoiseReport& report = result.report;
  fill_density(source, result.density);
  report.candidates = candidate_names(params.filters);
  for (const ExternalCandidate& candidate : params.candidates) report.candidates.push_back(candidate.name);
  report.instruction_set = kernels::instruction_set();
  std::vector<RowSums> rows(static_cast<std::size_t>(frame.height));
  runner.for_each(frame.height, progress_weight, [&](int y, int) {
    rows[static_cast<std::size_t>(y)] = sums_of_row(result, report.candidates.size(), y);
  });

  const double pixels = static_cast<double>(frame.width) * frame.height;
  double density = 0;
  double radiance = 0;
  report.choice_share.assign(report.candidates.size(), 0.0);
  for (const RowSums& row : rows) {
    for (std::size_t e = 0; e < row.choices.size(); ++e)
      report.choice_share[e] += static_cast<double>(row.choices[e]) / pixels;
    density += row.density;
    radiance += row.radiance;
  }
  mark_filled(source, result.choice);
  if (params.outliers.spread == 0.0F) radiance += report.outlier_energy;
  report.outlier_energy = radiance > 0 ? report.outlier_energy / radiance : 0.0;
  scale_density(result.density, density, runner);
  add_warnings(frame, radiance > 0 && has_no_variance(source), report);
}

}  // namespace stein
