#!/usr/bin/env python3
"""Writes assets/scenes/guiding_*.glb: three rooms that are lit by reflected light alone, for
experiment_guiding. Metres, Y up; all are 4 m wide, 2.6 m high and at least 4 m deep.

- screen: a lamp on the back wall behind a standing screen, seen from the other side of it.
- door: a lamp in the next room, whose door stands ajar.
- metal: a hooded lamp that shines on a wall of brushed metal, which lights the room.
"""
import argparse
import json
import math
import pathlib
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts/assets"))
from make_cornell_box import Glb, facing, gltf_material, subtract  # noqa: E402

WHITE, RED, BLUE, WOOD, STEEL, LAMP = range(6)
MATERIALS = [("white", (0.75, 0.75, 0.75), 0, 1), ("red", (0.6, 0.12, 0.08), 0, 1),
             ("blue", (0.1, 0.2, 0.55), 0, 1), ("wood", (0.45, 0.3, 0.18), 0, 1),
             ("steel", (0.7, 0.7, 0.72), 1, 0.2), ("lamp", (0.5, 0.5, 0.5), 0, 1)]
EMISSION = (16.0, 14.0, 10.0)
EMISSIVE_STRENGTH = 16.0
WIDTH, HEIGHT = 4000, 2600  # millimetres, as the Glb of make_cornell_box takes them


def box(low, high):
    """The six sides of a body, facing away from its centre."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    centre = tuple((a + b) / 2 for a, b in zip(low, high))
    sides = [[(x0, y0, z0), (x0, y1, z0), (x0, y1, z1), (x0, y0, z1)],
             [(x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1)],
             [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
             [(x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)],
             [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)],
             [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)]]
    return [facing(side, subtract(side[0], centre)) for side in sides]


def room(depth, materials=None):
    """(name, material, quads) of floor, ceiling and walls, facing inwards."""
    names = ("left wall", "right wall", "floor", "ceiling", "front wall", "back wall")
    usual = dict(zip(names, (RED, BLUE, WOOD, WHITE, WHITE, WHITE))) | (materials or {})
    for name, side in zip(names, box((0, 0, 0), (WIDTH, HEIGHT, depth))):
        yield name, usual[name], [side[::-1]]


def turned(quads, about, degrees):
    """Bodies turned around the upright axis through `about`, (x, z)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def turn(point):
        x, z = point[0] - about[0], point[2] - about[1]
        return (about[0] + c * x + s * z, point[1], about[1] - s * x + c * z)

    return [[turn(point) for point in quad] for quad in quads]


def panel(x, y, z, normal):
    """A square lamp of 0.4 m around a place, that shines along `normal`."""
    across = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    u, v = [axis for axis, along in zip(across, normal) if along == 0]
    corners = [tuple(p + 200 * (a * i + b * j) for p, i, j in zip((x, y, z), u, v))
               for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return [facing(corners, normal)]


def screen():
    yield from room(4000)
    yield "lamp", LAMP, panel(2000, 900, 3990, (0, 0, -1))
    yield "screen", WHITE, box((1100, 0, 3300), (2900, 1700, 3340))
    yield "chest", WOOD, box((500, 0, 1800), (1100, 600, 2400))
    yield "ball stand", STEEL, box((2700, 0, 1700), (3200, 500, 2200))


def door():
    yield from room(6500)
    # A wall between the rooms, with an opening of 0.9 by 2.05 m.
    for name, low, high in (("left", (0, 0, 4000), (2600, HEIGHT, 4100)),
                            ("right", (3500, 0, 4000), (WIDTH, HEIGHT, 4100)),
                            ("lintel", (2600, 2050, 4000), (3500, HEIGHT, 4100))):
        yield f"wall {name}", WHITE, box(low, high)
    leaf = box((2600, 5, 4000), (3495, 2045, 4040))
    yield "door", WOOD, turned(leaf, (2600, 4000), 25)
    yield "lamp", LAMP, panel(2000, 2590, 5300, (0, -1, 0))
    yield "chest", WOOD, box((500, 0, 2400), (1100, 600, 3000))
    yield "locker", STEEL, box((1500, 0, 2700), (2000, 900, 3200))


def metal():
    yield from room(4000, {"right wall": STEEL})
    yield "lamp", LAMP, panel(3000, 2000, 2600, (1, 0, 0))
    yield "hood", WHITE, box((2700, 1700, 2300), (2990, 2300, 2900))
    yield "chest", WOOD, box((500, 0, 2600), (1300, 600, 3400))
    yield "block", WHITE, box((2000, 0, 2700), (2500, 900, 3200))


SCENES = {"screen": screen, "door": door, "metal": metal}


def document(name):
    glb = Glb()
    meshes, nodes = [], []
    for part, material, quads in SCENES[name]():
        position, indices = glb.add_quads(quads)
        meshes.append({
            "name": part, "primitives": [{
                "attributes": {"POSITION": position}, "indices": indices, "material": material
            }]
        })
        nodes.append({"name": part, "mesh": len(meshes) - 1})
    # Looks along +z from the front wall, a half turn about y of glTF's -z.
    nodes.append({"name": "camera", "camera": 0, "translation": [2, 1.4, 0.1],
                  "rotation": [0, 1, 0, 0]})
    materials = [gltf_material(*entry) for entry in MATERIALS]
    materials[LAMP]["emissiveFactor"] = [value / EMISSIVE_STRENGTH for value in EMISSION]
    materials[LAMP]["extensions"] = {
        "KHR_materials_emissive_strength": {"emissiveStrength": EMISSIVE_STRENGTH}
    }
    return {
        "asset": {"version": "2.0", "generator": "lte experiments/guiding/make_scenes.py"},
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{"name": f"guiding_{name}", "nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "cameras": [{
            "name": "camera", "type": "perspective",
            "perspective": {"yfov": 1.0, "aspectRatio": 4 / 3, "znear": 0.01}
        }],
        "accessors": glb.accessors,
        "bufferViews": glb.views,
        "buffers": [{"byteLength": len(glb.binary)}],
    }, bytes(glb.binary)


def write_glb(path, text, binary):
    text = json.dumps(text, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(
        struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(binary), len(text), b"JSON") +
        text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def main():
    default = pathlib.Path(__file__).resolve().parents[2] / "assets" / "scenes"
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=default,
                        help="folder (default: assets/scenes of this checkout)")
    arguments = parser.parse_args()
    for name in SCENES:
        path = arguments.out / f"guiding_{name}.glb"
        write_glb(path, *document(name))
        print(f"wrote {path}, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
