#!/usr/bin/env python3
"""Makes rooms of Infinigen Indoors (the generator of the paper's own training data) as test scenes:
generates a home with one furnished room, keeps its .blend, and exports the room as a .glb.

usage: out/infinigen-venv/bin/python scripts/assets/infinigen/make_rooms.py [KIND ...] [flags]

KIND is one of bathroom, bedroom, dining_room, kitchen, living_room and living_room_day, which is
the same room by daylight; all of them by default.
  --out DIR           where infinigen_KIND.glb goes (default assets/scenes/outside)
  --work DIR          where the .blend files and logs are kept (default out/infinigen)
  --generate-only     stops before the export
  --export-only       never generates; a room without .blend is an error
  --triangles N       budget of a room (default 200000)

scripts/assets/infinigen/setup.sh makes the environment. A room takes minutes of one core to
generate. The same seeds and versions give the same home.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

import rooms_table

ROOT = pathlib.Path(__file__).resolve().parents[3]
# Kind: Infinigen's name for the room, seed of the home.
ROOMS = {
    "bathroom": ("Bathroom", 1),
    "bedroom": ("Bedroom", 2),
    "dining_room": ("DiningRoom", 0),
    "kitchen": ("Kitchen", 3),
    "living_room": ("LivingRoom", 4),
}
DAY = "_day"  # after a kind: its room by daylight
KINDS = [*ROOMS, "living_room" + DAY]
# Fewer steps than fast_solve.gin has: these are a test set, not a product.
OVERRIDES = [
    "compose_indoors.terrain_enabled=False",
    "compose_indoors.nature_backdrop_enabled=False",
    "compose_indoors.lights_off_enabled=False",
    "compose_indoors.pose_cameras_enabled=False",
    "compose_indoors.solve_steps_large=40",
    "compose_indoors.solve_steps_medium=15",
    "compose_indoors.solve_steps_small=2",
]


def site_packages():
    """The folder that holds Infinigen: the only one from which gin resolves its includes."""
    for folder in map(pathlib.Path, sys.path):
        if (folder / "infinigen_examples" / "generate_indoors.py").is_file():
            return folder
    sys.exit("make_rooms: no Infinigen here: run scripts/assets/infinigen/setup.sh and use "
             "out/infinigen-venv/bin/python")


def run(command, log, folder):
    """Runs a command on one thread, its output in `log`; says and returns whether it succeeded."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
                   "MKL_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
    with log.open("w") as output:
        done = subprocess.run(command, cwd=folder, env=environment, stdout=output,
                              stderr=subprocess.STDOUT, check=False)
    if done.returncode:
        print(f"make_rooms: {pathlib.Path(command[1]).name} failed with {done.returncode}: see "
              f"{log}", file=sys.stderr, flush=True)
    return done.returncode == 0


def generate(kind, folder):
    room, seed = ROOMS[kind]
    script = pathlib.Path(__file__).resolve().with_name("generate_home.py")
    command = [sys.executable, str(script), "--seed", str(seed), "--task", "coarse",
               "--output_folder", str(folder), "-g", "fast_solve.gin", "singleroom.gin", "-p",
               *OVERRIDES, f'restrict_solving.restrict_parent_rooms=["{room}"]']
    return run(command, folder.with_suffix(".log"), site_packages())


def export(kind, blend, out, work, triangles):
    room, seed = ROOMS[kind.removesuffix(DAY)]
    script = pathlib.Path(__file__).resolve().with_name("export_room.py")
    out.mkdir(parents=True, exist_ok=True)
    return run([sys.executable, str(script), str(blend), str(out / f"infinigen_{kind}.glb"),
                "--room", room, "--seed", str(seed), "--triangles", str(triangles),
                *(["--daylight"] if kind.endswith(DAY) else [])],
               work / f"{kind}_export.log", ROOT)


def make(kind, out, work, args):
    """Whether the room of a kind was generated, where that was missing, and exported."""
    home = kind.removesuffix(DAY)
    start, blend = time.time(), work / home / "scene.blend"
    if not blend.is_file():
        if args.export_only:
            print(f"make_rooms: {blend} is missing", file=sys.stderr)
            return False
        if not generate(home, work / home):
            return False
        print(f"{home}: generated in {time.time() - start:.0f} s", flush=True)
    if args.generate_only:
        return True
    start = time.time()
    if not export(kind, blend, out, work, args.triangles):
        return False
    print(f"{kind}: exported in {time.time() - start:.0f} s", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description="rooms of Infinigen as .glb")
    parser.add_argument("kinds", nargs="*", metavar="KIND")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "assets/scenes/outside")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out/infinigen")
    parser.add_argument("--generate-only", action="store_true")
    parser.add_argument("--export-only", action="store_true")
    parser.add_argument("--triangles", type=int, default=200000)
    args = parser.parse_args()
    for kind in args.kinds:
        if kind not in KINDS:
            parser.error(f"no kind {kind!r}; there are {', '.join(KINDS)}")
    out, work = args.out.resolve(), args.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    failed = [k for k in args.kinds or KINDS if not make(k, out, work, args)]
    rooms_table.write(out)
    if failed:
        sys.exit(f"make_rooms: not made: {', '.join(failed)}")


if __name__ == "__main__":
    main()
