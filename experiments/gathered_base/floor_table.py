#!/usr/bin/env python3
"""Prints what experiment_gathered_base found in several rooms (--json), over all of them.

usage: experiments/gathered_base/floor_table.py FOLDER...

Equal-error paths a point: geometric mean and least; the median of the worst that more rays cannot
take away (the bias of the table); mean ratio, its largest distance from 1, processor time.
"""
import json
import math
import pathlib
import statistics
import sys


def rows_of(result):
    unit = result["answers"][0]["worth"] * result["answers"][0]["mse"]
    biases = {table["name"]: table for table in result["tables"]}
    for row in result["answers"]:
        table = biases.get(row["name"], {"bias": row["mse"], "seconds": 0})
        floor = unit / table["bias"] if table["bias"] > 0 else math.inf
        yield (row["name"], row["rays"]), {**row, "floor": floor, "seconds": table["seconds"]}


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.strip())
    folders = map(pathlib.Path, sys.argv[1:])
    paths = [path for folder in folders for path in sorted(folder.glob("*.json"))]
    rooms = [dict(rows_of(json.loads(path.read_text()))) for path in paths]
    print(f"| {len(rooms)} rooms | rays | paths a point | least | floor | mean ratio | farthest |"
          " µs | table, s |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for name, rays in rooms[0]:
        rows = [room[name, rays] for room in rooms]
        worth = [row["worth"] for row in rows]
        if min(worth) <= 0:
            print(f"| {name} | {rays} | below noise in {sum(w <= 0 for w in worth)} rooms |")
            continue
        ratios = [row["mean_ratio"] for row in rows]
        median = {key: statistics.median(row[key] for row in rows)
                  for key in ("floor", "microseconds", "seconds")}
        print(f"| {name} | {rays} | {math.exp(statistics.mean(map(math.log, worth))):.0f}"
              f" | {min(worth):.1f} | {median['floor']:.0f} | {statistics.mean(ratios):.2f}"
              f" | {max(ratios, key=lambda ratio: abs(ratio - 1)):.2f}"
              f" | {median['microseconds']:.1f} | {median['seconds']:.2f} |")


if __name__ == "__main__":
    main()
