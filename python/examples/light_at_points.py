#!/usr/bin/env python3
"""Gathered light at points of a scene's surfaces, held against path-traced light.

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

scene = lte.load(options.scene)
points, normals = scene.sample(options.points, seed=1)
start = time.perf_counter()
light = lte.irradiance(scene, points, normals)
between = time.perf_counter()
traced = lte.trace(scene, points, normals, rays=options.rays)
end = time.perf_counter()

lit = traced.total.mean(1) > 0.01 * traced.total.mean()  # inside of furniture there is no light
error = abs(light.total - traced.total).mean(1)[lit] / traced.total.mean(1)[lit]
print(f"{len(points)} points: gathered in {between - start:.1f} s, "
      f"{options.rays} paths each in {end - between:.1f} s")
print(f"median error of gathered light: {100 * np.median(error):.1f} %")
