#!/usr/bin/env python3
"""Measures what lte_render shows in the place of metal against the path tracer: the error of
--metal diffuse, black and trace on scenes with little metal, much, and nothing else.

usage: scripts/witnesses/metal_pictures.py [--size 160x120] [--spp 512] [--build build]
           [--keep DIR]

The scenes are made of the bundled living room: its "metal" and "crockery" as polished metal, its
wooden furniture and lacquer besides, and all of its surfaces without a material, as untextured
exports have them, which glTF takes for metal. A fourth is the Cornell box of
scripts/assets/make_cornell_box.py --metal. Needs PyPI's numpy and OpenEXR.
"""
import argparse
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy as np
import OpenEXR

ROOT = pathlib.Path(__file__).resolve().parents[2]


def read_glb(path):
    raw = path.read_bytes()
    size = struct.unpack("<I", raw[12:16])[0]
    return json.loads(raw[20:20 + size]), raw[20 + size:]


def write_glb(path, document, rest):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + rest
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


def make_metal(document, names, roughness):
    for material in document["materials"]:
        if material.get("name") in names:
            surface = material["pbrMetallicRoughness"]
            surface["metallicFactor"], surface["roughnessFactor"] = 1, roughness


def make_bare(document):
    """Drops the material of every surface that does not emit."""
    materials = document["materials"]
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            material = primitive.get("material")
            if material is not None and not any(materials[material].get("emissiveFactor", [0])):
                del primitive["material"]


def make_scenes(folder):
    room = ROOT / "assets/scenes/living_room.glb"
    few, much = ("metal", "crockery"), ("metal", "crockery", "wood", "lacquer")
    for name, change in (("some metal", lambda d: make_metal(d, few, 0.3)),
                         ("much metal", lambda d: make_metal(d, much, 0.2)),
                         ("no materials", make_bare)):
        document, rest = read_glb(room)
        change(document)
        path = folder / f"{name.replace(' ', '_')}.glb"
        write_glb(path, document, rest)
        yield name, path
    box = folder / "cornell_metal.glb"
    subprocess.run([sys.executable,
                    str(ROOT / "scripts/assets/make_cornell_box.py"), "--metal", "--out",
                    str(box)], check=True, stdout=subprocess.DEVNULL)
    yield "Cornell box", box


def render(arguments, scene, out, *more):
    command = [
        f"{arguments.build}/bin/lte_render",
        str(scene), "--size", arguments.size, "--out",
        str(out), "--json",
        str(out.with_suffix(".json")), *more
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr.strip())
    pixels = OpenEXR.File(str(out)).channels()
    color = pixels["RGB"].pixels if "RGB" in pixels else np.stack(
        [pixels[c].pixels for c in "RGB"], -1)
    lines = [line for line in done.stderr.splitlines() if "is metal" in line]
    times = json.loads(out.with_suffix(".json").read_text())
    return color, times["seconds"]["total"], lines[0].rpartition(": ")[2] if lines else ""


def blocks(picture, edge=8):
    height, width = (side // edge * edge for side in picture.shape[:2])
    return picture[:height, :width].reshape(height // edge, edge, width // edge, edge,
                                            3).mean((1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--spp", default="512", help="of the reference")
    parser.add_argument("--build", default="build")
    parser.add_argument("--keep", help="a folder to keep scenes and pictures in")
    arguments = parser.parse_args()
    print(f"{'scene':14}{'--metal':>9}{'ratio':>8}{'relmse':>9}{'8x8':>8}{'seconds':>9}")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(arguments.keep or temporary)
        folder.mkdir(exist_ok=True)
        for name, scene in make_scenes(folder):
            stem = folder / scene.stem
            truth, seconds, _ = render(arguments, scene, stem.with_suffix(".reference.exr"),
                                       "--mode", "reference", "--spp", arguments.spp, "--seed", "7")
            print(f"{name:14}{'paths':>9}{'':25}{seconds:9.2f}")
            for metal in ("diffuse", "black", "trace"):
                found, seconds, line = render(arguments, scene,
                                              stem.with_suffix(f".{metal}.exr"), "--metal", metal)
                error = ((found - truth) ** 2 / (truth ** 2 + 1e-2 * truth.mean() ** 2)).mean()
                coarse, target = blocks(found), blocks(truth)
                block = np.sqrt(((coarse - target) ** 2).mean() / (target ** 2).mean())
                print(f"{'':14}{metal:>9}{found.mean() / truth.mean():8.3f}{error:9.3f}{block:8.3f}"
                      f"{seconds:9.2f}  {line}")


if __name__ == "__main__":
    main()
