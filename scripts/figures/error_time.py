#!/usr/bin/env python3
"""Draws error against time of the methods of `lte_eval scenes`, and prints what each is worth.

  lte_eval scenes assets/scenes/outside --size 128x96 --json outside.json
  scripts/figures/error_time.py outside.json --only '.*lte|gather.*|paths.*' \\
      --out docs/images/error_time.svg

A dot is a method: median processor seconds of a picture, and the geometric mean over the scenes of
the error of indirect irradiance (root mean square, relative to its mean). Rows of the same paths
are joined. The table on standard output has the geometric mean of the equal-error samples a pixel
with 95 % intervals (bootstrap over the scenes).
"""
import argparse
import html
import json
import math
import pathlib
import random
import re
import statistics
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 330, 64, 190, 14, 44
COLORS = {"path": "#777777", "denoised": "#1f6fb4", "gather": "#2b9348", "network": "#d9541e",
          "smoothed": "#8a5fb4", "Cycles": "#a37b00"}
RESAMPLES = 2000
LETTER, LINE = 6.3, 13  # of a label


def fail(message):
    print(f"error_time.py: {message}", file=sys.stderr)
    raise SystemExit(1)


def geometric_mean(values):
    return math.exp(statistics.fmean(map(math.log, values)))


def interval(values):
    """Bounds of 95 % of the geometric means of resampled scenes."""
    draw = random.Random(1)
    means = sorted(geometric_mean(draw.choices(values, k=len(values))) for _ in range(RESAMPLES))
    return means[int(0.025 * RESAMPLES)], means[int(0.975 * RESAMPLES)]


def kind_of(name):
    if name.startswith("paths"):
        return "denoised" if name.endswith("denoised") else "path"
    return "gather" if name.startswith("gather") else "network"


def read(path):
    """By method: errors, worths and seconds over the scenes in which it was measured."""
    try:
        scenes = json.loads(path.read_text())["scenes"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        fail(f"{path}: no result of lte_eval scenes --json ({error})")
    methods = {}
    for scene in scenes:
        for name, figures in scene["methods"].items():
            if "not_measured" in figures:
                continue
            light = figures["irradiance"]
            # An error below the reference's noise counts as that noise.
            mse = max(light["mse"], light["mse_stderr"])
            row = methods.setdefault(name, {"error": [], "worth": [], "seconds": []})
            row["error"].append(math.sqrt(mse) / light["mean"])
            row["worth"].append(light["path_variance"] / mse)
            row["seconds"].append(figures["processor_seconds"])
    if not methods:
        fail(f"{path}: no method was measured in any scene")
    return methods


def table(methods):
    lines = ["| method | scenes | CPU s | error | equal-error samples a pixel |",
             "|---|---:|---:|---:|---:|"]
    for name, row in methods.items():
        low, high = interval(row["worth"])
        lines.append(f"| {name} | {len(row['worth'])} | {statistics.median(row['seconds']):.2f} "
                     f"| {100 * geometric_mean(row['error']):.1f} % "
                     f"| {geometric_mean(row['worth']):.0f} ({low:.0f}–{high:.0f}) |")
    return "\n".join(lines)


class Axis:
    """A logarithmic axis from the least to the largest value, with room at both ends."""

    def __init__(self, values, first, last):
        self.low, self.high = math.log(min(values) / 1.25), math.log(max(values) * 1.25)
        self.first, self.last = first, last

    def __call__(self, value):
        share = (math.log(value) - self.low) / (self.high - self.low)
        return self.first + share * (self.last - self.first)

    def ticks(self):
        """Three at least where the axis is not very short."""
        for digits in ((1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7)):
            values = [digit * 10.0**power for power in range(-4, 9) for digit in digits]
            shown = [value for value in values if self.low <= math.log(value) <= self.high]
            if len(shown) >= 3:
                break
        return shown


def text(x, y, words, anchor="start", color="#222222"):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}">'
            f"{html.escape(words)}</text>")


def chart(points, title, joined, below):
    """Dots on logarithmic axes, as SVG.

    @param points  by name: abscissa, ordinate (a share of 1), kind in COLORS
    @param title   of the axis of abscissas
    @param joined  kinds whose dots a line joins, from left to right
    @param below   kinds whose names stand below their dots, so that those of neighbours keep apart
    """
    across = Axis([x for x, _, _ in points.values()], LEFT, WIDTH - RIGHT)
    up = Axis([y for _, y, _ in points.values()], HEIGHT - BOTTOM, TOP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="#fff"/>']
    for value in across.ticks():
        x = across(value)
        out.append(f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(text(x, HEIGHT - BOTTOM + 16, f"{value:g}", "middle"))
    for value in up.ticks():
        y = up(value)
        out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
        out.append(text(LEFT - 6, y + 4, f"{100 * value:g} %", "end"))
    middle = (LEFT + WIDTH - RIGHT) / 2
    out.append(text(middle, HEIGHT - 8, title, "middle"))
    for kind in joined:
        line = sorted((x, y) for x, y, k in points.values() if k == kind)
        path = " L".join(f"{across(x):.1f} {up(y):.1f}" for x, y in line)
        if line:
            out.append(f'<path d="M{path}" fill="none" stroke="{COLORS[kind]}"/>')
    placed = []
    for name, (x, y, kind) in sorted(points.items(), key=lambda point: up(point[1][1])):
        color = COLORS[kind]
        out.append(f'<circle cx="{across(x):.1f}" cy="{up(y):.1f}" r="4" fill="{color}"/>')
        # Labels of neighbours on two sides, so that they stay legible.
        left, base = across(x) + 7, up(y) + (16 if kind in below else -5)
        right = left + LETTER * len(name)
        while any(left < r and l < right and abs(base - b) < LINE for l, r, b in placed):
            base += 1
        placed.append((left, right, base))
        out.append(text(left, base, name, color=color))
    return "\n".join([*out, "</svg>", ""])


def picture_chart(methods):
    points = {name.replace("-", " "): (statistics.median(row["seconds"]),
                                       geometric_mean(row["error"]), kind_of(name))
              for name, row in methods.items()}
    paths = ("path", "denoised")
    return chart(points, "processor seconds a picture", joined=paths, below=paths)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", type=pathlib.Path, help="what lte_eval scenes --json wrote")
    parser.add_argument("--only", help="methods to draw, a regular expression")
    parser.add_argument("--out", type=pathlib.Path, help="chart, .svg")
    arguments = parser.parse_args()
    methods = read(arguments.result)
    if arguments.only:
        methods = {k: v for k, v in methods.items() if re.fullmatch(arguments.only, k)}
    print(table(methods))
    if arguments.out:
        arguments.out.write_text(picture_chart(methods))


if __name__ == "__main__":
    main()
