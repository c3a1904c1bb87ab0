#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds and runs programs with the compilers and what pkg-config says of an installed stein, moved elsewhere first.
# Usage: pkg_config.sh PREFIX LIBDIR VERSION MAIN.C [EXR.CPP]     in the environment: CC, CXX, PKG_CONFIG
#   MAIN.C: a program in C that needs stein; EXR.CPP: one in C++ that needs stein_exr, and is told the file to write
set -euo pipefail
prefix=$1 libdir=$2 version=$3 in_c=$4 with_exr=${5:-}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -a "$prefix" "$folder/moved"
libdir=$folder/moved/${libdir#"$prefix"/}
export PKG_CONFIG_PATH=$libdir/pkgconfig

[ "$("$PKG_CONFIG" --modversion stein)" = "$version" ]
flags=$("$PKG_CONFIG" --cflags --libs stein)
[[ $flags == *"$folder/moved"* ]] || { echo "not relocatable: $flags"; exit 1; }
# shellcheck disable=SC2086  # one word each
"$CC" -std=c99 -Wall -Wextra -Wpedantic -Werror "$in_c" -o "$folder/embed" $flags -lm
LD_LIBRARY_PATH=$libdir "$folder/embed"

if [ -n "$with_exr" ]; then
  [ "$("$PKG_CONFIG" --modversion stein_exr)" = "$version" ]
  # shellcheck disable=SC2046
  "$CXX" -std=c++20 "$with_exr" -o "$folder/with_exr" $("$PKG_CONFIG" --cflags --libs stein_exr)
  LD_LIBRARY_PATH=$libdir "$folder/with_exr" "$folder/round_trip.exr"
fi
