#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Denoises a sequence as a Slurm job array, a frame or a chunk of frames per task. See docs/farm.md.
#
#   sbatch --array=1-100%32 denoise_array.sh noisy.####.exr clean.####.exr [option of stein denoise]...
#   sbatch --array=1-1000:10 ...      # tasks of ten frames each
#
# STEIN: the program; STEIN_LAST_FRAME: the last frame, where the last chunk is not full; STEIN_RETRIES: how often a task
# goes back to the queue by itself (3).
#
#SBATCH --job-name=stein
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=stein-%A_%a.log
set -uo pipefail

if [ $# -lt 2 ] || [ -z "${SLURM_ARRAY_TASK_ID:-}" ]; then
  echo "usage: sbatch --array=FIRST-LAST[:CHUNK] $0 IN.####.exr OUT.####.exr [option of stein denoise]..." >&2
  exit 2
fi
input=$1
output=$2
shift 2

first=$SLURM_ARRAY_TASK_ID
last=$((first + ${SLURM_ARRAY_TASK_STEP:-1} - 1))
most=${STEIN_LAST_FRAME:-$last}
if [ "$last" -gt "$most" ]; then last=$most; fi

# What an earlier try has finished is left out, so a task that is requeued goes on where it was stopped.
"${STEIN:-stein}" denoise "$input" -o "$output" --frames "$first-$last" --skip-existing \
  --threads "${SLURM_CPUS_PER_TASK:-0}" "$@"
code=$?

# 75: a full disk and the like. Above 128: killed by a signal, as by the kernel when memory runs out.
if { [ "$code" -eq 75 ] || [ "$code" -gt 128 ]; } && [ "${SLURM_RESTART_COUNT:-0}" -lt "${STEIN_RETRIES:-3}" ]; then
  echo "exit code $code: back to the queue" >&2
  # Slurm ends this script while the command runs: nothing after it is reached.
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}" && sleep 600
fi
exit "$code"
