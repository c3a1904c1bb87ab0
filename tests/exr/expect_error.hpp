// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "stein/error.hpp"

/// Runs `work`, which must throw stein::Error of that code with all of these words in its message.
template <class Work>
void expect_error(stein::ErrorCode code, const std::vector<std::string>& words, Work&& work) {
  try {
    std::forward<Work>(work)();
  } catch (const stein::Error& error) {
    CHECK(error.code() == code);
    const std::string message = error.what();
    for (const std::string& word : words) {
      INFO(message << " should contain " << word);
      CHECK(message.find(word) != std::string::npos);
    }
    return;
  }
  FAIL("no stein::Error was thrown");
}
