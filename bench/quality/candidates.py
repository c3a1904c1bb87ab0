#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""OIDN as an external candidate, through the files that a user has: what the mixture makes of it.

    candidates.py renders FOLDER [FOLDER...]   each with s<samples>.exr in stein's names and ref.exr
    candidates.py study --scene NAME ...       error against samples on scenes of the example path tracer

Needs numpy, OpenEXR and pyoidn (pip). Prints the tables of docs/candidates.md; figures are relative MSE as printed by
`stein compare`.
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples"))
from oidn import open_device, run_oidn  # noqa: E402


def stein(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"stein {' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def relative_error(program, image, reference):
    return float(re.search(r"relative MSE\s+(\S+)", stein(program, "compare", image, reference)).group(1))


def measure(args, device, noisy, reference, folder):
    """relMSE of input, OIDN, stein, stein with OIDN; the estimated error of the last, and OIDN's weight in it."""
    oidn, clean, mixed, report = (folder / n for n in ("oidn.exr", "clean.exr", "mixed.exr", "report.json"))
    run_oidn(device, noisy, oidn)
    moved = []
    for draw in range(args.draws):
        perturbed = folder / "perturbed.exr"
        stein(args.stein, "perturb", noisy, "-o", perturbed, "--draw", draw, "--step", args.step, "--quiet")
        moved.append(folder / f"oidn{draw}.exr")
        run_oidn(device, perturbed, moved[-1])
    options = ["--quality", args.quality, "--quiet"]
    stein(args.stein, "denoise", noisy, "-o", clean, *options)
    stein(args.stein, "denoise", noisy, "-o", mixed, *options, "--candidate", oidn, "--candidate-perturbed",
          ",".join(map(str, moved)), "--candidate-step", args.step, "--json", report)
    told = json.loads(report.read_text())
    errors = [relative_error(args.stein, image, reference) for image in (noisy, oidn, clean, mixed)]
    return errors + [told["mean_estimated_relative_error"], told["filters"][-1]["weight"]]


def row(name, values):
    errors = " | ".join(f"{v:.5f}" for v in values[:5])
    return f"| {name} | {errors} | {values[3] / values[1]:.2f} | {100 * values[5]:.0f} % |"


HEAD = "| {} | input | OIDN | stein | stein + OIDN | its estimate | to OIDN | OIDN's weight |\n|---|---|---|---|---|---|---|---|"


def renders(args, device, folder):
    rows = []
    print(HEAD.format("render"), flush=True)
    for source in args.folders:
        samples = sorted(source.glob("s[0-9]*.exr"), key=lambda p: int(re.sub(r"\D", "", p.stem) or 0))
        for noisy in (p for p in samples if re.fullmatch(r"s\d+", p.stem)):
            rows.append(measure(args, device, noisy, source / "ref.exr", folder))
            print(row(f"{source.name} {noisy.stem[1:]}", rows[-1]), flush=True)
    means = [math.exp(sum(math.log(r[i]) for r in rows) / len(rows)) for i in range(4)]
    print("| geometric mean | " + " | ".join(f"{m:.5f}" for m in means) + f" | | {means[3] / means[1]:.2f} | |")


def reference_noise(path):
    """What the reference's own noise adds to every relMSE against it."""
    channels = OpenEXR.File(str(path), separate_channels=True).channels()
    of = lambda name: channels[name].pixels.astype(np.float64)
    return float(np.mean([of(f"variance.{c}") / (of(c) ** 2 + 0.01) for c in "RGB"]))


def study(args, device, folder):
    keep = args.keep or folder

    def trace(scene, samples, seed, path):
        if not path.exists():
            subprocess.run([args.pathtracer, "--scene", scene, "--size", args.size, "--samples", str(samples), "--seed",
                            str(seed), "-o", str(path), "--quiet"], check=True)

    curves = {}
    for scene in args.scene:
        reference = keep / f"{scene}_reference.exr"
        trace(scene, args.reference_samples, 1000, reference)
        noise = reference_noise(reference)
        print(HEAD.format(scene), flush=True)
        for samples in args.samples:
            noisy = keep / f"{scene}_{samples}.exr"
            trace(scene, samples, 1, noisy)
            values = measure(args, device, noisy, reference, folder)
            values[:4] = [value - noise for value in values[:4]]
            curves.setdefault(scene, []).append((samples, values[:4]))
            print(row(str(samples), values), flush=True)
    if args.figure:
        args.figure.write_text(figure(curves))


SERIES = (("input", "#999999"), ("OIDN", "#d95f02"), ("stein", "#1b9e77"), ("stein + OIDN", "#3a3aa0"))


def figure(curves):
    """relMSE against samples, both logarithmic, a panel for each scene, as SVG."""
    width, height, left, top = 360, 260, 60, 30
    values = [v for points in curves.values() for _, four in points for v in four]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    first, last = (math.log2(f(s for points in curves.values() for s, _ in points)) for f in (min, max))
    parts = []
    for panel, (scene, points) in enumerate(curves.items()):
        x0 = panel * (width + left + 20) + left
        at_x = lambda s: x0 + (math.log2(s) - first) / (last - first) * width
        at_y = lambda v: top + (high - math.log10(v)) / (high - low) * height
        parts.append(f'<text x="{x0 + width / 2}" y="18" text-anchor="middle">{scene}</text>')
        for power in range(low, high + 1):
            y = at_y(10.0**power)
            parts.append(f'<path d="M{x0} {y:.1f}h{width}" stroke="#ddd"/>')
            parts.append(f'<text x="{x0 - 6}" y="{y + 4:.1f}" text-anchor="end">1e{power}</text>')
        for samples, _ in points:
            parts.append(f'<text x="{at_x(samples):.1f}" y="{top + height + 18}" text-anchor="middle">{samples}</text>')
        for i, (name, colour) in enumerate(SERIES):
            line = " ".join(f"{at_x(s):.1f},{at_y(four[i]):.1f}" for s, four in points)
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
            y = top + height - 12 - 16 * (len(SERIES) - 1 - i)
            parts.append(f'<text x="{x0 + 8}" y="{y}" fill="{colour}">{name}</text>')
    size = f'width="{len(curves) * (width + left + 20)}" height="{top + height + 30}"'
    return (f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">'
            f'<rect width="100%" height="100%" fill="white"/>{"".join(parts)}</svg>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    build = Path(__file__).resolve().parents[2] / "build/release/examples"
    parser.add_argument("--stein", default=build / "cli/stein")
    parser.add_argument("--pathtracer", default=build / "pathtracer/pathtracer")
    parser.add_argument("--draws", type=int, default=1)
    parser.add_argument("--step", type=float, default=0.1)
    parser.add_argument("--quality", default="default")
    parser.add_argument("--threads", type=int, default=0, help="of OIDN")
    modes = parser.add_subparsers(dest="mode", required=True)
    of_renders = modes.add_parser("renders")
    of_renders.add_argument("folders", type=Path, nargs="+")
    of_study = modes.add_parser("study")
    of_study.add_argument("--scene", action="append", required=True)
    of_study.add_argument("--size", default="256x192")
    of_study.add_argument("--samples", type=int, nargs="+", default=[4, 16, 64, 256, 1024, 4096])
    of_study.add_argument("--reference-samples", type=int, default=8192)
    of_study.add_argument("--keep", type=Path, help="folder where renders stay, and are taken from")
    of_study.add_argument("--figure", type=Path, help="SVG file to write")
    args = parser.parse_args()
    args.stein, args.pathtracer = os.fspath(args.stein), os.fspath(args.pathtracer)
    device = open_device(args.threads)
    with tempfile.TemporaryDirectory() as folder:
        (renders if args.mode == "renders" else study)(args, device, Path(folder))


if __name__ == "__main__":
    main()
