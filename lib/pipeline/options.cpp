// SPDX-License-Identifier: Apache-2.0
#include "stein/options.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/filter_options.hpp"

namespace stein {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

Risk risk_of(const std::string& name, const std::string& text) {
  constexpr std::array<Word<Risk>, 4> kWords = {
      {{"auto", Risk::kAuto}, {"sure", Risk::kPlain}, {"joint", Risk::kJoint}, {"monte-carlo", Risk::kMonteCarlo}}};
  return choose(name, text, kWords);
}

Selection selection_of(const std::string& name, const std::string& text) {
  constexpr std::array<Word<Selection>, 2> kWords = {
      {{"evidence", Selection::kEvidence}, {"argmin", Selection::kArgmin}}};
  return choose(name, text, kWords);
}

DensityRule density_rule_of(const std::string& name, const std::string& text) {
  constexpr std::array<Word<DensityRule>, 3> kWords = {{{"next-samples", DensityRule::kNextSamples},
                                                        {"all-samples", DensityRule::kAllSamples},
                                                        {"error-reduction", DensityRule::kErrorReduction}}};
  return choose(name, text, kWords);
}

int count_of(const std::string& name, double value) { return static_cast<int>(whole(name, value)); }

std::uint64_t seed_of(const std::string& name, double value) {
  constexpr double kLargest = 9007199254740992.0;  // 2^53: a double has all whole numbers up to there
  return static_cast<std::uint64_t>(whole(name, value, kLargest));
}

void set_quality(DenoiseParams& params, const std::string& name, const std::string& text) {
  constexpr std::array<Word<Quality>, 3> kWords = {
      {{"fast", Quality::kFast}, {"default", Quality::kDefault}, {"best", Quality::kBest}}};
  const Quality quality = choose(name, text, kWords);
  params.filters = filters_of(quality);
  params.second_pass = quality == Quality::kBest;
}

std::int64_t bytes_of(const std::string& name, double value) {
  constexpr double kLargest = 1152921504606846976.0;  // 2^60
  return static_cast<std::int64_t>(whole(name, value, kLargest));
}

// The limit of a Memory is fixed: another one takes its place.
template <class Change>
void limit_memory(DenoiseParams& params, const Change& change) {
  MemoryLimit limit = params.execution.memory ? params.execution.memory->limit() : MemoryLimit{};
  change(limit);
  params.execution.memory = std::make_shared<Memory>(std::move(limit));
}

using Params = DenoiseParams;
using Text = std::string;

constexpr auto kTexts = std::to_array<Option<Params, const Text&>>({
    {"quality", set_quality},
    {"risk", [](Params& p, const Text& n, const Text& v) { p.risk = risk_of(n, v); }},
    {"selection", [](Params& p, const Text& n, const Text& v) { p.selection = selection_of(n, v); }},
    {"density-rule", [](Params& p, const Text& n, const Text& v) { p.density.rule = density_rule_of(n, v); }},
    {"scratch",
     [](Params& p, const Text&, const Text& v) { limit_memory(p, [&](MemoryLimit& l) { l.scratch_folder = v; }); }},
});

constexpr auto kNumbers = std::to_array<Option<Params, double>>({
    {"strength", [](Params& p, const Text&, double v) { p.strength = static_cast<float>(v); }},
    {"draws", [](Params& p, const Text& n, double v) { p.monte_carlo.draws = count_of(n, v); }},
    {"seed", [](Params& p, const Text& n, double v) { p.monte_carlo.seed = seed_of(n, v); }},
    {"outliers", [](Params& p, const Text& n, double v) { p.outliers.enabled = yes_or_no(n, v); }},
    {"second-pass", [](Params& p, const Text& n, double v) { p.second_pass = yes_or_no(n, v); }},
    {"strict", [](Params& p, const Text& n, double v) { p.strict = yes_or_no(n, v); }},
    {"threads", [](Params& p, const Text& n, double v) { p.execution.threads = count_of(n, v); }},
    {"tile-width", [](Params& p, const Text& n, double v) { p.execution.tile_width = count_of(n, v); }},
    {"tile-height", [](Params& p, const Text& n, double v) { p.execution.tile_height = count_of(n, v); }},
    {"max-memory",
     [](Params& p, const Text& n, double v) { limit_memory(p, [&](MemoryLimit& l) { l.bytes = bytes_of(n, v); }); }},
});

[[noreturn]] void refuse_name(const std::string& name) {
  const OptionKind kind = filter_option_kind(name);
  if (kind == OptionKind::kText || find_option(kTexts, name) != nullptr) refuse(name + " is a text, not a number");
  if (kind == OptionKind::kNumber || find_option(kNumbers, name) != nullptr) refuse(name + " is a number, not a text");
  std::string names;
  for (const auto& option : kTexts) names += std::string(option.name) + ", ";
  for (const auto& option : kNumbers) names += std::string(option.name) + ", ";
  refuse("there is no option '" + name + "'; there are: " + names + filter_option_names());
}

template <class Options, class Value>
void set(DenoiseParams& params, const std::string& name, const Options& options, const Value& value) {
  if (set_filter_option(params.filters, name, value)) return;
  const auto* option = find_option(options, name);
  if (option == nullptr) refuse_name(name);
  option->set(params, name, value);
}

}  // namespace

void set_option(DenoiseParams& params, const std::string& name, const std::string& text) {
  set(params, name, kTexts, text);
}

void set_option(DenoiseParams& params, const std::string& name, double value) { set(params, name, kNumbers, value); }

void require_feature(const Frame& frame, const std::string& name) {
  std::string names;
  for (const Feature& feature : frame.features) {
    if (feature.name == name) return;
    names += " " + feature.name;
  }
  refuse("feature-sigma: " + (frame.origin.empty() ? "the frame" : frame.origin) + " has no feature '" + name +
         "'; it has:" + (names.empty() ? " none" : names));
}

}  // namespace stein
