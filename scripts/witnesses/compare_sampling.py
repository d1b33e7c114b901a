#!/usr/bin/env python3
"""Times farthest point sampling beside PyPI's fpsample at its exact settings, on the same points,
in one run.

usage: scripts/witnesses/compare_sampling.py [--build build] [--points 20000] [--repeats 20]
Needs numpy and fpsample, and lte_sampling_bench, which is built with the tests. Picks differ, as
fpsample does not start at point 0; the last insertion distances are nearly the same.
"""
import argparse
import pathlib
import subprocess
import tempfile
import time

import fpsample
import numpy as np


def room(count: int) -> np.ndarray:
    """Points on the walls, floor and ceiling of a room of 10 x 3 x 8 m."""
    rng = np.random.default_rng(1)
    p = rng.random((count, 3), dtype=np.float32)
    axis = rng.integers(0, 3, count)
    p[np.arange(count), axis] = np.round(p[np.arange(count), axis])
    return np.ascontiguousarray(p * np.array([10, 3, 8], np.float32))


def insertion_distance(points: np.ndarray, picks: np.ndarray) -> float:
    """How far the last pick is from all before it: the same for every exact sampling up to ties."""
    return float(np.linalg.norm(points[picks[:-1]] - points[picks[-1]], axis=1).min())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build", help="build folder")
    parser.add_argument("--points", type=int, default=20000)
    parser.add_argument("--repeats", type=int, default=20)
    args = parser.parse_args()
    points, count = room(args.points), args.points // 2
    with tempfile.TemporaryDirectory() as folder:
        to, back = pathlib.Path(folder) / "points", pathlib.Path(folder) / "picks"
        points.tofile(to)
        bench = pathlib.Path(args.build) / "bin" / "lte_sampling_bench"
        command = [bench, to, str(count), str(args.repeats), back]
        ours = float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        picks = np.fromfile(back, np.int64)
    # The second halving is the head of the first run's picks, for either.
    print(f"{args.points} -> {count} -> {count // 2}, least of {args.repeats}")
    print(
        f"lte                     {1e3 * ours:8.2f} ms                  last insertion distance "
        f"{insertion_distance(points, picks):.6f}"
    )
    for h in range(3, 10):
        times = []
        for _ in range(args.repeats + 1):
            start = time.perf_counter()
            other = fpsample.bucket_fps_kdline_sampling(points, count, h=h, start_idx=0)
            times.append(time.perf_counter() - start)
        peer, other = min(times[1:]), other.astype(np.int64)
        print(f"fpsample kd-line, h = {h} {1e3 * peer:8.2f} ms  {peer / ours:6.2f} times lte  "
              f"last insertion distance {insertion_distance(points, other):.6f}")


if __name__ == "__main__":
    main()
