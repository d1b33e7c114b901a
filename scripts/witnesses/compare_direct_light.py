#!/usr/bin/env python3
"""Error and processor time of direct light by the number of shadow rays: even and shared out, as
sampled, denoised by lte's filter, and by Open Image Denoise where it is found.

usage: scripts/witnesses/compare_direct_light.py SCENE... [--size 320x240] [--reference 4096]
           [--build build] [--before DIR] [--repeat 3] [--samples 1,2,4,16,64]

Prints a Markdown table for each scene. The error is the relative MSE (docs/metrics.md) of direct
irradiance over the reference's mean, over the pixels that see a surface, without anti-aliasing. The
time is user and system seconds of lte_render less those of the same picture of albedo: the least of
--repeat runs. It holds the start of the denoiser. --before is the build of an older lte to compare
with. Needs nothing but Python's standard library.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

from exr import read_exr


def run(build, scene, size, *more, off=False):
    """Layers of the picture, and its processor seconds."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.exr"
        command = [
            f"{build}/bin/lte_render", scene, "--size", size, "--aa", "off", "--quiet", "--metal",
            "diffuse", "--out",
            str(out), *more
        ]
        environment = dict(os.environ, **({"LTE_OIDN": "off"} if off else {}))
        before = os.times()
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
        after = os.times()
        if done.returncode != 0:
            sys.exit(done.stderr.strip())
        seconds = (after.children_user - before.children_user + after.children_system -
                   before.children_system)
        return read_exr(out)[2], seconds


def relative_mse(found, wanted, unit):
    total = count = 0
    for a, b in zip(found, wanted):
        if max(b) <= 0 and max(a) <= 0:
            continue
        for x, y in zip(a, b):
            x, y = x / unit, y / unit
            total += (x - y) ** 2 / (y * y + 0.01)
            count += 1
    return total / max(1, count)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--reference", type=int, default=4096, help="shadow rays of the reference")
    parser.add_argument("--build", default="build")
    parser.add_argument("--before", help="an older build")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--samples", default="1,2,4,16,64")
    arguments = parser.parse_args()
    even, clean = ("--denoise", "off"), ("--denoise", "on")
    ways = [("even", arguments.build, even, False),
            ("shared out", arguments.build, (*even, "--adaptive-direct"), False),
            ("even, lte's filter", arguments.build, clean, True),
            ("even, OIDN", arguments.build, clean, False),
            ("shared out, OIDN", arguments.build, (*clean, "--adaptive-direct"), False)]
    if arguments.before:
        ways.insert(0, ("before", arguments.before, (), False))
    for scene in arguments.scenes:
        layers, _ = run(arguments.build, scene, arguments.size, "--output", "direct",
                        "--direct-samples", str(arguments.reference), "--seed", "7", *even)
        wanted = layers["direct"]
        base = min(
            run(arguments.build, scene, arguments.size, "--output", "albedo")[1]
            for _ in range(arguments.repeat + 1))
        lit = [value for value in wanted if max(value) > 0]
        unit = sum(map(sum, lit)) / (3 * len(lit))
        print(f"\n| {pathlib.Path(scene).name}: relative MSE (seconds) | " +
              " | ".join(name for name, *_ in ways) + " |")
        print("|---" * (1 + len(ways)) + "|")
        for samples in arguments.samples.split(","):
            cells = []
            for _, build, flags, own in ways:
                if "--adaptive-direct" in flags and int(samples) < 3:
                    cells.append("")
                    continue
                best = float("inf")
                for _ in range(arguments.repeat):
                    layers, seconds = run(build, scene, arguments.size, "--output", "direct",
                                          "--direct-samples", samples, *flags, off=own)
                    best = min(best, seconds)
                error = relative_mse(layers["direct"], wanted, unit)
                cells.append(f"{error:.2g} ({max(0.0, best - base):.2f})")
            print(f"| {samples} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
