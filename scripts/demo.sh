#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds stein and the example path tracer, renders a noisy image with uniform and with adaptive samples, denoises it, measures
# it against its reference, and leaves pictures in out/.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install-packages.sh
cmake --preset release
cmake --build --preset release --target stein_cli pathtracer

stein=build/release/examples/cli/stein
pathtracer=build/release/examples/pathtracer/pathtracer
reference=examples/data/tea_table_reference.exr  # seeds 1000 and 2000, 1024 samples each; half
render=(--scene tea-table --size 320x240 --samples 16)
mkdir -p out

printf '\nRendering, 16 samples per pixel; then as many samples, where they lower the error most:\n'
"$pathtracer" "${render[@]}" -o out/uniform.exr
"$pathtracer" "${render[@]}" --adaptive -o out/adaptive.exr --denoised out/adaptive_denoised.exr
"$stein" denoise out/uniform.exr -o out/uniform_denoised.exr

printf '\nBefore (16 samples per pixel), against the reference:\n'
"$stein" compare out/uniform.exr "$reference"
printf '\nDenoised; "estimated" is what stein says without knowing the reference, to be compared with "true":\n'
"$stein" compare out/uniform_denoised.exr "$reference"
printf '\nAdaptive and denoised:\n'
"$stein" compare out/adaptive_denoised.exr "$reference"

"$stein" preview out/uniform.exr -o out/noisy.png
"$stein" preview out/uniform_denoised.exr -o out/denoised.png
"$stein" preview out/adaptive_denoised.exr -o out/adaptive_denoised.png
"$stein" preview "$reference" -o out/reference.png
"$stein" preview out/adaptive.exr -o out/samples.png --layer sampleCount
"$stein" preview out/adaptive_denoised.exr -o out/error.png --layer error
"$stein" preview out/uniform_denoised.exr -o out/choice.png --layer choice
printf '\nPictures:\n'
ls out/*.png
