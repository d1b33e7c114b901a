#!/usr/bin/env python3
"""Dims the lamps of a room so that its floor gets 300 lux, as evenly as they can.

Light is linear: one path tracing by lamp knows the light of all ways to dim them, and what is left
is least squares with gains that are not negative.

    dim_lamps.py [SCENE] [--lux 300] [--rays 4096]
"""
import argparse
import sys

import lte
import numpy as np

LUMENS_A_WATT = 179  # of equal-energy white, as Radiance has it
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def lux(irradiance):
    return LUMENS_A_WATT * irradiance @ LUMINANCE


def gains_for(lamps, target, rounds=500):
    """Gains >= 0 of lamps [L, N] whose sum is nearest to the target [N], one after another."""
    gains = np.ones(len(lamps))
    for _ in range(rounds):
        for i, lamp in enumerate(lamps):
            rest = target - gains @ lamps + gains[i] * lamp
            gains[i] = max(0, lamp @ rest / max(lamp @ lamp, 1e-12))
    return gains


parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scene", nargs="?", help="by default a home of the generator")
parser.add_argument("--lux", type=float, default=300)
parser.add_argument("--rays", type=int, default=4096)
options = parser.parse_args([] if hasattr(sys, "ps1") else None)  # none in notebooks

scene = lte.load(options.scene) if options.scene else lte.generate_scene("boxes", seed=4)
points, normals = scene.sample(4000, seed=1)
low = points[:, 1].min()
floor = (normals[:, 1] > 0.99) & (points[:, 1] < low + 0.05)
points, normals = points[floor][:100], normals[floor][:100]

light = lte.trace.irradiance(scene, points, normals, rays=options.rays, by_light=True)
lamps = lux(light.total)  # [L, N]
gains = gains_for(lamps, np.full(len(points), options.lux))
gains *= options.lux / (gains @ lamps).mean()
before = lamps.sum(0)
for lamp, gain in zip(scene.lights, gains):
    lamp.gain = gain
    print(f"{lamp.name}: {gain:.2f}")
# Other rays, and the dimmed lamps themselves, tell whether it is so.
after = lux(lte.trace.irradiance(scene, points, normals, rays=options.rays, seed=1).total)
for when, floor in (("before", before), ("after", after)):
    tenth = np.quantile(floor, 0.1) / floor.mean()
    print(f"{when}: {floor.mean():.0f} lux, darkest tenth {tenth:.2f} of it")
