#!/usr/bin/env python3
"""Writes assets/scenes/outside/fingerprints.json: name and checksum of the geometry of each scene
there, by which lte_train knows a scene that it must not be trained on (lte/data/held_out.h).

Scenes of assets/scenes/outside/public are not in the repository: where they are missing, what the
list says of them stays.

usage: scripts/assets/list_outside_scenes.py [--build build]
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

from public.sources import SOURCES

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "assets" / "scenes" / "outside"


def geometry(tool, scene):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "info.json"
        done = subprocess.run([tool, "info", scene, "--json", out], stdout=subprocess.DEVNULL,
                              check=False)
        if done.returncode != 0:
            sys.exit(f"list_outside_scenes.py: {scene}: lte_datagen info failed")
        return json.loads(out.read_text())["fingerprint"]["geometry"]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    tool = parser.parse_args().build / "bin" / "lte_datagen"
    if not tool.is_file():
        sys.exit(f"list_outside_scenes.py: {tool}: missing; build it, or name another --build")
    out = FOLDER / "fingerprints.json"
    listed = json.loads(out.read_text()) if out.is_file() else {}
    names = {source.name for source in SOURCES}
    prints = {name: text for name, text in listed.items() if name in names}
    prints |= {path.stem: geometry(tool, path) for path in FOLDER.rglob("*.glb")}
    lines = (f'"{name}": "{text}"' for name, text in sorted(prints.items()))
    out.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    print(f"{out}: {len(prints)} scenes")


if __name__ == "__main__":
    main()
