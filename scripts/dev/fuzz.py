#!/usr/bin/env python3
"""Builds the libFuzzer targets of tests/fuzz with clang, and runs them by turns until they have
made a number of executions in all.

  scripts/dev/fuzz.py --build-only
  scripts/dev/fuzz.py --executions 10000000
  scripts/dev/fuzz.py --status

It may be stopped at any time, and the same command goes on: build-fuzz/campaign.json counts the
executions of finished rounds by target, build-fuzz/grown/TARGET keeps the corpus that has grown.
Each round of a target takes --round seconds. Inputs that a target fails on lie in
build-fuzz/findings/TARGET; the target then goes on with the next round. A finding is mended, and
its file, made small by `TARGET -minimize_crash=1 FILE`, added to tests/fuzz/corpus/TARGET.
The render target needs an ordinary build in build/ first (ninja -C build lte_c_api lte_fuzz_model).
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build-fuzz"
CORPUS = ROOT / "tests/fuzz/corpus"
# The importers are quick; a picture takes milliseconds.
SHARES = {"gltf": 0.3, "obj": 0.25, "ply": 0.2, "pbrt": 0.15, "render": 0.05, "view": 0.05}
MAX_BYTES = {"gltf": 16384, "obj": 4096, "ply": 4096, "pbrt": 4096, "render": 16384, "view": 4096}
STATE = BUILD / "campaign.json"


def fail(message: str) -> None:
    print(f"fuzz.py: {message}", file=sys.stderr)
    raise SystemExit(1)


def run(*command: str) -> None:
    if subprocess.run(command, cwd=ROOT).returncode != 0:
        fail(f"failed: {' '.join(command)}")


def build(jobs: int, targets: list[str]) -> None:
    if not (BUILD / "build.ninja").exists():
        run("cmake", "-S", ".", "-B", str(BUILD), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
            "-DCMAKE_C_COMPILER=clang", "-DCMAKE_CXX_COMPILER=clang++", "-DLTE_FUZZ=ON",
            "-DLTE_TORCH=OFF", "-DLTE_CUDA=OFF", "-DLTE_TESTS=OFF", "-DLTE_WERROR=OFF")
    run("ninja", "-C", str(BUILD), f"-j{jobs}", *(f"lte_{target}_fuzz" for target in targets))
    model = BUILD / "model.safetensors"
    if "render" in targets and not model.exists():
        run(str(ROOT / "build/bin/lte_fuzz_model"), str(model))


def load_state() -> dict:
    state = json.loads(STATE.read_text()) if STATE.exists() else {}
    return {target: state.get(target, {"executions": 0, "seconds": 0, "findings": 0})
            for target in SHARES}


def save_state(state: dict) -> None:
    aside = STATE.with_suffix(".tmp")
    aside.write_text(json.dumps(state, indent=1) + "\n")
    aside.rename(STATE)


def print_status(state: dict) -> None:
    for target, row in state.items():
        print(f"{target:8} {row['executions']:>10} executions {row['seconds']:>7.0f} s "
              f"{row['findings']:>4} findings")
    print(f"{'in all':8} {sum(row['executions'] for row in state.values()):>10} executions")


def seeds(target: str) -> list[str]:
    scenes = [name for name in SHARES if name != "view"]
    folders = [CORPUS / name for name in (scenes if target == "render" else [target])]
    return [str(folder) for folder in folders if folder.is_dir()]


def round_of(target: str, seconds: int, left: int, row: dict) -> None:
    grown, findings = BUILD / "grown" / target, BUILD / "findings" / target
    for folder in (grown, findings):
        folder.mkdir(parents=True, exist_ok=True)
    command = [str(BUILD / "bin" / f"lte_{target}_fuzz"), f"-max_len={MAX_BYTES[target]}",
               "-timeout=120", "-rss_limit_mb=3000", f"-max_total_time={seconds}", f"-runs={left}",
               "-print_final_stats=1", "-print_funcs=0", f"-artifact_prefix={findings}/",
               str(grown), *seeds(target)]
    # LibTorch keeps what it has until the end; leaks of ours are looked for in the other targets.
    environment = dict(os.environ, ASAN_OPTIONS=f"detect_leaks={int(target != 'render')}")
    begin = time.monotonic()
    ended = subprocess.run(command, cwd=BUILD, env=environment, text=True, errors="replace",
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    row["seconds"] += time.monotonic() - begin
    exact = re.search(r"number_of_executed_units: (\d+)", ended.stderr)
    seen = exact or re.search(r".*^#(\d+)\s", ended.stderr, re.MULTILINE | re.DOTALL)
    row["executions"] += int(seen.group(1)) if seen else 0
    if ended.returncode != 0:
        row["findings"] += 1
        (findings / f"log-{row['findings']}.txt").write_text(ended.stderr[-20000:])
        print(f"{target}: a finding, see {findings}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executions", type=int, default=10_000_000, help="in all")
    parser.add_argument("--round", type=int, default=300, help="seconds of a target's turn")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="stop after so many")
    parser.add_argument("--jobs", type=int, default=1, help="of the build")
    parser.add_argument("--build-only", action="store_true")
    parser.add_argument("--no-build", action="store_true")
    parser.add_argument("--status", action="store_true")
    parser.add_argument("--targets", nargs="+", choices=SHARES, default=list(SHARES))
    args = parser.parse_args()
    state = load_state()
    if args.status:
        return print_status(state)
    if not args.no_build:
        build(args.jobs, args.targets)
    if args.build_only:
        return
    end = time.monotonic() + args.seconds
    while time.monotonic() < end:
        # What is farthest behind its share comes first; what one lacks, another makes up for.
        lacking = args.executions - sum(row["executions"] for row in state.values())
        if lacking <= 0:
            break
        target = min(args.targets, key=lambda name: state[name]["seconds"] / SHARES[name])
        round_of(target, min(args.round, max(1, int(end - time.monotonic())))
                 if end != float("inf") else args.round, lacking, state[target])
        save_state(state)
    print_status(state)


if __name__ == "__main__":
    main()
