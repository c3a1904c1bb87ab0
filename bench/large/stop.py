#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long `stein denoise` takes to end after SIGTERM, at moments spread over a whole run.

    bench/large/stop.py --build build/release --folder /data/tmp
    bench/large/stop.py --build build/release --folder /data/tmp --moments 40 -- --quality fast

Makes a frame of 4 Mpixel with 20 channels, times one run, then starts a run for each moment and stops it there. Checks
that each exits with 5 and leaves no file, and prints the time from the signal to the end of the process. Options after --
go to `stein denoise`.
"""

import argparse
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import time

CANCELLED = 5


def stop_after(command, seconds):
    """Milliseconds from SIGTERM to the end; None where the run was over before."""
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    time.sleep(seconds)
    if process.poll() is not None:
        return None
    sent = time.monotonic()
    process.send_signal(signal.SIGTERM)
    code = process.wait()
    waited = 1000 * (time.monotonic() - sent)
    if code == 0:  # it came while the last file was put in its place
        return None
    if code != CANCELLED:
        sys.exit(f"stopped after {seconds:.2f} s, the exit code was {code}")
    return waited


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release", help="folder of the build")
    parser.add_argument("--folder", help="where the frame and the results lie")
    parser.add_argument("--moments", type=int, default=25)
    parser.add_argument("--size", type=int, nargs=2, default=[2896, 1448], metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("options", nargs="*")
    arguments = parser.parse_args()
    build = pathlib.Path(arguments.build)
    with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
        folder = pathlib.Path(name)
        frame = folder / "in.exr"
        subprocess.run([build / "bench/large/stein_large_frame", "make", frame, *map(str, arguments.size), "0", "0"], check=True)
        out = folder / "out.exr"
        command = [build / "examples/cli/stein", "denoise", frame, "-o", out, "--quiet", *arguments.options]
        begun = time.monotonic()
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        whole = time.monotonic() - begun
        out.unlink()
        waits = []
        for moment in range(arguments.moments):
            seconds = whole * (moment + 0.5) / arguments.moments
            wait = stop_after(command, seconds)
            if wait is None:
                out.unlink(missing_ok=True)
                continue
            if list(folder.iterdir()) != [frame]:
                sys.exit(f"stopped after {seconds:.2f} s, something was left: {list(folder.iterdir())}")
            print(f"stopped after {seconds:6.2f} of {whole:.2f} s: {wait:5.0f} ms", flush=True)
            waits.append(wait)
    print(f"median {statistics.median(waits):.0f} ms, longest {max(waits):.0f} ms")


if __name__ == "__main__":
    main()
