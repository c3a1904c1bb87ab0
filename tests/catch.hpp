// SPDX-License-Identifier: Apache-2.0
//
// Catch2 2 and 3 have different headers: tests include this one only.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
using Catch::Detail::Approx;
#endif
