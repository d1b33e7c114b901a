#!/usr/bin/env python3
"""Error of lte_probe at random points of scenes, as path-traced samples a point of the same error.

usage: scripts/figures/point_errors.py FOLDER|SCENE ... [--work DIR] [--bin DIR] [--json FILE]

lte_datagen draws points where light reaches and traces their light (--rays paths each, kept in the
work folder); lte_probe answers there by gathered rays, over traced light and over the network's,
and by paths. Direct light is left out. The mean square of the difference is rid of the reference's
own variance.
"""
import argparse
import json
import math
import pathlib
import resource
import statistics
import subprocess
import sys

import scene_points
from sample_file import read_floats

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Integrators and rays a point, of path paths; the last of each are the program's own.
RUNS = (("gather", 16), ("gather", 64), ("gather", 256), ("network", 16), ("network", 64),
        ("network", 256), ("path", 64), ("path", 256), ("path", 1024))


def sum_of_groups(tensor):
    """Of [groups, N, 3]: N rows of three."""
    values, (groups, count, _) = tensor
    return [[math.fsum(values[(g * count + i) * 3 + c] for g in range(groups)) for c in range(3)]
            for i in range(count)]


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    scene_points.check(command, done)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(scene, name, args):
    """By integrator and rays: samples of the same error, relative error, ratio of means, processor
    seconds."""
    sample = args.work / f"{name}-{args.points}-{args.rays}.safetensors"
    if not sample.exists():
        processor_seconds(scene_points.bake_command(args, scene, sample, args.rays))
    indirect, (noise, _), (places, _), (facing, _) = read_floats(
        sample, "indirect", "variance", "query_position", "query_normal")
    truth = sum_of_groups(indirect)
    variance = statistics.fmean(noise)  # of the mean over all rays
    table, answers = args.work / f"{name}.csv", args.work / f"{name}-light.csv"
    scene_points.write_points(table, places, facing)
    mean = math.fsum(map(math.fsum, truth)) / (3 * len(truth))
    out = {}
    for integrator, rays in RUNS:
        seconds = processor_seconds([args.bin / "lte_probe", scene, "--points", table, "--out",
                                     answers, "--integrator", integrator, "--spp", str(rays),
                                     "--quiet"])
        found = [[row[f"total_{c}"] - row[f"direct_{c}"] for c in "rgb"]
                 for row in scene_points.read_table(answers)]
        square = statistics.fmean((a - b)**2 for f, t in zip(found, truth) for a, b in zip(f, t))
        # Where the error drowns in the reference's, no more is claimed than the reference can tell.
        error = max(square - variance, variance / 10)
        out[f"{integrator} {rays}"] = {
            "worth": args.rays * variance / error, "error": math.sqrt(error) / mean,
            "mean_ratio": math.fsum(map(math.fsum, found)) / (3 * len(truth) * mean),
            "processor_seconds": seconds}
    return out


def summary(integrator, rays, scenes):
    of = [scene[f"{integrator} {rays}"] for scene in scenes]
    return {"integrator": integrator, "rays": rays,
            "worth": statistics.geometric_mean(f["worth"] for f in of),
            "least": min(f["worth"] for f in of),
            "error": statistics.geometric_mean(f["error"] for f in of),
            "mean_within": sum(abs(f["mean_ratio"] - 1) <= 0.05 for f in of),
            "processor_seconds": statistics.median(f["processor_seconds"] for f in of)}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out/benchmarks/points")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/bin")
    parser.add_argument("--points", type=int, default=512)
    parser.add_argument("--rays", type=int, default=2048, help="paths a point of the reference")
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    scenes = []
    for file in scene_points.scene_files(args.scenes):
        scenes.append({"name": file.name, **measure(file, file.stem, args)})
        print(file.name, *(f"{name} {figures['worth']:.0f}"
                           for name, figures in scenes[-1].items() if name != "name"), flush=True)
    methods = [summary(integrator, rays, scenes) for integrator, rays in RUNS]
    result = {"points": args.points, "rays": args.rays, "scenes": scenes, "methods": methods}
    if args.json:
        args.json.write_text(json.dumps(result, indent=1) + "\n")
    for method in methods:
        print(f"{method['integrator']} {method['rays']}: {method['worth']:.0f} samples a point, "
              f"least {method['least']:.0f}, {method['processor_seconds']:.2f} processor seconds")


if __name__ == "__main__":
    main()
