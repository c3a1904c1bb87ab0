#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Sees that shared libraries export what headers declare, under a version, and nothing else.
# Usage: exported_symbols.sh NM STEIN.H LIBRARY...     the first library has all of stein.h
set -euo pipefail
nm=$1 header=$2
shift 2

fail() { echo "$*"; exit 1; }
mapfile -t declared < <(grep -o '^STEIN_API .*' "$header" | grep -o 'stein_[a-z_]*(' | tr -d '(' | sort)
[ "${#declared[@]}" -gt 20 ] || fail "found only ${#declared[@]} functions in $header"

# "name@@version" of what is defined; the versions' own names are absolute symbols.
mapfile -t exported < <("$nm" --dynamic --defined-only --with-symbol-versions "$1" | awk '$2 != "A" { print $3 }')
mapfile -t in_c < <(printf '%s\n' "${exported[@]}" | grep '^stein_' | sort)
[ "$(printf '%s\n' "${declared[@]/%/@@STEIN_C_0.1}")" = "$(printf '%s\n' "${in_c[@]}")" ] ||
  fail "$1 has not the functions of stein.h: ${in_c[*]}"

for library in "$@"; do
  symbols=$("$nm" --dynamic --defined-only --with-symbol-versions "$library" | awk '$2 != "A" { print $3 }')
  [ -n "$symbols" ] || fail "$library exports nothing"
  others=$(grep -vE '^(stein_[a-z_]+@@STEIN_C_|_ZNK?5stein.*@@STEIN_CXX_|_ZT[ISV]N5stein.*@@STEIN_CXX_)[0-9.]+$' <<<"$symbols" || true)
  [ -z "$others" ] || fail "$library also exports: $others"
  # Parts of the library that no public header knows.
  internal=$(grep -E '5stein[NK]*(4exec|7kernels|6Source|6Stages|1c)' <<<"$symbols" || true)
  [ -z "$internal" ] || fail "$library exports its internals: $internal"
done
