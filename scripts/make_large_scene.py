#!/usr/bin/env python3
"""Writes a .glb with a wavy floor of many triangles, a ceiling light and nothing else: a load test.

usage: scripts/make_large_scene.py OUT.glb [TRIANGLES]        (default 3,000,000; standard library alone)
"""
import array
import json
import math
import struct
import sys


def grid(side):
    """Positions and indices of a height field of side * side * 2 triangles over 10 m."""
    positions, indices = array.array("f"), array.array("I")
    heights = [0.05 * math.sin(0.7 * i) for i in range(side + 1)]
    for z in range(side + 1):
        for x in range(side + 1):
            positions.extend((10 * x / side, heights[x] + heights[z], 10 * z / side))
    for z in range(side):
        for x in range(side):
            a = z * (side + 1) + x
            c = a + side + 1
            indices.extend((a, c, a + 1, a + 1, c, c + 1))
    return positions, indices


def main():
    if not 2 <= len(sys.argv) <= 3:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    side = max(1, math.isqrt(int(sys.argv[2]) // 2 if len(sys.argv) == 3 else 1_500_000))
    floor = grid(side)
    light = (array.array("f", (4, 2.5, 4, 6, 2.5, 4, 6, 2.5, 6, 4, 2.5, 6)), array.array("I", (0, 1, 2, 0, 2, 3)))
    blob, views, accessors, meshes = b"", [], [], []
    for material, (positions, indices) in enumerate((floor, light)):
        for data, target in ((positions, 34962), (indices, 34963)):
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": 4 * len(data), "target": target})
            blob += data.tobytes()
        columns = [positions[axis::3] for axis in range(3)]
        accessors += [
            {"bufferView": len(views) - 2, "componentType": 5126, "count": len(positions) // 3, "type": "VEC3",
             "min": [min(c) for c in columns], "max": [max(c) for c in columns]},
            {"bufferView": len(views) - 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"}]
        meshes.append({"primitives": [{"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1,
                                       "material": material}]})
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0}, {"mesh": 1}],
                "meshes": meshes, "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(blob)}],
                "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.6, 0.6, 1]}},
                              {"emissiveFactor": [1, 1, 1]}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(sys.argv[1], "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob)))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob)
    print(f"{sys.argv[1]}: {2 * side * side + 2} triangles")
    return 0


if __name__ == "__main__":
    sys.exit(main())
