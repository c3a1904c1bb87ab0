#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Makes Debian packages with shared libraries, libstein<version>, libstein-dev and stein, in build/packages, unpacks them into
# a folder of its own, and sees that programs in C and C++ build against that and run, that the libraries export what the
# headers declare and nothing else, and, as root, that dpkg would install them. Nothing is installed. Five minutes on two cores.
# Usage: scripts/test-packages.sh [options of cmake]
set -euo pipefail
cd "$(dirname "$0")/.."
source_folder=$PWD
build=$PWD/build/packages

scripts/install-packages.sh
cmake -G Ninja -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_SHARED_LIBS=ON \
  -DSTEIN_TESTS=OFF -DSTEIN_BENCH=OFF -DSTEIN_EMBED=OFF -DSTEIN_PATHTRACER=OFF "$@"
cmake --build "$build"
rm -f "$build"/*.deb
(cd "$build" && cpack -G DEB)

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "$*" >&2; exit 1; }
version=$(sed -n 's/^project(stein VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
runtime=libstein${version%.*}
for package in "$runtime" libstein-dev stein; do
  file=$(echo "$build/${package}_${version}_"*.deb)
  [ -f "$file" ] || fail "there is no package $package: $(ls "$build"/*.deb)"
  dpkg-deb -x "$file" "$folder"
  printf '%s: %s\n' "$package" "$(dpkg-deb -f "$file" Depends)"
  case "$package" in
    "$runtime") needs=libtbb ;;
    *) needs="$runtime (= $version)" ;;
  esac
  [[ $(dpkg-deb -f "$file" Depends) == *"$needs"* ]] || fail "$package does not depend on $needs"
done
if [ "$(id -u)" -eq 0 ]; then
  dpkg --no-act -i "$build"/*.deb
fi

libdir=$(dirname "$(find "$folder/usr" -name libstein.so)")
export LD_LIBRARY_PATH=$libdir
[[ $("$folder/usr/bin/stein" --version) == *"$version"* ]] || fail "the program is not $version"
tests/install/exported_symbols.sh nm include/stein.h "$libdir"/libstein.so "$libdir"/libstein_exr.so
CC=cc CXX=c++ PKG_CONFIG=pkg-config tests/install/pkg_config.sh "$folder/usr" "$libdir" "$version" \
  examples/embed_c/main.c tests/install/consumer/exr_round_trip.cpp
ctest --build-and-test "$source_folder/tests/install/consumer" "$folder/consumer" --build-generator Ninja \
  --build-options "-DCMAKE_PREFIX_PATH=$folder/usr" -DCMAKE_BUILD_TYPE=Release -DWITH_EXR=ON "-DSTEIN_VERSION=$version" \
  --test-command ctest --output-on-failure --no-tests=error
echo "The packages are good: $build"
