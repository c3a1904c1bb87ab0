// SPDX-License-Identifier: Apache-2.0
//
// Parameters of filters by name: an option belongs to every filter whose parameters have what it sets.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "stein/error.hpp"
#include "stein/filters.hpp"

namespace stein {

/// An option that is a value of the type given: its name and what sets it.
template <class Target, class Value>
struct Option {
  std::string_view name;
  void (*set)(Target& target, const std::string& name, Value value);
};

/// The option of this name, or null.
template <class Options>
auto find_option(const Options& options, std::string_view name) -> decltype(options.data()) {
  for (const auto& option : options) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

/// A word that an option can be, and what it stands for.
template <class Value>
struct Word {
  std::string_view text;
  Value value;
};

/// @throws Error kInvalidArgument listing the words if `text` is none of them.
template <class Value, std::size_t count>
Value choose(const std::string& name, const std::string& text, const std::array<Word<Value>, count>& words) {
  std::string known;
  for (const Word<Value>& word : words) {
    if (text == word.text) return word.value;
    known += (known.empty() ? "" : ", ") + std::string(word.text);
  }
  throw Error(ErrorCode::kInvalidArgument, name + " is '" + text + "'; it can be: " + known);
}

/// @throws Error kInvalidArgument unless `value` is a whole number of [0..highest].
[[nodiscard]] double whole(const std::string& name, double value, double highest = 1e6);

/// @throws Error kInvalidArgument unless `value` is 0 or 1.
[[nodiscard]] inline bool yes_or_no(const std::string& name, double value) { return whole(name, value, 1) == 1; }

inline constexpr std::string_view kFeatureSigmaPrefix = "feature-sigma.";

/// The feature that feature-sigma.<feature> is about; empty for other options.
[[nodiscard]] std::string_view feature_of_option(std::string_view name);

/// Both set it for every filter of the list that has it, and return whether there is an option of this name and kind.
/// @throws Error kInvalidArgument if none of the filters has it, or it cannot have this value.
[[nodiscard]] bool set_filter_option(std::vector<FilterSpec>& filters, const std::string& name,
                                     const std::string& text);
[[nodiscard]] bool set_filter_option(std::vector<FilterSpec>& filters, const std::string& name, double value);

enum class OptionKind { kNone, kText, kNumber };
[[nodiscard]] OptionKind filter_option_kind(std::string_view name);

/// All names, with commas between.
[[nodiscard]] std::string filter_option_names();

}  // namespace stein
