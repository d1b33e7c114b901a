#!/usr/bin/env python3
"""Fits what lte_probe expects of its errors (infer/probe/expected_error.cpp), and tells how often
it holds.

usage: scripts/dev/fit_expected_error.py --fit DIR [DIR ...] [--check DIR [DIR ...]]
           [--models lte-base,lte-hybrid] [--draws 1,2] [--build build] [--keep DIR]

The folders are data sets of lte_datagen made with --glb, whose references the answers of lte_probe
are compared with at their query points, those that no light reaches and those that reflect nothing
left out. To make some of other seeds than any model was trained on:

    for kind in homes boxes; do
      lte_datagen generate --config configs/data/${kind}_test.yaml --seed 51001 --scenes 16 --glb \\
          --set views.count=0 --set path_tracing_64=false --set prune=true --out fit/$kind
    done

An expected error is the root of Σ (share_k term_k)². The shares make Σ log s² + (e² - v) / s² least
over the points, with s² the square of the expected error, e² that of the error and v the variance
of the reference. That sum is least where s² is the mean of the true squared errors, whatever their
distribution, and noise of the reference takes no part (Patton 2011, "Volatility forecast comparison
using imperfect volatility proxies"). Each scene counts alike. Needs numpy and scipy.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.stats import spearmanr

from search_cache import read_sample

ROOT = Path(__file__).resolve().parents[2]
LEAST_SHARE = 0.005  # less is nothing


def write_points(path, positions, normals):
    with path.open("w") as file:
        file.write("px,py,pz,nx,ny,nz\n")
        for row in zip(positions, normals):
            file.write(",".join(f"{value:.9g}" for value in np.concatenate(row)) + "\n")


def read_table(path):
    names = path.open().readline().strip().split(",")
    columns = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2).T
    return dict(zip(names, columns))


class Scene:
    """The terms of lte_probe at the points of a scene, and its true errors there."""

    def __init__(self, sample, table):
        self.terms = {name: table[name] for name in table if name.startswith("term_")}
        rgb = [table[f"total_{c}"] - table[f"direct_{c}"] for c in "rgb"]
        self.squared_error = ((np.stack(rgb, 1) - sample["indirect"]) ** 2).mean(1)
        self.reference_variance = sample["variance"]

    @property
    def mean(self):
        return self.terms["term_mean"][0]

    def expected(self, shares):
        squares = [(share * self.terms[name]) ** 2 for name, share in shares.items()]
        return np.sqrt(np.sum(squares, 0))


def probe_scenes(folders, model, draws, build, keep):
    scenes = []
    for folder in map(Path, folders):
        samples = sorted((folder / "scenes").glob("*.safetensors"))
        if not any(path.with_suffix(".glb").exists() for path in samples):
            sys.exit(f"{folder}: expected a data set made by lte_datagen generate --glb")
        for path in samples:
            if not path.with_suffix(".glb").exists():
                continue
            sample, _ = read_sample(path)
            light = sample["indirect"].sum(0), sample["direct"].sum(0)
            asked = (light[0].max(1) > 0) | (light[1].max(1) > 0)
            asked &= sample["query_albedo"].max(1) > 0
            points = Path(keep) / "points.csv"
            out = Path(keep) / f"{folder.name}.{path.stem}.{Path(model).stem}.{draws}.csv"
            if not out.exists():
                write_points(points, sample["query_position"][asked], sample["query_normal"][asked])
                subprocess.run([
                    f"{build}/bin/lte_probe", path.with_suffix(".glb"), "--points", points, "--out",
                    out, "--checkpoint", model, "--draws", str(draws), "--quiet",
                    "--error-terms"
                ], check=True)
            lit = {"indirect": light[0][asked], "variance": sample["variance"][asked]}
            scenes.append(Scene(lit, read_table(out)))
    return scenes


def fit_shares(scenes, names):
    """The shares of the terms; those that help by nothing are 0."""
    rows = [np.stack([scene.terms[name] ** 2 for name in names], 1) for scene in scenes]
    squares = np.concatenate(rows)
    weight = np.concatenate([np.full(len(row), 1 / len(row)) for row in rows])
    truth = np.concatenate([s.squared_error - s.reference_variance for s in scenes])
    some = squares.sum(1) > 0
    squares, weight, truth = squares[some], weight[some], truth[some]

    def loss(log_squared_shares):
        squared_shares = np.exp(log_squared_shares)
        expected = squares @ squared_shares
        slope = weight * (1 / expected - truth / expected**2)
        return ((weight * (np.log(expected) + truth / expected)).sum(),
                (slope[:, None] * squares).sum(0) * squared_shares)

    starts = [np.full(len(names), start) for start in (-3.0, -5.0)]
    bounds = [(-14, 4)] * len(names)
    found = [minimize(loss, s, jac=True, bounds=bounds, method="L-BFGS-B") for s in starts]
    shares = np.sqrt(np.exp(min(found, key=lambda one: one.fun).x))
    return {name: share for name, share in zip(names, shares) if share > LEAST_SHARE}


def calibration(scenes, shares):
    """Means over the scenes: shares of points within multiples, and the rank correlation; and by
    tenths of all points, ordered by what is expected, the root mean squares of both errors over the
    mean answer of the scene."""
    multiples = (0.5, 1, 2, 3, 5)
    within, ranks, expected, truth = [], [], [], []
    for scene in scenes:
        error, stated = np.sqrt(scene.squared_error), scene.expected(shares)
        within.append([(error <= multiple * stated).mean() for multiple in multiples])
        ranks.append(spearmanr(error, stated)[0])
        expected.append(stated / scene.mean)
        truth.append((scene.squared_error - scene.reference_variance) / scene.mean**2)
    expected, truth = np.concatenate(expected), np.concatenate(truth)
    tenths = [(np.sqrt((expected[rows] ** 2).mean()), np.sqrt(max(0, truth[rows].mean())))
              for rows in np.array_split(np.argsort(expected), 10)]
    within = np.array(within)
    return {"within": dict(zip(multiples, within.mean(0))), "worst at 2": within[:, 2].min(),
            "rank correlation": np.mean(ranks), "tenths": tenths}


def tell(what, result):
    within = ", ".join(f"{m:g} x {100 * share:.1f} %" for m, share in result["within"].items())
    print(f"  {what}: within {within}; worst scene at 2 x {100 * result['worst at 2']:.0f} %; "
          f"rank correlation {result['rank correlation']:.3f}")
    for row, name in enumerate(("expected", "true")):
        print(f"    {name:>8} RMS by tenths: " +
              " ".join(f"{tenth[row]:.3f}" for tenth in result["tenths"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--fit", nargs="+", required=True)
    parser.add_argument("--check", nargs="*", default=[])
    parser.add_argument("--models", default="lte-base,lte-hybrid,lte-demo")
    parser.add_argument("--draws", default="1,2")
    parser.add_argument("--leave-out", default="", help="terms that get no share, with commas")
    parser.add_argument("--build", default=str(ROOT / "build"))
    parser.add_argument("--keep", help="a folder to keep tables in, and to read them from")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        keep = Path(arguments.keep or temporary)
        keep.mkdir(parents=True, exist_ok=True)
        for name in arguments.models.split(","):
            model = ROOT / f"assets/models/{name}.safetensors"
            for draws in map(int, arguments.draws.split(",")):
                def probed(folders):
                    return probe_scenes(folders, model, draws, arguments.build, keep)
                scenes = probed(arguments.fit)
                terms = [term for term in scenes[0].terms
                         if any(scene.terms[term].any() for scene in scenes)
                         and term not in arguments.leave_out.split(",")]
                shares = fit_shares(scenes, terms)
                print(f"{name}, {draws} draws: " +
                      ", ".join(f".{k.removeprefix('term_')} = {v:.2g}" for k, v in shares.items()))
                tell(f"fit, {len(scenes)} scenes", calibration(scenes, shares))
                for folder in arguments.check:
                    tell(folder, calibration(probed([folder]), shares))


if __name__ == "__main__":
    main()
