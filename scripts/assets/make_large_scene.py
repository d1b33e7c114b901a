#!/usr/bin/env python3
"""Writes a .glb with a wavy floor of many triangles and a ceiling light: a load test.

The floor is cut into as many strips as there are textures, each with a picture of its own.

usage: scripts/assets/make_large_scene.py OUT.glb [TRIANGLES] [TEXTURES] [SIDE]
       (default 3,000,000 triangles, no textures, of 1024 x 1024 texels; standard library alone)
"""
import array
import json
import math
import random
import struct
import sys
import zlib


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


def uvs(side):
    """Texture coordinates of grid(): once over the whole floor in x and five times in z."""
    out = array.array("f")
    for z in range(side + 1):
        for x in range(side + 1):
            out.extend((x / side, 5 * z / side))
    return out


def png(side, seed):
    """A noisy picture, as scans are: every row is a rotation of one random row, colored by
    `seed`."""
    noise = random.Random(seed).randbytes(3 * side)
    rows = b"".join(
        b"\0" + noise[3 * (7 * y % side):] + noise[:3 * (7 * y % side)] for y in range(side))
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0,
                                    0)), (b"IDAT", zlib.compress(rows, 1)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks)


class Glb:
    """A document under construction and the parts of its one buffer."""
    def __init__(self):
        self.blob, self.size, self.views, self.accessors = [], 0, [], []

    def view(self, data):
        data += b"\0" * (-len(data) % 4)
        self.views.append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self.blob.append(data)
        self.size += len(data)
        return len(self.views) - 1

    def accessor(self, values, kind, width, view=None, first=0, count=None):
        view = self.view(values.tobytes()) if view is None else view
        item = {
            "bufferView": view, "byteOffset": first * 4 * width,
            "componentType": 5126 if values.typecode == "f" else 5125,
            "count": len(values) // width if count is None else count, "type": kind
        }
        if kind == "VEC3":
            columns = [values[axis::3] for axis in range(3)]
            item.update(min=[min(c) for c in columns], max=[max(c) for c in columns])
        self.accessors.append(item)
        return len(self.accessors) - 1

    def write(self, path, document):
        document.update(asset={"version": "2.0"}, bufferViews=self.views, accessors=self.accessors,
                        buffers=[{"byteLength": self.size}])
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as out:
            out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + self.size))
            out.write(
                struct.pack("<I4s", len(text), b"JSON") + text +
                struct.pack("<I4s", self.size, b"BIN\0"))
            out.writelines(self.blob)


def main():
    if not 2 <= len(sys.argv) <= 5:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    triangles, textures, picture = ([int(a) for a in sys.argv[2:]] +
                                    [3_000_000, 0, 1024][len(sys.argv) - 2:])
    side = max(1, math.isqrt(triangles // 2))
    glb = Glb()
    positions, indices = grid(side)
    attributes = {"POSITION": glb.accessor(positions, "VEC3", 3)}
    if textures:
        attributes["TEXCOORD_0"] = glb.accessor(uvs(side), "VEC2", 2)
    order = glb.view(indices.tobytes())
    strips = max(1, min(textures, side))
    cuts = [6 * side * (side * k // strips) for k in range(strips + 1)]
    floor = [{
        "attributes": attributes, "material": 1 + k,
        "indices": glb.accessor(indices, "SCALAR", 1, order, cuts[k], cuts[k + 1] - cuts[k])
    } for k in range(strips)]
    light = (array.array("f", (4, 2.5, 4, 6, 2.5, 4, 6, 2.5, 6, 4, 2.5, 6)),
             array.array("I", (0, 1, 2, 0, 2, 3)))
    lamp = {
        "attributes": {"POSITION": glb.accessor(light[0], "VEC3", 3)},
        "indices": glb.accessor(light[1], "SCALAR", 1), "material": 0
    }
    materials = [{"emissiveFactor": [1, 1, 1]}]
    for k in range(strips):
        color = {"baseColorTexture": {"index": k}
                } if textures else {"baseColorFactor": [0.6, 0.6, 0.6, 1]}
        materials.append({"pbrMetallicRoughness": color})
    document = {
        "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0}, {"mesh": 1}],
        "meshes": [{"primitives": floor}, {"primitives": [lamp]}], "materials": materials
    }
    if textures:
        document["images"] = [{"bufferView": glb.view(png(picture, k)), "mimeType": "image/png"}
                              for k in range(strips)]
        document["textures"] = [{"source": k} for k in range(strips)]
    glb.write(sys.argv[1], document)
    print(f"{sys.argv[1]}: {2 * side * side + 2} triangles, {strips if textures else 0} textures")
    return 0


if __name__ == "__main__":
    sys.exit(main())
