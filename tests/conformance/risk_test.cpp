// SPDX-License-Identifier: Apache-2.0
//
// The mean of the risk against the mean of the true error, over many realisations of Gaussian noise on synthetic
// scenes. Fixed seeds; bounds are four standard errors, computed from the realisations.
#include <cmath>

#include "catch.hpp"
#include "risk/sure.hpp"
#include "support/noisy_scene.hpp"
#include "support/statistics.hpp"
#include "support/synthetic.hpp"

namespace stein::test {
namespace {

constexpr float kStep = 0.02F;  // of Monte Carlo perturbations, in standard deviations

std::vector<FilterSpec> specs() {
  std::vector<FilterSpec> all;
  for (const std::string_view name : filter_names()) all.push_back(make_filter(name));
  CrossBilateralParams with_range;  // nonlinear in the colour
  with_range.range_sigma = 0.6F;
  all.emplace_back(with_range);
  CrossNlmParams absolute;
  absolute.distance = PatchDistance::kAbsolute;
  absolute.range_sigmas = {0.1F, 0.4F};
  all.emplace_back(absolute);
  CrossBilateralParams smoothed;
  smoothed.guides.smoothing_radius = 2;
  all.emplace_back(smoothed);
  CrossNlmParams smoothed_patches;
  smoothed_patches.range_sigmas = {1.0F};
  smoothed_patches.guides.smoothing_radius = 2;
  all.emplace_back(smoothed_patches);
  for (FilterSpec& spec : all) {  // wider windows test nothing that a smaller one does not
    if (CrossNlmParams* params = std::get_if<CrossNlmParams>(&spec)) params->window_radius = 5;
    if (AdaptiveOrderParams* params = std::get_if<AdaptiveOrderParams>(&spec)) {
      params->window_radius = 4;
      params->range_sigmas = {1.0F};
    }
  }
  for (const float weight : {0.2F, 0.4F, 0.6F, 0.8F, 1.0F}) {  // 0 is the plain filter
    AtrousSureParams kept;
    kept.fixed_weight = weight;
    kept.plain = weight == 0.2F;
    all.emplace_back(kept);
  }
  return all;
}

// The divergence term of a realisation by each estimate, [candidate][channel].
struct Estimates {
  BankResult plain;
  BankResult joint;
  BankResult monte_carlo;
  bool is_closed = false;
};

Estimates estimate(const FilterSpec& spec, const Frame& frame, int realisation) {
  Estimates all;
  all.is_closed = has_derivative(spec);
  if (all.is_closed) {
    all.joint = run_filter(spec, frame);
    all.plain = run_filter(spec, frame, {.divergence = Divergence::kPlain});
  }
  all.monte_carlo = run_with_draw(spec, frame, {static_cast<std::uint64_t>(realisation) + 1, 0, kStep});
  return all;
}

// Risk minus true error, mean over the image, of the candidate that `choose` names for each pixel.
template <class Choose>
double bias(const NoisyScene& scene, const BankResult& bank, Choose choose) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < scene.height(); ++y) {
      for (int x = 0; x < scene.width(); ++x) {
        const std::size_t k = choose(x, y, c);
        const float mean = scene.frame().colour[c].at(x, y);
        const float variance = scene.frame().colour_variance[c].at(x, y);
        const float f = bank.result[k][c].row(y)[x];
        float risk = 0;
        sure_row(&f, &bank.divergence[k][c].row(y)[x], &mean, &variance, 1, &risk);
        const double error = f - scene.truth(c, x, y);
        sum += risk - error * error;
      }
    }
  }
  return sum / (3.0 * scene.width() * scene.height());
}

double true_error(const NoisyScene& scene, const BankResult& bank, std::size_t k) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < scene.height(); ++y) {
      for (int x = 0; x < scene.width(); ++x) sum += std::pow(bank.result[k][c].row(y)[x] - scene.truth(c, x, y), 2);
    }
  }
  return sum / (3.0 * scene.width() * scene.height());
}

// The candidate of least risk of a single pixel and channel.
std::size_t argmin(const NoisyScene& scene, const BankResult& bank, int x, int y, std::size_t c) {
  std::size_t best = 0;
  double least = 0;
  for (std::size_t k = 0; k < bank.result.size(); ++k) {
    const double difference = bank.result[k][c].row(y)[x] - scene.frame().colour[c].at(x, y);
    const double risk = difference * difference + 2.0 * bank.divergence[k][c].row(y)[x];
    if (k == 0 || risk < least) {
      least = risk;
      best = k;
    }
  }
  return best;
}

struct Biases {
  std::vector<Statistics> plain, joint, monte_carlo, closed_minus_monte_carlo, error;  // per candidate
  Statistics choice;
};

Biases measure(const FilterSpec& spec, NoisyScene& scene, int realisations) {
  const std::size_t candidates = candidate_names(spec).size() - 1;
  Biases all;
  for (auto* means : {&all.plain, &all.joint, &all.monte_carlo, &all.closed_minus_monte_carlo, &all.error})
    means->resize(candidates);
  for (int i = 0; i < realisations; ++i) {
    scene.draw();
    const Estimates e = estimate(spec, scene.frame(), i);
    for (std::size_t k = 0; k < candidates; ++k) {
      const auto fixed = [k](int, int, std::size_t) { return k; };
      const double by_draw = bias(scene, e.monte_carlo, fixed);
      all.monte_carlo[k].add(by_draw);
      all.error[k].add(true_error(scene, e.monte_carlo, k));
      if (!e.is_closed) continue;
      const double closed = bias(scene, e.joint, fixed);
      all.joint[k].add(closed);
      all.closed_minus_monte_carlo[k].add(closed - by_draw);
      all.plain[k].add(bias(scene, e.plain, fixed));
    }
    if (!e.is_closed || candidates < 2) continue;
    const auto chosen = [&](int x, int y, std::size_t c) { return argmin(scene, e.joint, x, y, c); };
    all.choice.add(bias(scene, e.joint, chosen));
  }
  return all;
}

