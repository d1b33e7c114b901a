#!/usr/bin/env python3
"""Light at points of a scene, gathered and as a network has it, against path-traced light.

    light_at_points.py [SCENE] [--points 2000] [--rays 1024]
"""
import argparse
import sys
import time

import lte
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scene", nargs="?", default=lte.living_room)
parser.add_argument("--points", type=int, default=2000)
parser.add_argument("--rays", type=int, default=1024)
options = parser.parse_args([] if hasattr(sys, "ps1") else None)  # none in notebooks


def timed(call):
    start = time.perf_counter()
    return call(), time.perf_counter() - start


def say(name, found, truth, seconds):
    lit = truth.mean(1) > 0.01 * truth.mean()  # inside of furniture there is no light
    error = abs(found - truth).mean(1)[lit] / truth.mean(1)[lit]
    print(f"median error of {name}: {100 * np.median(error):.1f} %, in {seconds:.1f} s")


scene = lte.load(options.scene)
points, normals = scene.sample(options.points, seed=1)
traced, seconds = timed(lambda: lte.trace.irradiance(scene, points, normals, rays=options.rays))
print(f"{len(points)} points: {options.rays} paths each in {seconds:.1f} s")
light, seconds = timed(lambda: lte.irradiance(scene, points, normals))
say("gathered light", light.total, traced.total, seconds)

embedding, seconds = timed(lambda: lte.Model.load().encode(scene))
print(f"encoded for the network in {seconds:.1f} s, from {embedding.scene_points} points")
answer, seconds = timed(lambda: embedding.irradiance(points, normals))
say("the network's indirect light", answer, traced.indirect, seconds)
