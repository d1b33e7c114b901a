#!/usr/bin/env python3
"""How often light at points lies within the error that it says to expect.

usage: scripts/validation/check_expected_errors.py SCENE|FOLDER ... [--work DIR] [--bin DIR]
           [--points N] [--spp N] [--json FILE]

lte_datagen draws points where light reaches, and lte_probe traces their light (--spp paths each);
both are kept in the work folder. Asked are lte_probe by gathered rays, over traced light and over
the network's, and, where Python finds the package of the build, its embeddings.

A point is within k expected errors if the difference, root mean square over the channels, is at
most the root of the squares of k expected errors and k standard errors of the reference. Of errors
with a normal distribution 68 % are within one and 95 % within two.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "figures"))
import scene_points  # noqa: E402
from sample_file import read_floats  # noqa: E402


def run(*command):
    scene_points.check(command, subprocess.run(list(map(str, command)), capture_output=True,
                                               text=True, check=False))


def rms(values):
    return math.sqrt(statistics.fmean(value * value for value in values))


def draw_points(scene, table, args):
    sample = table.with_suffix(".safetensors")
    run(*scene_points.bake_command(args, scene, sample, 8))
    (places, _), (facing, _) = read_floats(sample, "query_position", "query_normal")
    scene_points.write_points(table, places, facing)


def embedded(scene, table, package):
    """Total light and expected error at the points of a table, as an embedding says it."""
    points = [[row[name] for name in scene_points.COLUMNS]
              for row in scene_points.read_table(table)]
    at, facing = [p[:3] for p in points], [p[3:] for p in points]
    found, error = package.Model.load().encode(package.load(scene)).irradiance(
        at, facing, direct=True, error=True)
    return [[*map(float, light), float(e)] for light, e in zip(found, error)]


def measure(scene, name, package, args):
    """By method: shares of the points within one and two expected errors."""
    table = args.work / f"{name}-{args.points}.csv"
    if not table.exists():
        draw_points(scene, table, args)
    reference = args.work / f"{name}-{args.points}-{args.spp}.csv"
    if not reference.exists():
        run(args.bin / "lte_probe", scene, "--points", table, "--out", reference, "--integrator",
            "path", "--spp", args.spp, "--seed", "7", "--quiet")
    answers = {}
    for integrator in ("gather", "network"):
        out = args.work / f"{name}-{integrator}.csv"
        run(args.bin / "lte_probe", scene, "--points", table, "--out", out, "--integrator",
            integrator, "--quiet")
        answers[integrator] = [[*(row[f"total_{c}"] for c in "rgb"), row["expected_error"]]
                               for row in scene_points.read_table(out)]
    if package:
        answers["embedding"] = embedded(scene, table, package)
    out = {}
    for method, light in answers.items():
        within = [0, 0]
        for found, truth in zip(light, scene_points.read_table(reference)):
            off = rms([found[k] - truth[f"total_{c}"] for k, c in enumerate("rgb")])
            bar = math.hypot(found[3], rms([truth[f"stderr_{c}"] for c in "rgb"]))
            for k in range(2):
                within[k] += off <= (k + 1) * bar
        out[method] = [count / len(light) for count in within]
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out/expected_errors")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/bin")
    parser.add_argument("--points", type=int, default=200)
    parser.add_argument("--spp", type=int, default=4096, help="paths a point of the reference")
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    sys.path.insert(0, str(args.bin.resolve().parent / "python"))
    try:
        import numpy  # noqa: F401, which the package asks for at its first points alone
        import lte as package
    except ImportError as error:
        package = None
        print(f"without embeddings: {error}", file=sys.stderr)
    args.work.mkdir(parents=True, exist_ok=True)
    scenes = {}
    for file in scene_points.scene_files(args.scenes):
        scenes[file.stem] = found = measure(file, file.stem, package, args)
        print(file.stem, *(f"{method} {100 * one:.0f} {100 * two:.0f}"
                           for method, (one, two) in found.items()), flush=True)
    if not scenes:
        sys.exit("check_expected_errors.py: there is no scene in " +
                 ", ".join(map(str, args.scenes)))
    overall = {method: [statistics.fmean(found[method][k] for found in scenes.values())
                        for k in range(2)] for method in next(iter(scenes.values()))}
    if args.json:
        args.json.write_text(json.dumps({"points": args.points, "spp": args.spp, "scenes": scenes,
                                         "within": overall}, indent=1) + "\n", encoding="utf-8")
    for method, (one, two) in overall.items():
        print(f"{method}: {100 * one:.0f} % within the expected error, {100 * two:.0f} % within "
              "twice that")


if __name__ == "__main__":
    main()