void check_nearly_unbiased(const Statistics& bias, double gap) {
  INFO("bias " << bias.mean() << " +- " << bias.standard_error());
  CHECK(std::abs(bias.mean()) < gap + 4.0 * bias.standard_error());
}

void check_unbiased(const Statistics& bias) { check_nearly_unbiased(bias, 0.0); }

// What the closed form leaves out, as a share of the true error: in the regression, that the smoothed features of
// neighbours move with the pixel's own (docs/filters/adaptive_order.md).
double closed_form_gap(const FilterSpec& spec) { return std::holds_alternative<AdaptiveOrderParams>(spec) ? 0.1 : 0.0; }

// A standard error, as a share of the true error, that is sharp enough to notice a missing term.
double sharpness(const FilterSpec& spec) { return std::holds_alternative<AdaptiveOrderParams>(spec) ? 0.06 : 0.02; }

void check_risks(const FilterSpec& spec, NoisyScene& scene, int realisations) {
  const Biases all = measure(spec, scene, realisations);
  for (std::size_t k = 0; k < all.error.size(); ++k) {
    INFO(filter_name(spec) << ", " << candidate_names(spec)[k + 1] << ", true error " << all.error[k].mean());
    check_unbiased(all.monte_carlo[k]);
    CHECK(all.monte_carlo[k].standard_error() < sharpness(spec) * all.error[k].mean());
    if (!has_derivative(spec)) continue;
    const double gap = closed_form_gap(spec) * all.error[k].mean();
    check_nearly_unbiased(all.joint[k], gap);
    CHECK(all.joint[k].standard_error() < sharpness(spec) * all.error[k].mean());
    check_nearly_unbiased(all.closed_minus_monte_carlo[k], gap);
  }
  if (all.choice.count() == 0) return;
  // What is chosen by its own risk looks better than it is (docs/selection.md): a choice per pixel is no fixed filter.
  INFO(filter_name(spec) << ": bias of the choice " << all.choice.mean() << " +- " << all.choice.standard_error());
  CHECK(all.choice.mean() < -4.0 * all.choice.standard_error());
}

}  // namespace

TEST_CASE("risk: exact features, where plain SURE is unbiased as well") {
  for (const FilterSpec& spec : specs()) {
    if (!has_derivative(spec)) continue;
    NoisyScene scene({.feature_noise = false, .seed = 1234});
    const Biases all = measure(spec, scene, 200);
    for (std::size_t k = 0; k < all.error.size(); ++k) {
      INFO(filter_name(spec) << ", " << candidate_names(spec)[k + 1]);
      const auto* bilateral = std::get_if<CrossBilateralParams>(&spec);
      const bool is_linear =
          std::holds_alternative<GaussianParams>(spec) || (bilateral != nullptr && bilateral->range_sigma == 0.0F);
      if (is_linear) check_unbiased(all.plain[k]);  // else the channels, whose noise is correlated, mix
      check_unbiased(all.joint[k]);
    }
  }
}

TEST_CASE("risk: joint and Monte Carlo SURE are unbiased where colour and features are noisy together") {
  for (const FilterSpec& spec : specs()) {
    NoisyScene scene({.feature_noise = true, .seed = 4321});
    const bool is_slow = std::holds_alternative<AdaptiveOrderParams>(spec);
    check_risks(spec, scene, is_slow ? 500 : 2000);
  }
}

// Few events are no Gaussian noise: where noise is Gaussian and large, taking it for a count's says too much.
TEST_CASE("risk: noise that is Gaussian, taken for that of few events, leaves the risk within a tenth") {
  CrossNlmParams nlm;
  nlm.window_radius = 5;
  for (const FilterSpec& spec : {FilterSpec(CrossBilateralParams{}), FilterSpec(nlm)}) {
    NoisyScene scene({.feature_noise = true, .seed = 77});
    const std::size_t candidates = candidate_names(spec).size() - 1;
    std::vector<Statistics> biases(candidates);
    std::vector<Statistics> errors(candidates);
    for (int i = 0; i < 300; ++i) {
      scene.draw();
      const BankResult bank = run_filter(spec, scene.frame(), {.counts = true});
      for (std::size_t k = 0; k < candidates; ++k) {
        biases[k].add(bias(scene, bank, [k](int, int, std::size_t) { return k; }));
        errors[k].add(true_error(scene, bank, k));
      }
    }
    for (std::size_t k = 0; k < candidates; ++k) {
      INFO(filter_name(spec) << ", " << candidate_names(spec)[k + 1] << ", true error " << errors[k].mean());
      check_nearly_unbiased(biases[k], 0.1 * errors[k].mean());
      CHECK(biases[k].standard_error() < 0.02 * errors[k].mean());
    }
  }
}

TEST_CASE("risk: plain SURE fails where colour and features are noisy together") {
  NoisyScene scene({.feature_noise = true, .seed = 99});
  const Biases all = measure(CrossBilateralParams{}, scene, 100);
  for (std::size_t k = 0; k < all.error.size(); ++k) {
    INFO("plain bias " << all.plain[k].mean() << " +- " << all.plain[k].standard_error() << ", true error "
                       << all.error[k].mean());
    CHECK(all.plain[k].mean() < -0.2 * all.error[k].mean());
    CHECK(all.plain[k].mean() < -10.0 * all.plain[k].standard_error());
  }
}

}  // namespace stein::test
