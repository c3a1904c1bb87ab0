// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include "catch.hpp"

using stein::cli::time_left;

TEST_CASE("progress: the time left at the pace so far") {
  CHECK(time_left(10, 0.5) == " 0:10 left");
  CHECK(time_left(100, 0.25) == " 5:00 left");
  CHECK(time_left(61, 0.5) == " 1:01 left");
  CHECK(time_left(7199, 0.5) == " 1:59:59 left");
  CHECK(time_left(36000, 0.1) == " 90:00:00 left");
}

TEST_CASE("progress: no time left where nothing is known of it, or nothing is left") {
  CHECK(time_left(0, 0).empty());
  CHECK(time_left(2, 0.5).empty());
  CHECK(time_left(100, 0.001).empty());
  CHECK(time_left(100, 1).empty());
}
