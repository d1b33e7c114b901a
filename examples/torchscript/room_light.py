#!/usr/bin/env python3
"""Prints indirect irradiance at points of a small room, by a module that lte_export has written.

usage: room_light.py MODEL.pt

It needs PyTorch and nothing of lte, if the module was exported with --portable. room_light.cpp
beside it does the same in C++; docs/torchscript.md explains the tensors.
"""
import json
import math
import sys

import torch

CELL = 0.25  # metres between samples
# Corner, two edges (their cross product faces the room), albedo, emission.
ROOM = (
    ((0, 0, 0), (0, 0, 5), (4, 0, 0), (0.55, 0.45, 0.35), (0, 0, 0)),  # floor
    ((0, 2.5, 0), (4, 0, 0), (0, 0, 5), (0.8, 0.8, 0.8), (0, 0, 0)),  # ceiling
    ((0, 0, 0), (0, 2.5, 0), (0, 0, 5), (0.65, 0.1, 0.1), (0, 0, 0)),  # left
    ((4, 0, 0), (0, 0, 5), (0, 2.5, 0), (0.1, 0.5, 0.15), (0, 0, 0)),  # right
    ((0, 0, 0), (4, 0, 0), (0, 2.5, 0), (0.75, 0.75, 0.75), (0, 0, 0)),  # back
    ((0, 0, 5), (0, 2.5, 0), (4, 0, 0), (0.75, 0.75, 0.75), (0, 0, 0)),  # front
    ((1.4, 2.49, 1.8), (1.2, 0, 0), (0, 0, 1.4), (0, 0, 0), (12, 11, 9)),  # lamp
)
PLACES = {"floor": (2.1, 0, 2.6), "left wall": (0, 1.3, 2.6), "back wall": (2.1, 1.3, 0)}


def samples(corner, edge1, edge2, albedo, emission):
    """The cells of a rectangle: position, normal, albedo, emission, area; [cells, 13]."""
    corner, edge1, edge2 = (torch.tensor(v, dtype=torch.float32) for v in (corner, edge1, edge2))
    rows, columns = (round(float(edge.norm()) / CELL) for edge in (edge1, edge2))
    u = (torch.arange(rows).repeat_interleave(columns) + 0.5) / rows
    v = (torch.arange(columns).repeat(rows) + 0.5) / columns
    across = torch.linalg.cross(edge1, edge2)
    same = torch.cat([across / across.norm(), torch.tensor(albedo), torch.tensor(emission),
                      across.norm()[None] / (rows * columns)])
    return torch.cat([corner + u[:, None] * edge1 + v[:, None] * edge2,
                      same.expand(rows * columns, 10)], 1)


def light(points):
    """Direct and indirect irradiance at the points, by radiosity between the cells; 0 on the lamp.
    A renderer would trace some paths instead."""
    position, normal, albedo, emission, area = points.split([3, 3, 3, 3, 1], 1)
    to = position[None] - position[:, None]
    distance2 = to.square().sum(2).clamp(min=1e-6)
    here = (to * normal[:, None]).sum(2).clamp(min=0)
    there = (-to * normal[None]).sum(2).clamp(min=0)
    # What a cell of the column gives to a point of the row, the cell taken for a disc.
    share = here * there / distance2 * area.T / (math.pi * distance2 + area.T)
    direct = share @ (math.pi * emission)
    total = direct
    for _ in range(5):
        total = direct + share @ (albedo * total)
    dark = (emission.amax(1, keepdim=True) == 0).float()
    return dark * direct, dark * (total - direct)


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    files = {"normalization.json": ""}
    model = torch.jit.load(sys.argv[1], _extra_files=files)
    columns = json.loads(files["normalization.json"])["points"]

    points = torch.cat([samples(*rectangle) for rectangle in ROOM])
    direct, indirect = light(points)
    # Nothing comes to the walls from behind, and radiosity has no noise.
    none = torch.zeros_like(direct)
    given = dict(zip(("position", "normal", "albedo", "emission", "area"),
                     points.split([3, 3, 3, 3, 1], 1)), direct=direct, indirect=indirect,
                 direct_back=none, indirect_back=none, indirect_error=none[:, :2])
    nearest = [int((points[:, :3] - torch.tensor(place)).square().sum(1).argmin())
               for place in PLACES.values()]
    with torch.no_grad():
        embedding = model.encode(torch.cat([given[name] for name in columns], 1))
        irradiance = model.decode(embedding, points[nearest, :9])
    print("indirect irradiance, W/m^2      network: R      G      B   radiosity: R      G      B")
    for name, row, answer in zip(PLACES, nearest, irradiance):
        print(f"{name:30}" + "".join(f"{v:7.3f}" for v in answer.tolist()) + "     " +
              "".join(f"{v:7.3f}" for v in indirect[row].tolist()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
