#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Python package into a fresh virtual environment and runs its tests there. Needs the Python package index.
# Usage: scripts/test-python.sh [--build FOLDER]
#   --build: link the static libraries of this build folder, such as build/ci, instead of building them once more
# In the environment: PYTHON, the interpreter (python3)
set -euo pipefail
cd "$(dirname "$0")/.."

build=
case "${1:-}" in
  "") ;;
  --build) build=${2:?"--build needs a folder"} ;;
  *) echo "usage: $0 [--build FOLDER]" >&2; exit 2 ;;
esac

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m venv "$folder/venv" || { echo "No virtual environment; the Debian package is python3-venv." >&2; exit 1; }
needed=(scikit-build-core nanobind numpy pytest)
if ! "$folder/venv/bin/pip" install --quiet --disable-pip-version-check "${needed[@]}"; then
  echo "Not tested: could not get ${needed[*]} from the Python package index. Is there a network?" >&2
  exit 1
fi

options=()
if [ -n "$build" ]; then
  cmake --install "$build" --prefix "$folder/stein" > /dev/null
  options+=(--config-settings cmake.define.STEIN_PYTHON_INSTALLED=ON
    --config-settings "cmake.define.stein_ROOT=$folder/stein")
fi
"$folder/venv/bin/pip" install --disable-pip-version-check --no-build-isolation --no-deps "${options[@]}" .
"$folder/venv/bin/python" -m pytest -p no:cacheprovider -ra
