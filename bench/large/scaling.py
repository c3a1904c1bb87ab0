#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time and memory of `stein denoise` over the size of a frame, under a memory limit.

Makes frames of 20 channels on the fly, denoises them, and prints seconds per megapixel and the peak of resident memory:

    bench/large/scaling.py --build build/release --folder /data/tmp
    bench/large/scaling.py --build build/release --folder /data/tmp --megapixels 1 16 -- --quality default

With --compare, each result is compared bit by bit with one that was made without a limit (which takes the memory it takes),
and the colour of a part of the frame that is denoised by itself with that of the result (--quality fast looks at no more).
Options after -- go to `stein denoise`; --quality fast unless given.
"""

import argparse
import filecmp
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

ASPECT = 2  # width to height
PART = 1024
MARGIN = 192  # beyond all that a pixel of --quality fast depends on


def size_of(megapixels):
    height = round((megapixels * 2**20 / ASPECT) ** 0.5)
    return ASPECT * height, height


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Bench:
    def __init__(self, arguments, folder):
        self.arguments = arguments
        self.folder = folder
        build = pathlib.Path(arguments.build)
        self.stein = build / "examples/cli/stein"
        self.frame = build / "bench/large/stein_large_frame"

    def path(self, name):
        return str(self.folder / name)

    def make(self, name, width, height, x=0, y=0):
        subprocess.run([self.frame, "make", self.path(name), *map(str, (width, height, x, y))], check=True)

    def denoise(self, name, out, limit):
        command = [self.stein, "denoise", self.path(name), "-o", self.path(out), "--quiet", "--json", self.path("report.json")]
        if limit:
            command += ["--max-memory", limit, "--scratch", str(self.folder)]
        subprocess.run(command + self.arguments.options, check=True, stderr=subprocess.DEVNULL)
        return json.loads((self.folder / "report.json").read_text())

    def row(self, megapixels):
        width, height = size_of(megapixels)
        self.make("in.exr", width, height)
        before = cpu_seconds()
        report = self.denoise("in.exr", "out.exr", self.arguments.max_memory)
        seconds = report["seconds"]
        pixels = width * height / 2**20
        cells = [f"{width}x{height}", f"{pixels:.2f}"]
        cells += [f"{seconds[part] / pixels:.2f}" for part in ("read", "compute", "write", "total")]
        cells += [f"{(cpu_seconds() - before) / pixels:.2f}"]
        cells += [f"{report[name] / 2**20:.0f}" for name in ("peak_memory_bytes", "scratch_bytes")]
        if self.arguments.compare:
            cells.append(self.compare(width, height))
        print("| " + " | ".join(cells) + " |", flush=True)

    def compare(self, width, height):
        if min(width, height) > PART:
            x, y = (width - PART) // 2, (height - PART) // 2
            self.make("part.exr", PART, PART, x, y)
            self.denoise("part.exr", "part_out.exr", None)
            subprocess.run([self.frame, "compare", self.path("out.exr"), self.path("part_out.exr"), str(x), str(y), str(MARGIN)],
                           check=True, stdout=subprocess.DEVNULL)  # fmt: skip
        if width * height > self.arguments.compare * 2**20:
            return "part"
        self.denoise("in.exr", "unlimited.exr", None)
        if not filecmp.cmp(self.path("out.exr"), self.path("unlimited.exr"), shallow=False):
            sys.exit("the results with and without a limit differ")
        return "all"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release", help="folder of the build")
    parser.add_argument("--folder", help="where frames, results and scratch files lie: up to 300 bytes per pixel")
    parser.add_argument("--max-memory", default="2G")
    parser.add_argument("--megapixels", type=float, nargs="+", default=[0.25, 1, 4, 16, 64, 128])
    parser.add_argument("--compare", type=float, default=0, metavar="MEGAPIXELS",
                        help="compare bits; as a whole up to this size, which has to fit in memory")  # fmt: skip
    parser.add_argument("options", nargs="*", default=["--quality", "fast"])
    arguments = parser.parse_args()
    titles = ["frame", "Mpixel", "read s/Mpixel", "compute", "write", "total", "CPU", "peak MiB", "scratch MiB"]
    titles += ["identical"] if arguments.compare else []
    print("| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|", flush=True)
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        bench = Bench(arguments, pathlib.Path(folder))
        for megapixels in arguments.megapixels:
            bench.row(megapixels)


if __name__ == "__main__":
    main()
