// SPDX-License-Identifier: Apache-2.0
//
// The mean of the risk against the mean of the true error, on synthetic Gaussian noise with features free of noise,
// where plain SURE is unbiased. Fixed seeds; the bound is four standard errors of the difference, computed from the
// realisations.
#include <cmath>

#include "catch.hpp"
#include "risk/sure.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 40;
constexpr int kRealisations = 60;

double truth(int x, int y, std::size_t c) {
  return 1.0 + 0.6 * std::sin(0.21 * x + static_cast<double>(c)) * std::cos(0.17 * y) + (x > 22 ? 0.7 : 0.0);
}
double deviation(int x, int y) { return 0.15 + 0.2 * ((x / 8 + y / 8) % 2); }

// A frame with exact features and the variance of the noise that will be added.
void set_up(OwnedFrame& frame) {
  for (const std::string& name : frame.names()) {
    const bool is_variance = name.find("variance") != std::string::npos;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (name.rfind("variance.", 0) == 0) {
          frame.at(name, x, y) = static_cast<float>(deviation(x, y) * deviation(x, y));
        } else if (is_variance) {
          frame.at(name, x, y) = 0.0F;
        } else if (name.size() > 1 && name != "sampleCount") {
          frame.at(name, x, y) = x > 22 ? 0.2F : 0.25F;
        }
      }
    }
  }
}

struct Mean {
  double sum = 0;
  double sum_of_squares = 0;
  int count = 0;
  void add(double v) {
    sum += v;
    sum_of_squares += v * v;
    ++count;
  }
  [[nodiscard]] double value() const { return sum / count; }
  [[nodiscard]] double standard_error() const {
    return std::sqrt((sum_of_squares / count - value() * value()) / (count - 1));
  }
};

void add_noise(OwnedFrame& frame, Random& random) {
  constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x)
        frame.at(kRgb[c], x, y) = static_cast<float>(truth(x, y, c) + deviation(x, y) * random.normal());
    }
  }
}

// Mean over the image of estimated minus true squared error of one candidate.
double bias_of(const OwnedFrame& frame, const BankResult& bank, std::size_t candidate) {
  double sum = 0;
  std::vector<float> risk(kWidth);
  std::vector<float> mean(kWidth);
  std::vector<float> variance(kWidth);
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < kHeight; ++y) {
      frame.frame().colour[c].read_row(y, 0, kWidth, mean.data());
      frame.frame().colour_variance[c].read_row(y, 0, kWidth, variance.data());
      const float* F = bank.result[candidate][c].row(y);
      sure_row(F, bank.divergence[candidate][c].row(y), mean.data(), variance.data(), kWidth, risk.data());
      for (int x = 0; x < kWidth; ++x) {
        const double error = F[x] - truth(x, y, c);
        sum += risk[static_cast<std::size_t>(x)] - error * error;
      }
    }
  }
  return sum / (3.0 * kWidth * kHeight);
}

}  // namespace

TEST_CASE("SURE: the mean of the estimate is the mean of the true error, for every candidate of every filter") {
  std::vector<FilterSpec> specs;
  for (const std::string_view name : filter_names()) specs.push_back(make_filter(name));
  CrossBilateralParams with_range;  // nonlinear in the colour: its derivative has more than 1/W
  with_range.range_sigma = 0.6F;
  specs.emplace_back(with_range);
  CrossNlmParams absolute;
  absolute.distance = PatchDistance::kAbsolute;
  absolute.range_sigmas = {0.1F, 0.4F};
  specs.emplace_back(absolute);
  for (FilterSpec& spec : specs) {
    if (CrossNlmParams* params = std::get_if<CrossNlmParams>(&spec)) params->window_radius = 7;
  }
  for (const FilterSpec& spec : specs) {
    OwnedFrame frame(kWidth, kHeight, kUsualFeatures);
    set_up(frame);
    Random random(1234);
    std::vector<Mean> bias(candidate_names(spec).size() - 1);
    for (int i = 0; i < kRealisations; ++i) {
      add_noise(frame, random);
      const BankResult bank = run_filter(spec, frame.frame());
      for (std::size_t s = 0; s < bias.size(); ++s) bias[s].add(bias_of(frame, bank, s));
    }
    for (std::size_t s = 0; s < bias.size(); ++s) {
      INFO(filter_name(spec) << ", candidate " << s << ", bias " << bias[s].value() << " +- "
                             << bias[s].standard_error());
      CHECK(std::abs(bias[s].value()) < 4.0 * bias[s].standard_error());
      CHECK(bias[s].standard_error() <
            2e-3);  // sharp enough to notice a missing term: 2 v / W is above 1e-2 at the narrow end
    }
  }
}

}  // namespace stein::test
