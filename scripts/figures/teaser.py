#!/usr/bin/env python3
"""Makes the picture of README: a room by path tracing, by the network's light, and what they differ
by.

usage: scripts/figures/teaser.py OUT.png [--bin build/bin] [--size 400x300] [--spp 1024]

All share the exposure of the path-traced picture; the difference is four times that of the display
values. Needs PyPI's Pillow.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

from PIL import Image, ImageChops

ROOM = pathlib.Path(__file__).resolve().parents[2] / "assets/scenes/living_room.glb"
GAP = 4


def render(binary, folder, name, size, *flags):
    """The picture and its exposure."""
    out, report = folder / f"{name}.png", folder / f"{name}.json"
    subprocess.run([binary / "lte_render", ROOM, "--size", size, "--out", out, "--json", report,
                    "--quiet", *flags], check=True)
    return Image.open(out).convert("RGB"), json.loads(report.read_text())["exposure"]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    parser.add_argument("--size", default="400x300")
    parser.add_argument("--spp", type=int, default=1024)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        traced, exposure = render(arguments.bin, folder, "traced", arguments.size, "--integrator",
                                  "path", "--spp", str(arguments.spp), "--set", "denoise=off")
        network, _ = render(arguments.bin, folder, "network", arguments.size, "--integrator",
                            "network", "--set", f"exposure={exposure}")
    difference = ImageChops.difference(traced, network).point(lambda value: min(255, 4 * value))
    pictures = [traced, network, difference]
    width, height = traced.size
    sheet = Image.new("RGB", (len(pictures) * (width + GAP) - GAP, height), "white")
    for i, picture in enumerate(pictures):
        sheet.paste(picture, (i * (width + GAP), 0))
    sheet.save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
