#!/usr/bin/env python3
"""Prints indirect irradiance at points of a small room, by a module that lte_export has written,
and radiance there from other places, if the module tells it.

usage: room_light.py MODEL.pt

It needs PyTorch and nothing of lte, if the module was exported with --portable. room_light.cpp
beside it does the same in C++; docs/torchscript.md explains the tensors.
"""
import json
import math
import sys

try:
    import torch
except (ImportError, OSError) as error:
    sys.exit(f"room_light.py: this Python ({sys.executable}) cannot import PyTorch: {error}. "
             "Any PyTorch of 2.8 or newer will do: pip install torch. The wheel in lte's .venv "
             "serves C++ alone and lacks what Python needs (docs/torchscript.md).")

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
# Of each place, one that radiance comes from.
SEEN = {"the left wall": (0, 1.3, 2.6), "the right wall": (4, 1.3, 2.6), "the floor": (2.1, 0, 2.6)}


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
    For a model that reads it a renderer would trace some paths; others solve it themselves."""
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


def nearest(points, places):
    """The cells at some places."""
    return [int((points[:, :3] - torch.tensor(place)).square().sum(1).argmin())
            for place in places]


def print_table(what, names, answers, expected):
    print(f"{what:32}network: R      G      B   radiosity: R      G      B")
    for name, answer, right in zip(names, answers, expected):
        print(f"{name:30}" + "".join(f"{v:7.3f}" for v in answer.tolist()) + "     " +
              "".join(f"{v:7.3f}" for v in right.tolist()))


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    files = {"normalization.json": ""}
    model = torch.jit.load(sys.argv[1], _extra_files=files)
    said = json.loads(files["normalization.json"])
    # Light that the module solves by itself need not be given.
    columns = [name for name in said["points"] if name not in said.get("solved", [])]

    points = torch.cat([samples(*rectangle) for rectangle in ROOM])
    direct, indirect = light(points)
    given = dict(zip(("position", "normal", "albedo", "emission", "area"),
                     points.split([3, 3, 3, 3, 1], 1)), direct=direct, indirect=indirect)
    # The backs of the walls are dark, the estimates exact, and nothing is metal.
    given.update(direct_back=0 * direct, indirect_back=0 * direct, indirect_error=0 * direct[:, :2],
                 gloss=torch.tensor([[0.0, 1.0]]).expand(len(points), 2))
    rows, seen = nearest(points, PLACES.values()), nearest(points, SEEN.values())
    with torch.no_grad():
        embedding = model.encode(torch.cat([given[name] for name in columns], 1))
        irradiance = model.decode(embedding, points[rows, :9])
        print_table("indirect irradiance, W/m^2", PLACES, irradiance, indirect[rows])
        if not hasattr(model, "radiance"):
            return 0
        way = points[seen, :3] - points[rows, :3]
        way = way / way.norm(dim=1, keepdim=True)
        radiance = model.radiance(embedding, points[rows, :9], way[:, None])[:, 0]
    sent = points[seen, 6:9] / math.pi * (direct + indirect)[seen]
    names = [f"{place} from {other}" for place, other in zip(PLACES, SEEN)]
    print_table("radiance, W sr^-1 m^-2", names, radiance, sent)
    return 0


if __name__ == "__main__":
    sys.exit(main())
