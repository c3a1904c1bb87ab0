#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/reliability.svg from the table that `stein_quality FOLDER --table calibration` prints.

Usage: stein_quality FOLDER --table calibration | bench/quality/reliability.py > reliability.svg
"""

import math
import sys

LOW, HIGH = -5.0, 0.5  # decades
SIZE, LEFT, TOP = 360, 60, 16
COLOURS = ["#0072b2", "#56b4e9", "#d55e00", "#e69f00", "#009e73", "#7bc8a4", "#555555"]


def points(lines, least_share=0.1):
    """Of each render: (reported, true) means of the bins that hold at least this percentage of the pixels."""
    renders = {}
    for line in lines:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) != 6 or " to " not in cells[1]:
            continue
        share, reported, truth = (float(cell) for cell in cells[2:5])
        if share >= least_share and reported > 0 and truth > 0:
            renders.setdefault(cells[0], []).append((reported, truth))
    return renders


def place(reported, truth):
    scale = SIZE / (HIGH - LOW)
    clip = lambda value: min(max(math.log10(value), LOW), HIGH)
    return LEFT + (clip(reported) - LOW) * scale, TOP + SIZE - (clip(truth) - LOW) * scale


def line(points_, colour, extra=""):
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points_)
    return f'<polyline points="{text}" fill="none" stroke="{colour}" {extra}/>'


def text(x, y, words, anchor="middle", extra=""):
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" {extra}>{words}</text>'


def axes():
    parts = [f'<rect x="{LEFT}" y="{TOP}" width="{SIZE}" height="{SIZE}" fill="white" stroke="#888"/>']
    for decade in range(math.ceil(LOW), math.floor(HIGH) + 1):
        x, y = place(10.0**decade, 10.0**decade)
        parts.append(line([(x, TOP), (x, TOP + SIZE)], "#ddd"))
        parts.append(line([(LEFT, y), (LEFT + SIZE, y)], "#ddd"))
        parts.append(text(x, TOP + SIZE + 16, f"1e{decade}"))
        parts.append(text(LEFT - 6, y + 4, f"1e{decade}", "end"))
    low, high = 10.0**LOW, 10.0**HIGH
    parts.append(line([place(low, low), place(high, high)], "#444"))
    for factor in (0.5, 2.0):
        ends = [place(x, x * factor) for x in (max(low, low / factor), min(high, high / factor))]  # inside the frame
        parts.append(line(ends, "#444", 'stroke-dasharray="4 4"'))
    parts.append(text(LEFT + SIZE / 2, TOP + SIZE + 36, "reported relative error (mean of a bin)"))
    parts.append(text(14, TOP + SIZE / 2, "true relative error", extra=f'transform="rotate(-90 14 {TOP + SIZE / 2:.0f})"'))
    return parts


def main():
    width, height = LEFT + SIZE + 150, TOP + SIZE + 48
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    parts += axes()
    for i, (render, pairs) in enumerate(points(sys.stdin).items()):
        colour = COLOURS[i % len(COLOURS)]
        placed = [place(*pair) for pair in pairs]
        parts.append(line(placed, colour, 'stroke-width="1.5"'))
        for pair, (x, y) in zip(pairs, placed):
            inside = all(10.0**LOW <= value <= 10.0**HIGH for value in pair)  # else at the frame, and hollow
            fill = colour if inside else "white"
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{fill}" stroke="{colour}"/>')
        parts.append(text(LEFT + SIZE + 12, TOP + 16 + 18 * i, render, "start", f'fill="{colour}"'))
    print("\n".join(parts + ["</svg>"]))


if __name__ == "__main__":
    main()
