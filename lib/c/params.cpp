// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "c/boundary.hpp"
#include "c/filter_options.hpp"
#include "c/handles.hpp"
#include "core/parameter_check.hpp"

namespace stein::c {
namespace {

// A whole number. Limits of options are in check(DenoiseParams); those here keep the conversion defined.
std::uint64_t whole(const std::string& name, double value, double highest) {
  if (value >= 0 && value <= highest && value == std::floor(value)) return static_cast<std::uint64_t>(value);
  refuse(name + " is " + to_text(static_cast<float>(value)) + ", must be a whole number in [0.." +
         std::to_string(static_cast<std::uint64_t>(highest)) + "]");
}

int whole(const std::string& name, double value) { return static_cast<int>(whole(name, value, 1e6)); }

bool yes_or_no(const std::string& name, double value) { return whole(name, value, 1) == 1; }

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

// An option that is a value of the type given: its name and what sets it.
template <class Value>
struct Option {
  std::string_view name;
  void (*set)(DenoiseParams& params, const std::string& name, Value value);
};

constexpr auto kTexts = std::to_array<Option<const std::string&>>({
    {"bank", [](DenoiseParams& p, const std::string& n, const std::string& v) { set_bank(p.filter, n, v); }},
    {"order", [](DenoiseParams& p, const std::string& n, const std::string& v) { set_order(p.filter, n, v); }},
    {"order-error", [](DenoiseParams& p, const std::string& n, const std::string& v) { set_judge(p.filter, n, v); }},
    {"risk", [](DenoiseParams& p, const std::string& n, const std::string& v) { p.risk = risk_of(n, v); }},
    {"selection",
     [](DenoiseParams& p, const std::string& n, const std::string& v) { p.selection = selection_of(n, v); }},
});

constexpr double kLargestSeed = 9007199254740992.0;  // 2^53: a double has all whole numbers up to there

constexpr auto kNumbers = std::to_array<Option<double>>({
    {"range-sigma", [](DenoiseParams& p, const std::string& n, double v) { set_range_sigma(p.filter, n, v); }},
    {"strength", [](DenoiseParams& p, const std::string&, double v) { p.strength = static_cast<float>(v); }},
    {"draws", [](DenoiseParams& p, const std::string& n, double v) { p.monte_carlo.draws = whole(n, v); }},
    {"seed", [](DenoiseParams& p, const std::string& n, double v) { p.monte_carlo.seed = whole(n, v, kLargestSeed); }},
    {"outliers", [](DenoiseParams& p, const std::string& n, double v) { p.outliers.enabled = yes_or_no(n, v); }},
    {"strict", [](DenoiseParams& p, const std::string& n, double v) { p.strict = yes_or_no(n, v); }},
    {"threads", [](DenoiseParams& p, const std::string& n, double v) { p.execution.threads = whole(n, v); }},
    {"tile-width", [](DenoiseParams& p, const std::string& n, double v) { p.execution.tile_width = whole(n, v); }},
    {"tile-height", [](DenoiseParams& p, const std::string& n, double v) { p.execution.tile_height = whole(n, v); }},
});

constexpr std::string_view kSigmaPrefix = "feature-sigma.";

template <class Value, std::size_t count>
const Option<Value>* find(const std::array<Option<Value>, count>& options, std::string_view name) {
  const auto found = std::find_if(options.begin(), options.end(), [&](const auto& o) { return o.name == name; });
  return found == options.end() ? nullptr : &*found;
}

[[noreturn]] void refuse_name(const std::string& name) {
  if (find(kTexts, name) != nullptr) refuse(name + " is a text; use stein_params_set_text");
  if (find(kNumbers, name) != nullptr) refuse(name + " is a number; use stein_params_set_number");
  std::string names;
  for (const auto& option : kTexts) names += std::string(option.name) + ", ";
  for (const auto& option : kNumbers) names += std::string(option.name) + ", ";
  refuse("there is no option '" + name + "'; there are: " + names + std::string(kSigmaPrefix) + "<feature>");
}

void set_text(stein_params& params, const std::string& name, const std::string& value) {
  const auto* option = find(kTexts, name);
  if (option == nullptr) refuse_name(name);
  option->set(params.values, name, value);
}

void set_number(stein_params& params, const std::string& name, double value) {
  if (name.starts_with(kSigmaPrefix) && name.size() > kSigmaPrefix.size()) {
    const std::string feature = name.substr(kSigmaPrefix.size());
    set_feature_sigma(params.values.filter, name, feature, value);
    params.guiding.push_back(feature);
    return;
  }
  const auto* option = find(kNumbers, name);
  if (option == nullptr) refuse_name(name);
  option->set(params.values, name, value);
}

// On a copy: what fails changes nothing.
template <class Set>
void change(stein_params* params, const char* name, const Set& set) {
  require(params, "the parameters");
  require(name, "the name");
  stein_params changed = *params;
  set(changed);
  check(changed.values);
  *params = std::move(changed);
}

}  // namespace
}  // namespace stein::c

using stein::c::change;
using stein::c::guarded;
using stein::c::guarded_make;
using stein::c::require;
using stein::c::set_number;
using stein::c::set_text;

stein_status stein_params_create(const char* filter, stein_params** params) {
  return guarded_make("stein_params_create", params, [&] {
    auto made = std::make_unique<stein_params>();
    if (filter != nullptr) made->values.filter = stein::make_filter(filter);
    return made.release();
  });
}

void stein_params_destroy(stein_params* params) { delete params; }

stein_status stein_params_set_text(stein_params* params, const char* name, const char* value) {
  return guarded("stein_params_set_text", [&] {
    require(value, "the value");
    change(params, name, [&](stein_params& changed) { set_text(changed, name, value); });
  });
}

stein_status stein_params_set_number(stein_params* params, const char* name, double value) {
  return guarded("stein_params_set_number",
                 [&] { change(params, name, [&](stein_params& changed) { set_number(changed, name, value); }); });
}
