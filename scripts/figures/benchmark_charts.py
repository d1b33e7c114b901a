"""Draws error against time of points, edits and texels, for scripts/figures/benchmarks.py.

A dot is a method: mean processor seconds, and the geometric mean over scenes of the error of
indirect light (root mean square, relative to its mean, of texels to the light there).
Texels are those of the scenes in which every method was measured.
"""
import json
import math
import statistics
import sys

from error_time import chart, geometric_mean


def points_chart(rows):
    """Of each integrator its rays a point, joined."""
    points = {f"{row['method']} {run['rays']}": (run["cpu_seconds"], run["error"], row["method"])
              for row in rows for run in row["runs"]}
    return chart(points, "processor seconds of 512 points, with loading",
                 joined=("path", "gather", "network"), below=("path",))


def edits_chart(rows):
    points = {row["method"].replace("-", " "): (row["cpu_seconds"], row["error"],
                                                row["method"].partition("-")[0]) for row in rows}
    title = f"processor seconds from edit to picture, {len(rows[0]['edits'])} edits"
    return chart(points, title, joined=("denoised", "gather", "network"), below=("gather",))


def texel_kind(method):
    for word, kind in (("bake", "gather"), ("network", "network"), ("Cycles", "Cycles"),
                       ("smoothed", "smoothed"), ("OIDN", "denoised")):
        if word in method:
            return kind
    return "path"


def texels_chart(rows):
    measured = {row["method"]: {scene["scene"]: scene for scene in row["scenes"]["bake"]}
                for row in rows if row["scenes"].get("bake")}
    shared = set.intersection(*map(set, measured.values())) if measured else set()
    points = {}
    for method, scenes in measured.items():
        figures = [scenes[name] for name in sorted(shared)]
        # As in the table: two halves of a reference leave errors a little below 0.
        error = geometric_mean([math.sqrt(max(f["rel_mse"], 1e-4)) for f in figures])
        points[method] = (statistics.fmean(f["processor_seconds"] for f in figures), error,
                          texel_kind(method))
    return chart(points, f"processor seconds of 256,000 texels, {len(shared)} scenes",
                 joined=("path", "smoothed", "denoised", "gather"), below=("gather", "denoised"))


CHARTS = (("points", "points_time.svg", points_chart), ("edits", "edits_time.svg", edits_chart),
          ("bake", "texels_time.svg", texels_chart))


def charts(docs):
    """The charts that `docs`/benchmarks has figures for: by path their text."""
    out = {}
    for table, name, draw in CHARTS:
        file = docs / "benchmarks" / f"{table}.json"
        if not file.exists():
            continue
        try:
            out[docs / "images" / name] = draw(json.loads(file.read_text())["rows"])
        except KeyError as missing:
            sys.exit(f"benchmark_charts.py: {file}: has no {missing}")
        except ValueError as error:
            sys.exit(f"benchmark_charts.py: {file}: no figures to draw: {error}")
    return out
