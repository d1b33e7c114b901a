#!/usr/bin/env python3
"""Draws the rounding errors that lte_stability_bench writes, layer by layer.

usage: build/bin/lte_stability_bench --json numerics.json
       scripts/figures/plot_numerics.py numerics.json --out docs/images/numerics.png
Needs matplotlib.
"""
import argparse
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    rows = [row for row in json.loads(arguments.json.read_text()) if row["kind"] == "decoder"]
    names = list(dict.fromkeys(row["name"] for row in rows))
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), sharex=True)
    for axis, key, title in zip(
            axes,
        ("fp32_against_fp64", "bf16_against_fp32"),
        ("float32 against float64", "bf16 against float32"),
    ):
        for name in names:
            own = sorted((row["layers"], row[key]) for row in rows if row["name"] == name)
            axis.semilogy(*zip(*own), marker="o", markersize=3, linewidth=1, label=name)
        axis.set_title(title, fontsize=9)
        axis.set_xlabel("layers of the query decoder", fontsize=8)
        axis.tick_params(labelsize=7)
        axis.grid(True, which="both", linewidth=0.3)
    axes[0].set_ylabel("relative error, Euclidean norm", fontsize=8)
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    figure.legend(*axes[1].get_legend_handles_labels(), fontsize=7, loc="lower center", ncol=3)
    figure.savefig(arguments.out, dpi=110)


if __name__ == "__main__":
    main()
