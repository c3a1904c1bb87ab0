#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Debian packages of packages.txt that are missing; does nothing, and needs no rights, where none is.
# Usage: scripts/install-packages.sh [--dev|--neon]     also those of the section developer, or neon
set -euo pipefail
cd "$(dirname "$0")/.."

sections="build"
case "${1:-}" in
  "") ;;
  --dev) sections="build developer" ;;
  --neon) sections="build neon" ;;
  *) echo "usage: $0 [--dev|--neon]" >&2; exit 2 ;;
esac

packages_of() {  # the packages of one section
  awk -v wanted="[$1]" '$1 == "#" && $2 ~ /^\[/ { on = ($2 == wanted); next } { sub(/#.*/, "") } on && NF { print $1 }' packages.txt
}

wanted=()
for section in $sections; do
  while read -r package; do wanted+=("$package"); done < <(packages_of "$section")
done

if ! command -v dpkg-query > /dev/null; then
  echo "This is not a Debian system. Install the equivalents of: ${wanted[*]}" >&2
  exit 0
fi

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2> /dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "All packages are installed."
  exit 0
fi

as_root=(env DEBIAN_FRONTEND=noninteractive)
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo > /dev/null; then
    echo "These packages are missing, and there is no sudo to install them: ${missing[*]}" >&2
    echo "Run as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo env DEBIAN_FRONTEND=noninteractive)
fi
echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq < /dev/null
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" < /dev/null
