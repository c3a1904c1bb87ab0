// SPDX-License-Identifier: Apache-2.0
#include "quality/bank.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "prefilter/outliers.hpp"
#include "select/selection.hpp"

namespace stein::quality {
namespace {

constexpr double kEpsilon = 0.01;

std::string beside(const std::string& file, const char* name) {
  return (std::filesystem::path(file).parent_path() / name).string();
}

Risk method_of(const DenoiseParams& params) {
  if (params.risk != Risk::kAuto) return params.risk;
  return has_derivative(params.filters.front()) ? Risk::kJoint : Risk::kMonteCarlo;
}

}  // namespace

Bank::Bank(const std::string& file, const DenoiseParams& params)
    : loaded_(exr::read_frame(file)), reference_(exr::read_planes(beside(file, "ref.exr"))), params_(params) {
  std::ifstream(beside(file, "refnoise")) >> reference_noise_[0] >> reference_noise_[1];
  const Frame& frame = loaded_.frame();
  const FrameReport report = inspect(frame);
  exec::Runner runner{params_.execution};
  source_ = std::make_unique<Source>(frame, report);
  if (params_.outliers.enabled) source_->replace(find_outliers(*source_, params_.outliers, runner).pixels);
  layers_ = std::make_unique<LayerSource>(frame, report, *source_);
  geometry_ = {frame.width, frame.height, 128, 32, frame.height};
  runs_ = std::make_unique<FilterRuns>(
      *source_, *layers_,
      FilterPlan{params_.filters.front(), method_of(params), params_.monte_carlo, params.risk == Risk::kAuto},
      geometry_, std::vector<int>(), std::vector<int>(), runner.slots());
  std::vector<exec::RowStage> stages;
  runs_->add_stages(
      {}, [](const Rect&, int) {}, stages);
  exec::run_row_pipeline(geometry_, stages, runner, 0.0);
}

Bank::Pixel Bank::pixel(int entry, int channel, int x, int y) const {
  const auto c = static_cast<std::size_t>(channel);
  float mean = 0;
  float variance = 0;
  source_->input_row(c, y, x, 1, &mean, &variance);
  float F = 0;
  float D = 0;
  if (entry == 0) {
    source_->colour_row(c, y, x, 1, &F);
    source_->colour_covariance_row(c, c, y, x, 1, &D);
  } else {
    F = runs_->candidates().result(entry - 1, channel, y)[x];
    D = runs_->candidates().divergence(entry - 1, channel, y)[x];
  }
  return {F, D, mean, variance, reference_.planes[c].row(y)[x]};
}

EntryErrors Bank::errors(int entry) const {
  struct Sums {
    double estimated = 0;
    double truth = 0;
  };
  std::vector<Sums> relative;
  EntryErrors errors;
  for (int y = 0; y < geometry_.height; ++y) {
    for (int x = 0; x < geometry_.width; ++x) {
      Sums sums;
      for (int c = 0; c < 3; ++c) {
        const Pixel p = pixel(entry, c, x, y);
        const double weight = 1.0 / (p.truth * p.truth + kEpsilon);
        const double estimated = (p.F - p.mean) * (p.F - p.mean) + 2.0 * p.D - p.variance;
        const double truth = (p.F - p.truth) * (p.F - p.truth);
        errors.estimated += estimated;
        errors.truth += truth;
        sums.estimated += weight * estimated;
        sums.truth += weight * truth;
      }
      errors.estimated_relative += sums.estimated;
      errors.true_relative += sums.truth;
      relative.push_back(sums);
    }
  }
  const double count = 3.0 * geometry_.width * geometry_.height;
  errors.estimated /= count;
  errors.truth = errors.truth / count - reference_noise_[0];
  std::sort(relative.begin(), relative.end(), [](const Sums& a, const Sums& b) {
    return std::abs(a.estimated - a.truth) < std::abs(b.estimated - b.truth);
  });
  Sums kept;
  for (std::size_t i = 0; i < relative.size() - relative.size() / 10000; ++i) {
    kept.estimated += relative[i].estimated;
    kept.truth += relative[i].truth;
  }
  errors.trimmed_ratio = kept.estimated / (kept.truth - count * reference_noise_[1]);
  errors.estimated_relative /= count;
  errors.true_relative = errors.true_relative / count - reference_noise_[1];
  return errors;
}

double Bank::relative_error(const std::vector<int>& entry_of_pixel) const {
  double sum = 0;
  for (int y = 0; y < geometry_.height; ++y) {
    for (int x = 0; x < geometry_.width; ++x) {
      const int entry = entry_of_pixel[static_cast<std::size_t>(y) * static_cast<std::size_t>(geometry_.width) +
                                       static_cast<std::size_t>(x)];
      for (int c = 0; c < 3; ++c) {
        const Pixel p = pixel(entry, c, x, y);
        sum += (p.F - p.truth) * (p.F - p.truth) / (p.truth * p.truth + kEpsilon);
      }
    }
  }
  return sum / (3.0 * geometry_.width * geometry_.height);
}

// The entry of least true error, smoothed as the library smooths its risks.
std::vector<int> Bank::least_true_error() const {
  const Rect image{0, 0, geometry_.width, geometry_.height};
  const auto make = [&] { return std::make_unique<exec::RowRing>(entries(), geometry_.width, geometry_.height); };
  std::unique_ptr<exec::RowRing> maps = make();
  for (int y = 0; y < geometry_.height; ++y) {
    for (int e = 0; e < entries(); ++e) {
      for (int x = 0; x < geometry_.width; ++x) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
          const Pixel p = pixel(e, c, x, y);
          sum += (p.F - p.truth) * (p.F - p.truth) / (p.truth * p.truth + kEpsilon) / 3.0;
        }
        maps->row(e, y)[x] = std::min(static_cast<float>(sum), runs_->risk_limit());
      }
    }
  }
  for (const int step : {1, 2, 4}) {
    std::unique_ptr<exec::RowRing> out = make();
    run_guided_pass({PassKernel::kBox, step, 2.0F, 1.0F}, runs_->guides(), geometry_.height, image,
                    {maps.get(), entries(), -1}, {out.get(), entries(), -1});
    maps = std::move(out);
  }
  std::vector<int> best;
  for (int y = 0; y < geometry_.height; ++y) {
    for (int x = 0; x < geometry_.width; ++x) {
      int least = 0;
      for (int e = 1; e < entries(); ++e) least = maps->row(e, y)[x] < maps->row(least, y)[x] ? e : least;
      best.push_back(least);
    }
  }
  return best;
}

// Of what the library makes with that rule.
double Bank::relative_error(Selection selection) const {
  DenoiseParams params = params_;
  params.selection = selection;
  const DenoiseResult result = denoise(loaded_.frame(), params);
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < geometry_.height; ++y) {
      for (int x = 0; x < geometry_.width; ++x) {
        const double truth = reference_.planes[c].row(y)[x];
        const double difference = result.colour[c].row(y)[x] - truth;
        sum += difference * difference / (truth * truth + kEpsilon);
      }
    }
  }
  return sum / (3.0 * geometry_.width * geometry_.height);
}

Choices Bank::choices() const {
  Choices choices;
  const auto pixels = static_cast<std::size_t>(geometry_.width) * static_cast<std::size_t>(geometry_.height);
  choices.best_single = relative_error(std::vector<int>(pixels, 0));
  for (int e = 1; e < entries(); ++e)
    choices.best_single = std::min(choices.best_single, relative_error(std::vector<int>(pixels, e)));
  choices.argmin = relative_error(Selection::kArgmin);
  choices.evidence = relative_error(Selection::kEvidence);
  choices.oracle = relative_error(least_true_error());
  return choices;
}

}  // namespace stein::quality
