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

# Runs the script again, with a third argument, where it may mount: in a mount name space of its own, so that what is mounted
# goes with it.
enter_own_mounts() {
  local as_root=(unshare --mount)
  [ "$(id -u)" -eq 0 ] || as_root=(unshare --user --map-root-user --mount)
  "${as_root[@]}" mount -t tmpfs -o size=64k tmpfs "$folder" 2> /dev/null || skip "no file system can be mounted here"
  "${as_root[@]}" "$0" "$stein" "$pathtracer" inside
  exit
}

# Mounts a small file system as a folder, until the script ends.
mount_disk() {  # FOLDER
  mkdir "$1"
  mount -t tmpfs -o size=64k tmpfs "$1"
  mounted=$1
  cleanup() { umount "$mounted"; rm -rf "$folder"; }
}

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
