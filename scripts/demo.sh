#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds stein, denoises the sample image, measures it against its reference, and leaves pictures in out/.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install-packages.sh
cmake --preset release
cmake --build --preset release --target stein_cli

stein=build/release/examples/cli/stein
noisy=examples/data/cornell_8spp.exr
reference=examples/data/cornell_reference.exr
mkdir -p out

"$stein" denoise "$noisy" -o out/cornell.exr
printf '\nBefore (8 samples per pixel), against the reference:\n'
"$stein" compare "$noisy" "$reference"
printf '\nAfter; "estimated" is what stein says without knowing the reference:\n'
"$stein" compare out/cornell.exr "$reference"

"$stein" preview "$noisy" -o out/noisy.png
"$stein" preview out/cornell.exr -o out/denoised.png
"$stein" preview "$reference" -o out/reference.png
for layer in error choice density; do
  "$stein" preview out/cornell.exr -o "out/$layer.png" --layer "$layer"
done
printf '\nPictures:\n'
ls out/*.png
