#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# The script for job arrays, called as Slurm would call it: chunks, what is skipped, exit codes, going back to the queue.
. "$(dirname "$0")/common.sh"

script=$(cd "$(dirname "$0")/../../examples/farm" && pwd)/denoise_array.sh
for frame in 1 2 3 4 5; do render "$folder/noisy.000$frame.exr" "$frame"; done
# In place of Slurm's own, to see what is asked of it. The script would wait for Slurm to end it.
mkdir "$folder/bin"
printf '#!/bin/sh\necho "$@" >> "%s"\nexit 1\n' "$folder/asked" > "$folder/bin/scontrol"
chmod +x "$folder/bin/scontrol"

task() {  # ID [VARIABLE=VALUE]...
  local id=$1
  shift
  env PATH="$folder/bin:$PATH" STEIN="${program:-$stein}" SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID="$id" SLURM_CPUS_PER_TASK=1 "$@" \
    "$script" "$folder/noisy.####.exr" "$folder/clean.####.exr" --json "$folder/clean.####.json"
}

expect 2 "usage" env -u SLURM_ARRAY_TASK_ID "$script" a b
expect 0 "" task 1
[ -s "$folder/clean.0001.exr" ] && [ -s "$folder/clean.0001.json" ] || fail "no output of frame 1"
expect 0 "skipped   1 of 1" task 1
expect 0 "frame 3" task 2 SLURM_ARRAY_TASK_STEP=2
expect 0 "" task 4 SLURM_ARRAY_TASK_STEP=4 STEIN_LAST_FRAME=5
for frame in 1 2 3 4 5; do [ -s "$folder/clean.000$frame.exr" ] || fail "no frame $frame"; done
# What cannot be helped is not tried again ...
expect 4 "noisy.0006.exr" task 6
[ ! -e "$folder/asked" ] || fail "asked for another try of what cannot be helped: $(cat "$folder/asked")"
# ... what may be is, a few times.
printf '#!/bin/sh\nexit 75\n' > "$folder/bin/full"
printf '#!/bin/sh\nkill -9 $$\n' > "$folder/bin/killed"
chmod +x "$folder/bin/full" "$folder/bin/killed"
program=$folder/bin/full expect 75 "back to the queue" task 6
program=$folder/bin/killed expect 137 "back to the queue" task 6 SLURM_RESTART_COUNT=2
[ "$(cat "$folder/asked")" = $'requeue 7_6\nrequeue 7_6' ] || fail "asked for: $(cat "$folder/asked")"
program=$folder/bin/full expect 75 "" task 6 SLURM_RESTART_COUNT=3
[ "$(wc -l < "$folder/asked")" -eq 2 ] || fail "a task that fails for ever goes back for ever"
