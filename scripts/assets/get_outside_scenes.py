#!/usr/bin/env python3
"""Brings interiors that others published into assets/scenes/outside/public, from repositories that
you have.

usage: scripts/assets/get_outside_scenes.py FOLDER [NAME...] [--out OUT] [--list]

FOLDER holds clones (bare ones too) or plain checkouts of the repositories, each named
owner+name, such as FOLDER/bevyengine+bevy; --list says which and at which commit. Nothing is
fetched. Written are NAME.glb in metres with its camera, NAME.camera.json, and SOURCES.md, which
names source and licence. The scenes belong to a test set (assets/scenes/outside/README.md); git
ignores them here. Python's standard library suffices.
"""
import argparse
import json
import math
import pathlib
import sys

from public import convert, gltf_edit
from public.repository import Missing, Repository
from public.sources import SOURCES

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONVERTERS = {"xml": convert.from_xml, "renderformer": convert.from_renderformer,
              "tungsten": convert.from_tungsten}


def scene_bytes(source, folder):
    repository, commit, _ = source.origin
    read = Repository(folder, repository, commit).read
    if source.kind == "glb":
        return gltf_edit.edited(read(source.path), source)
    return CONVERTERS[source.kind](source.name, source.path, read, source.scale).bytes()


def camera_json(data):
    """The first camera of a .glb of ours, as a camera file has it."""
    document, _ = gltf_edit.parts(data)
    node = next(node for node in document["nodes"] if node.get("camera") == 0)
    x, y, z, w = node["rotation"]
    view = (-2 * (x * z + w * y), -2 * (y * z - w * x), -(1 - 2 * (x * x + y * y)))
    target = [round(e + v, 6) for e, v in zip(node["translation"], view)]
    fov = math.degrees(document["cameras"][0]["perspective"]["yfov"])
    return json.dumps({"name": node["name"], "origin": node["translation"], "target": target,
                       "vfov": round(fov, 4)})


def sources_page(sources):
    lines = ["# Public interiors, brought here by scripts/assets/get_outside_scenes.py", "",
             "| scene | repository, commit | path | licence |", "|---|---|---|---|"]
    lines += [f"| {s.name} | {s.origin[0]}, {s.origin[1]} | {s.path} | {s.origin[2]} |"
              for s in sources]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", metavar="FOLDER", help="with the repositories")
    parser.add_argument("names", nargs="*", metavar="NAME", help="scenes (default: all)")
    parser.add_argument("--out", type=pathlib.Path,
                        default=ROOT / "assets" / "scenes" / "outside" / "public")
    parser.add_argument("--list", action="store_true", help="print the table of sources")
    arguments = parser.parse_args()
    if arguments.list:
        print(sources_page(SOURCES), end="")
        return
    if arguments.folder is None:
        parser.error("FOLDER is missing; --list says what it has to hold")
    if not pathlib.Path(arguments.folder).is_dir():
        sys.exit(f"get_outside_scenes.py: {arguments.folder}: no such folder")
    unknown = set(arguments.names) - {source.name for source in SOURCES}
    if unknown:
        sys.exit(f"get_outside_scenes.py: {min(unknown)}: no such scene; --list names them")
    chosen = [s for s in SOURCES if not arguments.names or s.name in arguments.names]
    written, missing = [], 0
    for source in chosen:
        try:
            data = scene_bytes(source, arguments.folder)
        except (Missing, convert.Unread) as error:
            print(f"get_outside_scenes.py: {source.name}: {error}", file=sys.stderr)
            missing += 1
            continue
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / f"{source.name}.glb").write_bytes(data)
        (arguments.out / f"{source.name}.camera.json").write_text(camera_json(data) + "\n")
        written.append(source)
        print(f"{arguments.out / source.name}.glb: {len(data)} bytes, {source.origin[2]}")
    if written:
        (arguments.out / "SOURCES.md").write_text(sources_page(written))
    if missing:
        sys.exit(1)


if __name__ == "__main__":
    main()
