#!/usr/bin/env python3
"""Writes an equirectangular sky as a portable float map: blue above, brown below, a sun of a few
texels.

For trying and checking --environment of the tools (standard library alone). Y is up, +X in the
middle of the picture; the sun stands 35 degrees high, a third of a turn to the right of +X, and
gives about as much light as the rest of the sky.

usage: scripts/assets/make_sky.py OUT.pfm [WIDTH]     (default 128; the height is half of it)
"""
import math
import struct
import sys

SUN_HEIGHT, SUN_TURN = math.radians(35), math.radians(120)
SUN_RADIUS = math.radians(4)


def radiance(up, turn):
    """Linear Rec.709 radiance of a direction: `up` is its elevation, `turn` the angle from +X
    towards +Z."""
    if up < 0:
        return (0.12, 0.10, 0.07)
    blue = 0.35 + 0.65 * (1 - math.sin(up)) ** 2
    sky = (0.55 * blue, 0.75 * blue, 1.1 * blue)
    cosine = math.sin(up) * math.sin(SUN_HEIGHT) + math.cos(up) * math.cos(SUN_HEIGHT) * math.cos(
        turn - SUN_TURN)
    if cosine > math.cos(SUN_RADIUS):
        return (220.0, 190.0, 150.0)
    return sky


def main():
    path, width = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 128
    height = width // 2
    rows = []
    for y in range(height):
        row = []
        for x in range(width):
            row.extend(
                radiance(math.pi * (0.5 - (y + 0.5) / height),
                         2 * math.pi * ((x + 0.5) / width - 0.5)))
        rows.append(struct.pack(f"<{len(row)}f", *row))
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.writelines(reversed(rows))  # from the bottom up


if __name__ == "__main__":
    main()
