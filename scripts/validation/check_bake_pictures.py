#!/usr/bin/env python3
"""Holds baked scenes in a browser against path tracing by the same camera.

usage: scripts/validation/check_bake_pictures.py BUILD [--scenes FILE ...] [--three FILE]
           [--size 320x240] [--spp 512] [--keep FOLDER] [--bake FLAGS]

It needs Chromium, PyPI's flip-evaluator, numpy, OpenEXR and pillow, and three.js as an ES module
(scripts/setup.sh --tests takes it from nicegui's wheel). --scenes defaults to the two of
assets/scenes that have cameras. For each it bakes the scene for three.js, renders it by
lte_render --integrator path, and prints the FLIP of the two and the ratio of mean luminances,
below white alone. The exit code is 1 where FLIP reaches 0.08 or brightness differs by 2 %.
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile
import time

import flip_evaluator
import numpy as np
import OpenEXR
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/bake"))
import three_picture  # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
SCENES = [ROOT / "assets/scenes" / name for name in ("living_room.glb", "cornell_box.glb")]


def to_srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear**(1 / 2.4) - 0.055)


def to_linear(coded):
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055)**2.4)


def rendered(options, scene, folder):
    out = folder / "reference.exr"
    subprocess.run([options.build / "bin/lte_render", scene, "--integrator", "path", "--spp",
                    str(options.spp), "--size", options.size, "--set", "denoise=off", "--quiet",
                    "--out", out], check=True)
    with OpenEXR.File(str(out)) as file:
        return file.channels()["RGB"].pixels.astype(np.float64)


def baked(options, scene, folder):
    start = time.monotonic()
    subprocess.run([options.build / "bin/lte_bake", scene, "--out", folder, "--format", "three",
                    "--three", options.three, "--quiet", *shlex.split(options.bake)], check=True)
    return time.monotonic() - start


def shown(options, exposure, folder):
    width, height = map(int, options.size.split("x"))
    (folder / "view.json").write_text(json.dumps({"width": width, "height": height,
                                                  "exposure": exposure}))
    out = str(folder / "seen.png")
    if three_picture.main(str(folder), str(folder / "view.json"), out) != 0:
        raise SystemExit("check_bake_pictures: there is no Chromium")
    return np.asarray(Image.open(out).convert("RGB")) / 255


def check(options, scene, folder):
    seconds = baked(options, scene, folder)
    linear = rendered(options, scene, folder)
    exposure = 0.8 / float(np.percentile(linear @ LUMINANCE, 95))
    expected, seen = to_srgb(linear * exposure), shown(options, exposure, folder)
    _, flip, _ = flip_evaluator.evaluate(expected.astype(np.float32), seen.astype(np.float32),
                                         "LDR", applyMagma=False)
    below_white = (expected < 1).all(-1)
    ours, theirs = ((to_linear(picture) @ LUMINANCE)[below_white].mean()
                    for picture in (seen, expected))
    print(f"{scene.stem}: baked in {seconds:.1f} s, FLIP {flip:.4f}, luminance {ours / theirs:.4f} "
          "of path tracing's", flush=True)
    return flip < 0.08 and abs(ours / theirs - 1) < 0.02


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--scenes", nargs="+", type=pathlib.Path, default=SCENES)
    parser.add_argument("--three", default=ROOT / ".venv/tests/three.js")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--bake", default="--include full", help="flags of lte_bake")
    options = parser.parse_args()
    good = True
    for scene in options.scenes:
        with tempfile.TemporaryDirectory() as temporary:
            folder = (options.keep or pathlib.Path(temporary)) / scene.stem
            good &= check(options, scene, folder.resolve())
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
