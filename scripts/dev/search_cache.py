#!/usr/bin/env python3
"""Searches the constants of the irradiance cache (lte/nn/constants.h) on baked scenes.

Reads data sets of lte_datagen whose files know the light on each side of a surface, reads the cache
at their query points without any network, and changes one constant at a time as long as that helps:
neighbours, falloff with distance and with height above the query's plane, power of the normals'
product, share of a back, least weight. What is made larger is the geometric mean over scenes and
numbers of points of the equivalent paths: the variance of one path over the squared error, both at
the query points, the reference's own variance taken off.

    scripts/dev/search_cache.py DIR [DIR ...] [--set back=0 ...] [--search] [--by-scene]

Without --search it tells what the constants of today are worth, or others by --set. The formulas
are written here a second time, independently of the library. Needs numpy and scipy.
"""

import argparse
import json
import math
import struct
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

SIZES = (4096, 8192, 16384)
MOST_NEIGHBOURS = 64
QUERIES = 2048  # of a scene
GRIDS = {
    "neighbours": (8, 12, 16, 24, 32, 48, 64),
    "near": (0.5, 1, 1.5, 2, 3, 4, 6),
    "plane": (16, 32, 64, 128, 256, 512, 1024),
    "power": (1, 2, 3, 4, 6, 8),
    "back": (0.3, 0.1, 0.03, 0.01, 0.003, 0.001),
    "least": (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6),
}
TODAY = {
    "sum": {"neighbours": 32, "near": 2.0, "plane": 64.0, "power": 4.0, "least": 1e-4},
    "apart": {
        "neighbours": 32, "near": 1.5, "plane": 256.0, "power": 4.0, "least": 1e-3, "back": 0.1
    },
}


def read_sample(path):
    """The tensors of a safetensors file, by name, and its metadata."""
    data = path.read_bytes()
    (length,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + length])
    types = {"F32": np.float32, "F16": np.float16, "I32": np.int32, "U8": np.uint8}
    metadata = header.pop("__metadata__")
    tensors = {}
    for name, about in header.items():
        begin, end = (8 + length + offset for offset in about["data_offsets"])
        values = np.frombuffer(data[begin:end], types[about["dtype"]])
        tensors[name] = values.reshape(about["shape"])
    return tensors, metadata


def check_sides(path, sample):
    if "scene_direct_back" not in sample:
        sys.exit(f"{path}: has no scene_direct_back; bake the data again")


