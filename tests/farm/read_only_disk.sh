#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# A file system that is mounted read-only, which binds root as well: told before the work is done, and nothing is changed.
. "$(dirname "$0")/common.sh"

[ $# -gt 2 ] || enter_own_mounts

disk=$folder/disk
mount_disk "$disk"
render "$folder/noisy.exr" 1
render "$folder/large.exr" 1 320x240  # more than an eighth of the least limit
render "$disk/here.exr" 1 16x12
for name in clean.exr picture.png report.json; do echo old > "$disk/$name"; done
mkdir "$folder/open"
before=$(names_in "$disk")
mount -o remount,ro "$disk"
touch "$disk/new" 2> /dev/null && fail "the disk can be written to"

told="the folder '$disk' is not writable"
expect 4 "$told" "$stein" denoise "$folder/noisy.exr" -o "$disk/clean.exr"
expect 4 "$told" "$stein" denoise "$folder/noisy.exr" -o "$disk/new.exr"
expect 4 "$told" "$stein" denoise "$folder/noisy.exr" -o "$folder/open/clean.exr" --json "$disk/report.json"
expect 4 "$told" "$stein" preview "$folder/noisy.exr" -o "$disk/picture.png"
expect 4 "scratch folder '$disk' takes no file" "$stein" denoise "$folder/large.exr" -o "$folder/open/clean.exr" \
  --max-memory 128M --scratch "$disk"
[ "$(names_in "$disk")" = "$before" ] || fail "there is something new: $(names_in "$disk")"
[ -z "$(names_in "$folder/open")" ] || fail "something was made that cannot be whole: $(names_in "$folder/open")"
for name in clean.exr picture.png report.json; do [ "$(cat "$disk/$name")" = old ] || fail "$name has changed"; done
# What lies there can be read.
expect 0 "" "$stein" denoise "$disk/here.exr" -o "$folder/open/clean.exr" --quiet
# Once it can be written to, another try succeeds.
mount -o remount,rw "$disk"
expect 0 "" "$stein" denoise "$disk/here.exr" -o "$disk/clean.exr" --quiet
