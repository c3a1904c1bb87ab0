#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Fuzzes with clang's libFuzzer, AddressSanitizer and UndefinedBehaviorSanitizer, from the corpus in tests/fuzz/corpus.
# What ends a target is left as build/fuzz/found/<target>-...; put it into the corpus when it is mended.
# Usage: scripts/fuzz.sh [SECONDS [TARGET...]]     seconds for each target, default 1800; targets: c exr options schema
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-1800}
shift || true
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(c exr options schema)

scripts/install-packages.sh --dev
cmake --preset fuzz
cmake --build --preset fuzz --target "${targets[@]/#/fuzz_}"

build=build/fuzz
mkdir -p $build/found
[ -w /dev/shm ] && export TMPDIR=/dev/shm  # targets that read files write them first
for target in "${targets[@]}"; do
  echo "== $target, $seconds s"
  mkdir -p "$build/corpus/$target"  # what this machine finds; the folder of the sources stays as it is
  "$build/tests/fuzz/fuzz_$target" -max_total_time="$seconds" -max_len=20000 -timeout=30 -rss_limit_mb=4096 \
    -print_final_stats=1 -artifact_prefix="$build/found/$target-" "$build/corpus/$target" "tests/fuzz/corpus/$target"
done
