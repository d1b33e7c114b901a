#!/usr/bin/env python3
"""Writes a .glb that is wrong, careless or unusual in every way that files of other people are, yet
has one right picture.

For docs/validation.md: triangles without area, repeated and flipped ones, normals that are missing,
turned around or not unit, mirrored, sheared and unevenly scaled instances, deep nodes, surfaces 2
mm apart, several sets of texture coordinates with transforms, vertex colors, one-byte, two-byte and
four-byte indices and none at all, a light that shines on both sides, meshes, materials and textures
that nothing uses, and all of it 500 m from the origin. Deterministic; standard library alone.

usage: scripts/assets/make_messy_scene.py OUT.glb
"""
import json
import math
import random
import struct
import sys
import zlib

FAR = (400.0, 25.0, -300.0)  # metres: a float there is good to 0.03 mm


def png(side, seed):
    """Colored squares with noise."""
    noise = random.Random(seed)
    rows = []
    for y in range(side):
        row = bytearray(b"\0")
        for x in range(side):
            check = (x * 4 // side + y * 4 // side) % 2
            base = (200, 120, 60) if check else (60, 130, 200)
            row.extend(min(255, max(0, c + noise.randrange(-25, 26))) for c in base)
        rows.append(bytes(row))
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0,
                                    0)), (b"IDAT", zlib.compress(b"".join(rows),
                                                                 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks)


class Mesh:
    """Quads and triangles that share no vertices."""
    def __init__(self):
        self.positions, self.uvs, self.triangles = [], [], []

    def quad(self, corner, edge1, edge2, cells=1, flip=0):
        """A parallelogram of cells x cells; its front is on the side of edge1 x edge2. Every
        `flip`-th triangle is turned."""
        for i in range(cells):
            for j in range(cells):
                first = len(self.positions)
                for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                    u, v = u / cells, v / cells
                    self.positions.append(
                        tuple(corner[k] + u * edge1[k] + v * edge2[k] for k in range(3)))
                    self.uvs.append((u, v))
                for triangle in ((first, first + 1, first + 2), (first, first + 2, first + 3)):
                    turned = flip and len(self.triangles) % flip == 0
                    self.triangles.append(triangle[::-1] if turned else triangle)

    def box(self, low, high, inwards=False):
        e = [high[k] - low[k] for k in range(3)]
        x, y, z = (e[0], 0, 0), (0, e[1], 0), (0, 0, e[2])
        add = (lambda c, a, b: self.quad(c, a, b)) if inwards else (
            lambda c, a, b: self.quad(c, b, a))
        plus = lambda d: tuple(low[k] + d[k] for k in range(3))
        for a, b, c in ((y, z, x), (z, x, y), (x, y, z)):
            add(low, a, b)
            add(plus(c), b, a)

    def spoil(self):
        """Triangles that cover nothing: a corner twice, three in a line, all in one point; and one
        that is there twice."""
        a, b, _ = self.triangles[0]
        self.triangles += [(a, a, b), (b, b, b)]
        p, q = self.positions[a], self.positions[b]
        self.positions.append(tuple((p[k] + q[k]) / 2 for k in range(3)))
        self.uvs.append((0, 0))
        self.triangles += [(a, len(self.positions) - 1, b), self.triangles[-3], self.triangles[1]]


class Document:
    def __init__(self):
        self.blob, self.views, self.accessors = bytearray(), [], []
        self.meshes, self.nodes, self.materials = [], [], []

    def view(self, data):
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)})
        self.blob += data + b"\0" * (-len(data) % 4)
        return len(self.views) - 1

    def accessor(self, rows, kind, code, component):
        flat = [v for row in rows for v in (row if isinstance(row, tuple) else (row,))]
        accessor = {
            "bufferView": self.view(struct.pack(f"<{len(flat)}{code}", *flat)),
            "componentType": component, "count": len(rows), "type": kind
        }
        if kind == "VEC3" and code == "f":
            accessor["min"] = [min(r[k] for r in rows) for k in range(3)]
            accessor["max"] = [max(r[k] for r in rows) for k in range(3)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def material(self, name, color, **more):
        self.materials.append({
            "name": name, "pbrMetallicRoughness": {
                "baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1,
                **more.pop("pbr", {})
            }, **more
        })
        return len(self.materials) - 1

    def mesh(self, name, mesh, material, index="B", normals=None, uv_sets=(0,), colors=False):
        """@param index  B, H or I for indices of that size, None for a list of corners
        @param normals  None, "turned" or "long": they must not matter"""
        positions, uvs = mesh.positions, mesh.uvs
        if index is None:
            corners = [c for t in mesh.triangles for c in t]
            positions, uvs = [positions[c] for c in corners], [uvs[c] for c in corners]
        attributes = {"POSITION": self.accessor(positions, "VEC3", "f", 5126)}
        if normals:
            n = (0.0, -1.0, 0.0) if normals == "turned" else (3.0, 4.0, 0.0)
            attributes["NORMAL"] = self.accessor([n] * len(positions), "VEC3", "f", 5126)
        for uv_set in range(max(uv_sets, default=-1) + 1):
            used = uv_set in uv_sets
            rows = [tuple(map(float, uv)) if used else (9.0 * uv[1], -7.0 * uv[0]) for uv in uvs]
            attributes[f"TEXCOORD_{uv_set}"] = self.accessor(rows, "VEC2", "f", 5126)
        if colors:
            rows = [(0.3 + 0.6 * uv[0], 0.8 - 0.5 * uv[1], 0.2 + 0.5 * uv[0] * uv[1]) for uv in uvs]
            attributes["COLOR_0"] = self.accessor(rows, "VEC3", "f", 5126)
        primitive = {"attributes": attributes, "material": material}
        if index is not None:
            code = {"B": 5121, "H": 5123, "I": 5125}[index]
            primitive["indices"] = self.accessor([c for t in mesh.triangles for c in t], "SCALAR",
                                                 index, code)
        self.meshes.append({"name": name, "primitives": [primitive]})
        return len(self.meshes) - 1

    def node(self, **node):
        self.nodes.append(node)
        return len(self.nodes) - 1


def sheared(shift, scale, shear):
    """Column-major matrix of a shear of x by y, an uneven scale and a shift."""
    return [scale[0], 0, 0, 0, shear * scale[1], scale[1], 0, 0, 0, 0, scale[2], 0, *shift, 1]


def build(doc):
    textured = lambda name, uv_set, transform: doc.material(
        name, (0.9, 0.85, 0.8), pbr={
            "baseColorTexture": {
                "index": 0, "texCoord": 0,
                "extensions": {"KHR_texture_transform": {"texCoord": uv_set, **transform}}
            }
        })
    white = doc.material("white", (0.75, 0.75, 0.72))
    walls = textured("papered", 1, {"offset": [0.3, -0.2], "scale": [3, 2], "rotation": 0.4})
    crate = textured("crate", 2, {"scale": [-1, 1.5]})
    stained = doc.material("stained", (0.9, 0.9, 0.9))
    grey = doc.material("grey", (0.5, 0.5, 0.5), doubleSided=True)
    lamp = doc.material("lamp", (0.3, 0.3, 0.3), emissiveFactor=[1.0, 0.85, 0.6],
                        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 14.0}})
    screen = doc.material("screen", (0.1, 0.1, 0.1), emissiveFactor=[0.4, 0.6,
                                                                     1.0], doubleSided=True,
                          extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 6.0}})
    doc.material("unused", (1, 0, 0), pbr={"baseColorTexture": {"index": 1}})

    shell = Mesh()  # 5 x 2.6 x 4 m, papered, every seventh triangle turned around
    for corner, a, b in (((0, 0, 0), (0, 2.6, 0), (0, 0, 4)), ((5, 0, 0), (0, 0, 4), (0, 2.6, 0)),
                         ((0, 0, 0), (5, 0, 0), (0, 2.6, 0)), ((0, 0, 4), (0, 2.6, 0), (5, 0, 0))):
        shell.quad(corner, a, b, cells=5, flip=7)
    shell.spoil()
    level = Mesh()  # floor and ceiling, no triangle shares a vertex
    level.quad((0, 0, 0), (0, 0, 4), (5, 0, 0), cells=3)
    level.quad((0, 2.6, 0), (5, 0, 0), (0, 0, 4), cells=3)
    level.spoil()
    poster = Mesh()  # 2 mm before the wall x = 0
    poster.quad((0.002, 0.8, 1.2), (0, 1.2, 0), (0, 0, 1.6), cells=2)
    rug = Mesh()  # 2 mm over the floor, its front down
    rug.quad((1.5, 0.002, 1.0), (1.8, 0, 0), (0, 0, 1.4), cells=2)
    box = Mesh()
    box.box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    box.spoil()
    panel = Mesh()
    panel.quad((-0.5, 0, -0.5), (1, 0, 0), (0, 0, 1))  # front down

    root = [
        doc.node(name="shell", mesh=doc.mesh("shell", shell, walls, "H", "turned", (1,))),
        doc.node(name="level", mesh=doc.mesh("level", level, white, None, None, ())),
        doc.node(name="poster", mesh=doc.mesh("poster", poster, stained, "B", "long", (),
                                              colors=True)),
        doc.node(name="rug", mesh=doc.mesh("rug", rug, grey, "I", "turned", ())),
    ]
    cube = doc.mesh("cube", box, crate, "B", "long", (2,))
    plain = doc.mesh("plain cube", box, stained, "H", None, (0,), colors=True)
    light = doc.mesh("lamp", panel, lamp, "B", None, ())
    pane = doc.mesh("screen", panel, screen, None, None, ())
    root += [
        doc.node(name="mirrored", mesh=cube, translation=[1.0, 0.45, 0.9], scale=[-0.7, 0.9, 0.5],
                 rotation=[0, math.sin(0.3), 0, math.cos(0.3)]),
        doc.node(name="sheared", mesh=plain, matrix=sheared((3.8, 0.6, 1.0), (0.6, 1.2, 0.9),
                                                            0.35)),
        doc.node(name="inside out", mesh=plain, matrix=sheared((3.9, 0.3, 3.1), (0.7, -0.6, 0.8),
                                                               -0.2)),
        doc.node(name="sunk into the floor", mesh=cube, translation=[2.4, 0.1, 3.3],
                 scale=[0.8, 0.7, 0.6]),
        doc.node(name="lamp", mesh=light, translation=[2.6, 2.55, 1.8], scale=[0.9, 1, 0.5]),
        doc.node(name="mirrored lamp", mesh=light, translation=[0.8, 2.5, 3.2],
                 scale=[-0.3, 1, 0.3]),
        doc.node(name="screen", mesh=pane, translation=[3.0, 1.2, 2.2],
                 rotation=[0, 0, math.sin(0.7), math.cos(0.7)], scale=[0.6, 1, 0.8]),
    ]
    for depth in range(12):  # a long way up
        root = [
            doc.node(name=f"group {depth}", children=root,
                     translation=[FAR[k] / 12 for k in range(3)])
        ]
    doc.mesh("unused", box, grey, "I", "turned", (0,))
    doc.node(name="unused", mesh=cube)
    return root


def main():
    doc = Document()
    root = build(doc)
    images = [{"bufferView": doc.view(png(side, seed)), "mimeType": "image/png"}
              for side, seed in ((64, 1), (16, 2))]
    head = {
        "asset": {"version": "2.0", "generator": "make_messy_scene.py"
                 }, "scene": 0, "scenes": [{"nodes": root}], "nodes": doc.nodes,
        "meshes": doc.meshes, "materials": doc.materials, "accessors": doc.accessors,
        "bufferViews": doc.views, "images": images, "samplers": [{"wrapS": 10497, "wrapT": 10497}],
        "textures": [{"source": 0, "sampler": 0},
                     {"source": 1}], "buffers": [{"byteLength": len(doc.blob)}],
        "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_texture_transform"]
    }
    text = json.dumps(head, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(sys.argv[1], "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(doc.blob)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(doc.blob), b"BIN\0") + bytes(doc.blob))


if __name__ == "__main__":
    main()
