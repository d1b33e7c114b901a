#!/usr/bin/env python3
"""A picture of a scene, and what is in it.

    first_picture.py [SCENE] [--size WxH] [--out room.png]
"""
import argparse
import sys

import lte

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scene", nargs="?", default=lte.living_room)
parser.add_argument("--size", default="640x480")
parser.add_argument("--out", default="room.png")
options = parser.parse_args([] if hasattr(sys, "ps1") else None)  # none in notebooks

scene = lte.load(options.scene)
width, height = map(int, options.size.split("x"))
picture = lte.render(scene, size=(width, height), quality="preview")
picture.save(options.out)
depth = picture.layers["depth"]
near, far = depth[depth > 0].min(), depth.max()
print(f"{options.out}: {scene!r}, surfaces {near:.1f} to {far:.1f} m away")
