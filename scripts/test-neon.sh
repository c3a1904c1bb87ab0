#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# The tests of the kernels as NEON code: cross-compiled for aarch64 and run by qemu-user. Not part of CI: it takes an hour or
# more on two cores, 114 test cases of which some take minutes (on the machine itself: seconds).
# The libraries of arm64 are unpacked into build/neon/sysroot; of the system nothing is changed but that the packages
# [neon] of packages.txt are installed.
# Usage: scripts/test-neon.sh [ctest options]
set -euo pipefail
cd "$(dirname "$0")/.."

build=$PWD/build/neon
sysroot=$build/sysroot

scripts/install-packages.sh --neon

# apt for another architecture, with lists and a cache of its own
apt_arm64() {
  apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State="$build/apt" \
    -o Dir::State::status=/dev/null -o Dir::Cache="$build/apt" -o APT::Sandbox::User="" "$@"
}

unpack_libraries() {
  mkdir -p "$build/apt/lists/partial" "$build/apt/archives/partial" "$build/packages" "$sysroot"
  apt_arm64 update
  cd "$build/packages"
  apt_arm64 download libtbb-dev libtbb12 libtbbmalloc2 libtbbbind-2-5 libhwloc15 libudev1 libhwy-dev libhwy1 catch2
  for package in *.deb; do dpkg-deb -x "$package" "$sysroot"; done
  cd - > /dev/null
}

[ -d "$sysroot/usr/include/hwy" ] || unpack_libraries

cmake -G Ninja -S . -B "$build" -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/aarch64-linux-gnu.cmake" -DSTEIN_SYSROOT="$sysroot" \
  -DCMAKE_BUILD_TYPE=Release -DSTEIN_WERROR=ON -DSTEIN_EXR=OFF -DSTEIN_CLI=OFF -DSTEIN_PATHTRACER=OFF -DSTEIN_EMBED=OFF \
  -DSTEIN_BENCH=OFF -DSTEIN_TEST_TIMEOUT=3600
cmake --build "$build" --target kernels_test filters_test select_test rpf_test
ctest --test-dir "$build" --output-on-failure --no-tests=error -j 2 -R '^(kernels|filters|select|rpf)_test' "$@"
