#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Builds and runs a C program with the C compiler and what pkg-config says of an installed stein, moved elsewhere first.
# Usage: pkg_config.sh PREFIX LIBDIR MAIN.C VERSION     in the environment: CC, PKG_CONFIG
set -euo pipefail
prefix=$1 libdir=$2 source=$3 version=$4

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -a "$prefix" "$folder/moved"
libdir=$folder/moved/${libdir#"$prefix"/}
export PKG_CONFIG_PATH=$libdir/pkgconfig

[ "$("$PKG_CONFIG" --modversion stein)" = "$version" ]
flags=$("$PKG_CONFIG" --cflags --libs stein)
[[ $flags == *"$folder/moved"* ]] || { echo "not relocatable: $flags"; exit 1; }
# shellcheck disable=SC2086  # one word each
"$CC" -std=c99 -Wall -Wextra -Wpedantic -Werror "$source" -o "$folder/embed" $flags -lm
LD_LIBRARY_PATH=$libdir "$folder/embed"
