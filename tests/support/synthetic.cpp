// SPDX-License-Identifier: Apache-2.0
#include "support/synthetic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "filters/filter.hpp"

namespace stein::test {

namespace {

constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};

}  // namespace

double Random::uniform() {  // SplitMix64
  std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

double Random::normal() {  // Box-Muller
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

OwnedFrame::OwnedFrame(int width, int height, const std::vector<FeatureShape>& features, bool has_covariances) {
  frame_.width = width;
  frame_.height = height;
  for (std::size_t c = 0; c < 3; ++c) {
    frame_.colour[c] = add(kRgb[c], 0.5F);
    frame_.colour_variance[c] = add(std::string("variance.") + kRgb[c], 0.01F);
  }
  frame_.sample_count = add("sampleCount", 8.0F);
  for (const FeatureShape& shape : features) {
    Feature feature;
    feature.name = shape.name;
    feature.mean.resize(static_cast<std::size_t>(shape.channels));  // names depend on the number of channels
    for (std::size_t k = 0; k < feature.mean.size(); ++k) {
      feature.mean[k] = add(plane_name(feature, k, false), 0.5F);
      feature.variance.push_back(add(plane_name(feature, k, true), 0.001F));
    }
    frame_.features.push_back(std::move(feature));
  }
  if (has_covariances) add_covariances();
}

void OwnedFrame::add_covariances() {
  frame_.colour_covariance = {add("covariance.R.G", 0.005F), add("covariance.R.B", 0.005F),
                              add("covariance.G.B", 0.005F)};
  for (Feature& feature : frame_.features) {
    for (const char* c : kRgb) {
      for (std::size_t k = 0; k < feature.mean.size(); ++k) {
        const std::string name = std::string("covariance.") + c + "." + plane_name(feature, k, false);
        feature.colour_covariance.push_back(add(name, 0.001F));
      }
    }
  }
}

ConstPlaneView OwnedFrame::add(const std::string& name, float value) {
  Plane plane(frame_.width, frame_.height);
  for (int y = 0; y < frame_.height; ++y) std::fill_n(plane.row(y), frame_.width, value);
  planes_.emplace_back(name, std::move(plane));
  return planes_.back().second.view();
}

Plane& OwnedFrame::plane(const std::string& name) {
  for (auto& [key, plane] : planes_) {
    if (key == name) return plane;
  }
  throw std::out_of_range("no plane " + name);
}

std::vector<std::string> OwnedFrame::names() const {
  std::vector<std::string> names;
  for (const auto& entry : planes_) names.push_back(entry.first);
  return names;
}

void fill_random(OwnedFrame& target, std::uint64_t seed) {
  Random random(seed);
  for (const std::string& name : target.names()) {
    if (name == "sampleCount") continue;
    const bool is_variance = name.find("variance") != std::string::npos;
    const bool is_covariance = name.rfind("covariance.", 0) == 0;
    const bool is_colour = name.size() == 1;
    const double left = random.uniform();
    const double right = random.uniform();
    for (int y = 0; y < target.frame().height; ++y) {
      for (int x = 0; x < target.frame().width; ++x) {
        const double base = 3 * x + 2 * y < target.frame().width + target.frame().height ? left : right;
        const double noise = random.normal();
        if (is_covariance) {  // below the least of the variances, so below any product of standard deviations
          target.at(name, x, y) = static_cast<float>(0.0018 * (2.0 * random.uniform() - 1.0));
          continue;
        }
        const double value = is_variance ? 0.002 * (1.0 + random.uniform()) : base + (is_colour ? 0.3 : 0.05) * noise;
        target.at(name, x, y) = static_cast<float>(value);
      }
    }
  }
}

BankResult run_filter(const FilterSpec& spec, const Frame& frame, const RunOptions& options) {
  const Source own(frame, inspect(frame));
  const Source source = options.perturbation ? own.perturbed(*options.perturbation) : own;
  const GuideRows guides = make_guides(spec, source, {frame.height, frame.width, frame.height});
  FilterScratch scratch;
  guides.prepare({0, 0, frame.width, frame.height}, scratch);
  const auto filter = prepare(spec, {source, guides, options.tile_width, options.tile_height, frame.height,
                                     options.divergence, nullptr, options.counts});
  const exec::RowRing ring(filter->candidates() * CandidateRows::kPlanes, frame.width, frame.height);
  const CandidateRows rows(ring);
  for (std::size_t pass = 0; pass < halos(spec).size(); ++pass) {
    for (int y = 0; y < frame.height; y += options.tile_height) {
      for (int x = 0; x < frame.width; x += options.tile_width) {
        const Rect tile{x, y, std::min(x + options.tile_width, frame.width),
                        std::min(y + options.tile_height, frame.height)};
        filter->run(static_cast<int>(pass), tile, scratch, rows);
      }
    }
  }
  BankResult bank;
  bank.halo = reach(spec);
  for (int s = 0; s < filter->candidates(); ++s) {
    std::array<Plane, 3> result;
    std::array<Plane, 3> divergence;
    for (int c = 0; c < 3; ++c) {
      const auto channel = static_cast<std::size_t>(c);
      result[channel] = Plane(frame.width, frame.height);
      divergence[channel] = Plane(frame.width, frame.height);
      for (int y = 0; y < frame.height; ++y) {
        std::copy_n(rows.result(s, c, y), frame.width, result[channel].row(y));
        std::copy_n(rows.divergence(s, c, y), frame.width, divergence[channel].row(y));
      }
    }
    bank.result.push_back(std::move(result));
    if (has_derivative(spec)) bank.divergence.push_back(std::move(divergence));
  }
  return bank;
}

BankResult run_with_draw(const FilterSpec& spec, const Frame& frame, const Perturbation& draw) {
  BankResult bank = run_filter(spec, frame);
  bank.divergence = run_filter(spec, frame, {64, 32, Divergence::kPlain, draw}).result;
  const Source moved = Source(frame, inspect(frame)).perturbed(draw);
  std::vector<float> b(static_cast<std::size_t>(frame.width));
  for (std::size_t s = 0; s < bank.result.size(); ++s) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < frame.height; ++y) {
        moved.direction_row(c, y, 0, frame.width, b.data());
        float* D = bank.divergence[s][c].row(y);
        const float* F = bank.result[s][c].row(y);
        for (int x = 0; x < frame.width; ++x) D[x] = b[static_cast<std::size_t>(x)] * (D[x] - F[x]) / draw.step;
      }
    }
  }
  return bank;
}

}  // namespace stein::test