class Near:
    """A scene's queries and the points near them, for one number of points."""

    def __init__(self, sample, metadata, count, rng):
        emission, area = sample["scene_emission"], sample["scene_area"].astype(np.float64)
        scale = (emission * area[:, None]).sum(0) / area.sum()
        scale = np.where(scale > 0, scale, 1)
        reference = sample["indirect"].sum(0)
        asked = (reference.max(1) > 0) | (sample["direct"].sum(0).max(1) > 0)
        asked = np.flatnonzero(asked & (sample["query_albedo"].max(1) > 0))
        asked = asked[:: max(1, len(asked) // QUERIES)]  # they are ordered by surface
        rows = rng.permutation(len(emission))[:count]
        rows = rows[emission[rows].max(1) == 0]
        place, up = sample["query_position"][asked], sample["query_normal"][asked]
        distance, index = cKDTree(sample["scene_position"][rows]).query(place, MOST_NEIGHBOURS)
        index = rows[index]
        offset = sample["scene_position"][index] - place[:, None]
        back = sample["scene_indirect_back"].sum(0)
        front = sample["scene_indirect"].sum(0) - back
        self.distance2 = (distance**2).astype(np.float32)
        self.height = np.einsum("qkc,qc->qk", offset, up)
        self.cosine = np.einsum("qkc,qc->qk", sample["scene_normal"][index], up)
        self.front = (front / scale).astype(np.float32)[index]
        self.back = (back / scale).astype(np.float32)[index]
        self.reference = reference[asked] / scale
        variance = sample["variance"][asked] / scale.mean() ** 2
        self.noise = variance.mean()
        self.path_variance = variance.mean() * float(metadata["rays"])

    def read(self, sides, c):
        """What a cache of these constants says at the queries."""
        k = c["neighbours"]
        d2, height, cosine = (x[:, :k] for x in (self.distance2, self.height, self.cosine))
        front, back = self.front[:, :k], self.back[:, :k]
        scale = np.maximum(d2.mean(1, keepdims=True), 1e-16)
        weight = np.exp(-(c["near"] * d2 + c["plane"] * height**2) / scale)
        weight *= np.abs(cosine) ** c["power"]
        both = front + back
        if sides == "sum":
            weight *= cosine > 0
            light = both
        else:
            behind = cosine < 0
            weight *= np.where(behind, c["back"], 1)
            light = np.where(behind[..., None], back, front)
        total = weight.sum(1) + k * c["least"]
        summed = np.einsum("qk,qkc->qc", weight, light) + c["least"] * both.sum(1)
        return summed / total[:, None]

    def error(self, sides, constants):
        found = self.read(sides, constants)
        return max(1e-12, ((found - self.reference) ** 2).mean() - self.noise)


def equivalent_paths(scenes, sides, constants):
    """By number of points, those of each scene."""
    return [[near.path_variance / near.error(sides, constants) for near in scene]
            for scene in scenes]


def geometric_mean(values):
    return math.exp(np.mean(np.log(values)))


def search(scenes, sides):
    found = dict(TODAY[sides])
    best = geometric_mean(equivalent_paths(scenes, sides, found))
    moved = True
    while moved:
        moved = False
        for key in found:
            for value in GRIDS[key]:
                if value == found[key]:
                    continue
                paths = geometric_mean(equivalent_paths(scenes, sides, {**found, key: value}))
                if paths > best * 1.002:
                    best, moved = paths, True
                    found[key] = value
                    print(f"  {sides}: {key} = {value:g}: {paths:.2f}", flush=True)
    return found


def report(scenes, sides, constants, names):
    paths = equivalent_paths(scenes, sides, constants)
    text = ", ".join(f"{key} {value:g}" for key, value in constants.items())
    print(f"{sides}: {text}")
    for i, count in enumerate(SIZES):
        errors = [scene[i].error(sides, constants) for scene in scenes]
        values = [row[i] for row in paths]
        print(f"  {count:6d} points: MSE {np.mean(errors):.4g}, median {np.median(errors):.4g}; "
              f"paths {geometric_mean(values):.1f}, median {np.median(values):.1f}")
    if names:
        for name, row in zip(names, paths):
            print("  " + name + " " + " ".join(f"{value:7.1f}" for value in row))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", nargs="+", type=Path, help="data sets of lte_datagen")
    parser.add_argument("--search", action="store_true", help="look for better constants")
    parser.add_argument("--by-scene", action="store_true", help="also tell each scene's paths")
    parser.add_argument("--set", nargs="+", default=[], metavar="KEY=VALUE",
                        help="other constants for sides apart: " + ", ".join(TODAY["apart"]))
    options = parser.parse_args()
    for text in options.set:
        key, _, value = text.partition("=")
        try:
            TODAY["apart"][key] = type(TODAY["apart"][key])(float(value))
        except (KeyError, ValueError):
            parser.error(f"--set {text}: expected one of {', '.join(TODAY['apart'])} = a number")
    scenes, names = [], []
    for root in options.data:
        for path in sorted((root / "scenes").glob("*.safetensors")):
            sample, metadata = read_sample(path)
            check_sides(path, sample)
            rng = np.random.default_rng(1)
            scenes.append([Near(sample, metadata, count, rng) for count in SIZES])
            names.append(path.stem)
    if not scenes:
        sys.exit(f"{options.data[0]}: no scenes in it")
    for sides in TODAY:
        report(scenes, sides, TODAY[sides], names if options.by_scene else [])
        if options.search:
            report(scenes, sides, search(scenes, sides), names if options.by_scene else [])


if __name__ == "__main__":
    main()
