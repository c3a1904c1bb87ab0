#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# On a full disk, a small file system in memory, outputs stay as they were, and the exit code says that another try may succeed.
. "$(dirname "$0")/common.sh"

[ $# -gt 2 ] || enter_own_mounts

render "$folder/noisy.exr" 1 128x96
disk=$folder/disk
mount_disk "$disk"
for name in clean.exr picture.png report.json; do echo old > "$disk/$name"; done
before=$(names_in "$disk")

check_old() {
  [ "$(names_in "$disk")" = "$before" ] || fail "there is something new: $(names_in "$disk")"
  for name in clean.exr picture.png report.json; do [ "$(cat "$disk/$name")" = old ] || fail "$name is not what it was"; done
}

expect 75 "cannot write '$disk/clean.exr': No space left on device" "$stein" denoise "$folder/noisy.exr" -o "$disk/clean.exr"
check_old
expect 75 "$disk/counts.exr" "$stein" denoise "$folder/noisy.exr" -o "$disk/counts.exr" --keep-inputs
check_old
# A disk that is full to the last byte, for the small files.
head -c 1000000 /dev/zero > "$disk/filling" 2> /dev/null || true
before=$(names_in "$disk")
expect 75 "$disk/picture.png" "$stein" preview "$folder/noisy.exr" -o "$disk/picture.png"
check_old
expect 75 "$disk/report.json" "$stein" denoise "$folder/noisy.exr" -o "$folder/clean.exr" --json "$disk/report.json"
check_old
[ -s "$folder/clean.exr" ] || fail "the image should be there, only its report not"
# With room again, another try succeeds, and leaves out what is done.
rm "$disk/filling" "$disk/report.json"
expect 0 "" "$stein" denoise "$folder/noisy.exr" -o "$folder/clean.exr" --json "$disk/report.json" --skip-existing
grep -q '"version"' "$disk/report.json" || fail "no report"
