// SPDX-License-Identifier: Apache-2.0
//
// Options of filters by name, for every filter whose parameters have what the option sets.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "c/boundary.hpp"
#include "stein/filters.hpp"

namespace stein::c {

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
  refuse(name + " is '" + text + "'; it can be: " + known);
}

// Each throws Error kInvalidArgument where the filter has no such option, or the option no such word.
void set_bank(FilterSpec& spec, const std::string& name, const std::string& text);
void set_order(FilterSpec& spec, const std::string& name, const std::string& text);
void set_judge(FilterSpec& spec, const std::string& name, const std::string& text);
void set_range_sigma(FilterSpec& spec, const std::string& name, double sigma);
void set_feature_sigma(FilterSpec& spec, const std::string& name, const std::string& feature, double sigma);

}  // namespace stein::c
