#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Folders that cannot be written to: told before the work is done, and nothing is changed.
. "$(dirname "$0")/common.sh"

as_other=()
if [ "$(id -u)" -eq 0 ]; then  # whom no permissions hold
  as_other=(setpriv --reuid=65534 --regid=65534 --clear-groups)
  "${as_other[@]}" true 2> /dev/null || skip "no other user can be made of root here"
  "${as_other[@]}" test -x "$stein" || skip "the program lies where another user cannot read it"
fi
render "$folder/noisy.exr" 1
mkdir "$folder/closed"
for name in clean.exr picture.png report.json; do echo old > "$folder/closed/$name"; done
chmod 555 "$folder/closed"
chmod 444 "$folder/noisy.exr" "$folder/closed"/*
mkdir "$folder/open"
chmod 777 "$folder/open"
before=$(names_in "$folder/closed")

expect 4 "not writable" "${as_other[@]}" "$stein" denoise "$folder/noisy.exr" -o "$folder/closed/clean.exr"
expect 4 "not writable" "${as_other[@]}" "$stein" denoise "$folder/noisy.exr" -o "$folder/open/clean.exr" --json "$folder/closed/report.json"
expect 4 "not writable" "${as_other[@]}" "$stein" preview "$folder/noisy.exr" -o "$folder/closed/picture.png"
[ "$(names_in "$folder/closed")" = "$before" ] || fail "there is something new: $(names_in "$folder/closed")"
[ -z "$(names_in "$folder/open")" ] || fail "the image was made though its report cannot be: $(names_in "$folder/open")"
for name in clean.exr picture.png report.json; do [ "$(cat "$folder/closed/$name")" = old ] || fail "$name has changed"; done
# Where the folder can be written to, the permissions of the file itself do not matter, as for any rename.
expect 0 "" "${as_other[@]}" "$stein" denoise "$folder/noisy.exr" -o "$folder/open/clean.exr" --quiet
