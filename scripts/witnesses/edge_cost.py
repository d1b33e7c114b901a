#!/usr/bin/env python3
"""Measures what anti-aliasing costs lte_render and what it gains: processor seconds and error
against the path tracer, which spreads its paths over the pixel, with --aa off and on in turns.

usage: scripts/witnesses/edge_cost.py [--scene F] [--sizes 320x240,640x480] [--repeats 3]
           [--aa 4,8,16] [--spp 256] [--build build] [--keep DIR]

--spp 0 measures time alone. Needs PyPI's numpy and OpenEXR.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np
import OpenEXR

ROOT = pathlib.Path(__file__).resolve().parents[2]


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def render(arguments, size, out, *more):
    before = processor_seconds()
    subprocess.run([
        f"{arguments.build}/bin/lte_render", arguments.scene, "--quiet", "--size", size, "--out",
        str(out), "--json",
        str(out.with_suffix(".json")), *more
    ], check=True)
    spent = processor_seconds() - before
    channels = OpenEXR.File(str(out)).channels()
    color = channels["RGB"].pixels if "RGB" in channels else np.stack(
        [channels[c].pixels for c in "RGB"], -1)
    told = json.loads(out.with_suffix(".json").read_text())
    return np.array(color), {**told, "processor": spent}


def relative_mse(found, truth):
    return ((found - truth) ** 2 / (truth ** 2 + 1e-2 * truth.mean() ** 2)).mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", default=str(ROOT / "assets/scenes/living_room.glb"))
    parser.add_argument("--sizes", default="320x240,640x480")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--aa", default="4,8,16")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--build", default="build")
    parser.add_argument("--keep", help="a folder to keep pictures in")
    arguments = parser.parse_args()
    modes = ["off"] + arguments.aa.split(",")
    print(f"{'size':10}{'--aa':>6}{'seconds':>9}{'cost':>8}{'edges':>8}{'asked':>9}{'relmse':>9}")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(arguments.keep or temporary)
        folder.mkdir(exist_ok=True)
        for size in arguments.sizes.split(","):
            truth = None
            if arguments.spp:
                truth, _ = render(arguments, size, folder / f"{size}.reference.exr", "--mode",
                                  "reference", "--spp", str(arguments.spp), "--seed", "7")
            seconds, last = {mode: [] for mode in modes}, {}
            for _ in range(arguments.repeats):
                for mode in modes:  # in turns: the machine's mood is shared
                    out = folder / f"{size}.{mode}.exr"
                    last[mode] = render(arguments, size, out, "--aa", mode)
                    seconds[mode].append(last[mode][1]["processor"])
            for mode in modes:
                color, told = last[mode]
                best, plain = min(seconds[mode]), min(seconds["off"])
                more = told["decoded_pixels"] - last["off"][1]["decoded_pixels"]
                error = f"{relative_mse(color, truth):9.4f}" if truth is not None else ""
                print(f"{size:10}{mode:>6}{best:9.2f}{100 * (best / plain - 1):7.1f}%"
                      f"{told['edge_pixels']:8}{more:9}{error}")


if __name__ == "__main__":
    sys.exit(main())
