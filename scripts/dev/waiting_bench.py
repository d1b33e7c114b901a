#!/usr/bin/env python3
"""Times of short work by how threads wait: as the tools have it (asleep), as OpenMP has it by
default (spinning), and as OMP_WAIT_POLICY=passive has it; alone, and beside processes that are
busy.

  build/bin/lte_datagen generate --config configs/data/demo.yaml --scenes 8 --out out/waiting
  scripts/dev/waiting_bench.py --data out/waiting --rounds 5

A round runs everything once in every way, in turn, so that what else the machine does falls on all
alike. Medians are printed, with the least and the most.
"""
import argparse
import ctypes
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
WAYS = {"asleep, as the tools do": {},
        "spinning, OpenMP's default": {"GOMP_SPINCOUNT": "300000"},
        "OMP_WAIT_POLICY=passive": {"OMP_WAIT_POLICY": "passive"}}
POINTS = 2048


def run(command: list[str], more: dict) -> None:
    environment = {key: value for key, value in os.environ.items()
                   if key not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
    subprocess.run(command, cwd=ROOT, env=environment | more, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def encode_picture(way: dict, folder: pathlib.Path, _) -> float:
    run([BUILD / "bin/lte_render", "assets/scenes/living_room.glb", "--size", "160x120", "--out",
         folder / "a.png", "--json",
         folder / "a.json", "--output", "gi", "--indirect", "decoded"], way)
    times = json.loads((folder / "a.json").read_text())
    return times.get("seconds", times)["encode"]


def training(way: dict, folder: pathlib.Path, data: str) -> float:
    out = tempfile.mkdtemp(dir=folder)
    run([BUILD / "bin/lte_train", "--config", "configs/train/demo.yaml", "--set",
         f"data.root={data}", "--set", "train.steps=22", "--set", "train.warmup_steps=2", "--set",
         "train.log_every=2", "--out", out, "--quiet"], way)
    rows = [json.loads(line) for line in (pathlib.Path(out) / "log.jsonl").open()]
    steps = [row for row in rows if "seconds" in row]
    return (steps[-1]["step"] - steps[0]["step"]) / (steps[-1]["seconds"] - steps[0]["seconds"])


def encode_points(way: dict, folder: pathlib.Path, _) -> float:
    run([sys.executable, __file__, "--encode-into", folder / "seconds"], way)
    return float((folder / "seconds").read_text())


class View(ctypes.Structure):
    _fields_ = [("data", ctypes.c_void_p), ("stride", ctypes.c_int64)]


class ScenePoints(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("count", ctypes.c_int64),
                *((name, View) for name in ("position", "normal", "albedo", "emission", "direct",
                                            "indirect")),
                ("area", ctypes.c_void_p), ("origin", ctypes.c_void_p),
                ("rescale", ctypes.c_int32), ("reserved", ctypes.c_int32)]


def encode_in_c(out: str) -> None:
    """The second encoding of random points through the C library: the first starts threads."""
    lib = ctypes.CDLL(str(BUILD / "lib/liblte_c_api.so"))
    model, embedding = ctypes.c_void_p(), ctypes.c_void_p()
    path = str(ROOT / "assets/models/lte-demo.safetensors").encode()
    assert lib.lte_model_open(path, None, ctypes.byref(model)) == 0
    rng = random.Random(1)

    def triples(values):
        return (ctypes.c_float * (3 * POINTS))(*values)

    arrays = [triples(rng.uniform(0, 4) for _ in range(3 * POINTS)),
              triples([0, 1, 0] * POINTS), triples([0.5] * (3 * POINTS)),
              triples([5 if i < 30 else 0 for i in range(3 * POINTS)])]
    views = [View(ctypes.addressof(array), 0) for array in arrays]
    points = ScenePoints(ctypes.sizeof(ScenePoints), POINTS, *views)
    for _ in range(2):
        begin = time.monotonic()
        assert lib.lte_model_encode(model, ctypes.byref(points), ctypes.byref(embedding)) == 0
        seconds = time.monotonic() - begin
    pathlib.Path(out).write_text(str(seconds))


WORK = {"lte_render, encode, s": encode_picture,
        "lte_train, steps/s": training,
        f"C interface, encode {POINTS} points, s": encode_points}


def measure(args, folder: pathlib.Path, busy: int) -> None:
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy)]
    found = {(work, way): [] for work in WORK for way in WAYS}
    try:
        for _ in range(args.rounds):
            for work, function in WORK.items():
                for way, environment in WAYS.items():
                    found[work, way].append(function(environment, folder, args.data))
    finally:
        for other in others:
            other.kill()
            other.wait()
    for (work, way), values in found.items():
        print(f"| {work} | {busy} | {way} | {statistics.median(values):.3g} | "
              f"{min(values):.3g} to {max(values):.3g} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", default="out/waiting", help="data set to train on")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--busy", type=int, nargs="+", default=[0, 1], help="processes beside it")
    parser.add_argument("--encode-into", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.encode_into:
        return encode_in_c(args.encode_into)
    print("| work | busy processes beside it | threads wait | median | range |\n"
          "|---|---:|---|---:|---|")
    with tempfile.TemporaryDirectory() as name:
        for busy in args.busy:
            measure(args, pathlib.Path(name), busy)


if __name__ == "__main__":
    main()
