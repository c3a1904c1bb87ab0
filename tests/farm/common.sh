# SPDX-License-Identifier: Apache-2.0
#
# For the scripts beside it, which are called with the programs: SCRIPT STEIN PATHTRACER.
set -euo pipefail

stein=$1
pathtracer=$2
folder=$(mktemp -d)
chmod 755 "$folder"
cleanup() { rm -rf "$folder"; }
trap cleanup EXIT

fail() { echo "FAILED: $*" >&2; exit 1; }
skip() { echo "skipped: $*"; exit 77; }

render() {  # FILE SEED [SIZE]
  "$pathtracer" --scene cornell --size "${3:-64x48}" --samples 4 --seed "$2" --quiet -o "$1"
}

# Runs a command and requires its exit code, and a text in what it says.
expect() {  # CODE TEXT COMMAND...
  local code=$1 text=$2 found=0
  shift 2
  "$@" > "$folder/said" 2>&1 || found=$?
  [ "$found" -eq "$code" ] || fail "exit code $found, not $code, of: $* ($(cat "$folder/said"))"
  [ -z "$text" ] || grep -qF -- "$text" "$folder/said" || fail "'$text' is not said by: $* ($(cat "$folder/said"))"
}

names_in() { ls -A "$1" | sort | tr '\n' ' '; }
