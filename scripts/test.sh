#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds everything with warnings as errors and runs all tests.
# Usage: scripts/test.sh [--preset NAME] [ctest options]     presets: see CMakePresets.json; default: ci
set -euo pipefail
cd "$(dirname "$0")/.."

preset=ci
if [ "${1:-}" = --preset ]; then
  preset=${2:?"--preset needs a name; see CMakePresets.json"}
  shift 2
fi

scripts/install-packages.sh
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset" "$@"
