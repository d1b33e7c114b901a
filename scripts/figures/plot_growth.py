#!/usr/bin/env python3
"""Draws time and peak memory of lte_bench against the number of points or queries.

usage: scripts/figures/plot_growth.py --encoder E1.json E2.json ... --decoder D1.json ... \\
           --out docs/images/growth.png
Each file is one `lte_bench encoder|decoder --json`. Needs matplotlib.
"""
import argparse
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def rows(paths: list[pathlib.Path]) -> dict[str, list[dict]]:
    """Rows by precision, in ascending order of size."""
    found: dict[str, list[dict]] = {}
    for path in paths:
        for row in json.loads(path.read_text()):
            found.setdefault(row["precision"], []).append(row)
    return {key: sorted(value, key=lambda row: row["n"]) for key, value in found.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--encoder", type=pathlib.Path, nargs="+", required=True)
    parser.add_argument("--decoder", type=pathlib.Path, nargs="+", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4))
    for axis, paths, word in zip(axes, (arguments.encoder, arguments.decoder),
                                 ("scene points", "queries")):
        memory = axis.twinx()
        for precision, series in rows(paths).items():
            sizes = [row["n"] for row in series]
            axis.loglog(sizes, [row["seconds_min"] for row in series], "o-", markersize=4,
                        label=f"{precision}, seconds")
            memory.loglog(sizes, [row["rss_above_model_mb"] for row in series], "s--", markersize=3,
                          alpha=0.6, label=f"{precision}, MiB")
        axis.set_xlabel(word, fontsize=8)
        axis.set_ylabel("seconds", fontsize=8)
        memory.set_ylabel("MiB above the model", fontsize=8)
        axis.legend(loc="upper left", fontsize=7)
        memory.legend(loc="lower right", fontsize=7)
        axis.grid(True, which="major", linewidth=0.3)
        for a in (axis, memory):
            a.tick_params(labelsize=7)
    figure.tight_layout()
    figure.savefig(arguments.out, dpi=110)


if __name__ == "__main__":
    main()
