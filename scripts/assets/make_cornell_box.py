#!/usr/bin/env python3
"""Writes assets/scenes/cornell_box.glb and .pbrt: the Cornell box with its measured geometry, in
metres, Y up.

Coordinates: https://www.graphics.cornell.edu/online/box/data.html (millimetres there). Reflectances
and emission are the usual linear RGB renditions of its spectra. The light hangs 0.5 mm under the
ceiling instead of in a hole in it.

--metal makes the blocks and two walls of rough metal (GGX): roughness 0.1, 0.3 and 0.6, and one
half metal.
"""
import argparse
import json
import math
import pathlib
import struct

WHITE, RED, GREEN, LIGHT = range(4)
MATERIALS = [("white", (0.73, 0.73, 0.73)), ("red", (0.63, 0.065, 0.05)),
             ("green", (0.14, 0.45, 0.091)), ("light", (0.78, 0.78, 0.78))]
METALS = {
    "short block": ("gold", (1.0, 0.77, 0.34), 1, 0.3), "tall block":
        ("silver", (0.95, 0.93, 0.88), 1, 0.1), "back wall": ("steel", (0.56, 0.57, 0.58), 1, 0.6),
    "right wall": ("half metal", (0.14, 0.45, 0.091), 0.5, 0.3)
}
EMISSION = (17.0, 12.0, 4.0)
EMISSIVE_STRENGTH = 32.0  # a power of two: factors are then exact
ROOM_CENTRE = (278.0, 274.4, 279.6)
CAMERA = (0.278, 0.273, -0.8)  # metres; looks along +z from 0.8 m before the open side
YFOV = 2 * math.atan(0.0125 / 0.035)  # 35 mm lens, 25 mm film

WALLS = [
    ("floor", WHITE, [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]),
    ("ceiling", WHITE, [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]),
    ("back wall", WHITE, [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2),
                          (556, 548.8, 559.2)]),
    ("right wall", GREEN, [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]),
    ("left wall", RED, [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]),
    ("light", LIGHT, [(343, 548.3, 227), (343, 548.3, 332), (213, 548.3, 332), (213, 548.3, 227)]),
]
BLOCKS = [("short block", 165, [(130, 65), (82, 225), (240, 272), (290, 114)]),
          ("tall block", 330, [(423, 247), (265, 296), (314, 456), (472, 406)])]


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def normal(quad):
    (ax, ay, az), (bx, by, bz) = subtract(quad[1], quad[0]), subtract(quad[2], quad[0])
    return (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


def facing(quad, direction):
    """The quad, wound so that its normal has a positive component along `direction`."""
    return quad if dot(normal(quad), direction) > 0 else quad[::-1]


def surfaces():
    """(name, material, quads) in millimetres: walls face the room's centre, blocks face away from
    their own."""
    for name, material, quad in WALLS:
        yield name, material, [facing(quad, subtract(ROOM_CENTRE, quad[0]))]
    for name, height, corners in BLOCKS:
        centre = (sum(x for x, _ in corners) / 4, height / 2, sum(z for _, z in corners) / 4)
        quads = [[(x, height, z) for x, z in corners]]
        for (x0, z0), (x1, z1) in zip(corners, corners[1:] + corners[:1]):
            quads.append([(x0, 0, z0), (x0, height, z0), (x1, height, z1), (x1, 0, z1)])
        yield name, WHITE, [facing(quad, subtract(quad[0], centre)) for quad in quads]


def materials(metal):
    """(name, color, metallic, roughness), and a function from a surface's name and its usual
    material to the number."""
    table = [(name, color, 0, 1) for name, color in MATERIALS]
    if not metal:
        return table, lambda surface, usual: usual
    number = {surface: len(table) + i for i, surface in enumerate(METALS)}
    return table + list(METALS.values()), lambda surface, usual: number.get(surface, usual)


def gltf_material(name, color, metallic, roughness):
    pbr = {"baseColorFactor": [*color, 1], "metallicFactor": metallic}
    if metallic:
        pbr["roughnessFactor"] = roughness
    return {"name": name, "pbrMetallicRoughness": pbr}


class Glb:
    def __init__(self):
        self.binary = bytearray()
        self.views, self.accessors = [], []

    def add(self, values, kind, code, component_type, **extra):
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.binary), "byteLength": 4 * len(values)})
        width = {"VEC3": 3, "SCALAR": 1}[kind]
        self.accessors.append({
            "bufferView": len(self.views) - 1, "componentType": component_type,
            "count": len(values) // width, "type": kind, **extra
        })
        self.binary += struct.pack(f"<{len(values)}{code}", *values)
        return len(self.accessors) - 1

    def add_quads(self, quads):
        points = [tuple(value / 1000 for value in point) for quad in quads for point in quad]
        # min and max must be those of the stored floats
        points = [struct.unpack("<3f", struct.pack("<3f", *point)) for point in points]
        position = self.add([v for p in points for v in p], "VEC3", "f", 5126,
                            min=[min(c) for c in zip(*points)], max=[max(c) for c in zip(*points)])
        indices = self.add([4 * i + k for i in range(len(quads)) for k in (0, 1, 2, 0, 2, 3)],
                           "SCALAR", "I", 5125)
        return position, indices


def document(metal):
    glb = Glb()
    table, number_of = materials(metal)
    meshes, nodes = [], []
    for name, material, quads in surfaces():
        position, indices = glb.add_quads(quads)
        meshes.append({
            "name":
                name, "primitives": [{
                    "attributes": {"POSITION": position}, "indices": indices,
                    "material": number_of(name, material)
                }]
        })
        nodes.append({"name": name, "mesh": len(meshes) - 1})
    # A half turn about y of glTF's -z.
    nodes.append(
        {"name": "camera", "camera": 0, "translation": list(CAMERA), "rotation": [0, 1, 0, 0]})
    gltf_materials = [gltf_material(*entry) for entry in table]
    gltf_materials[LIGHT]["emissiveFactor"] = [value / EMISSIVE_STRENGTH for value in EMISSION]
    gltf_materials[LIGHT]["extensions"] = {
        "KHR_materials_emissive_strength": {"emissiveStrength": EMISSIVE_STRENGTH}
    }
    return {
        "asset": {"version": "2.0", "generator": "lte scripts/assets/make_cornell_box.py"},
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{"name": "cornell_box", "nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": gltf_materials,
        "cameras": [{
            "name": "camera", "type": "perspective",
            "perspective": {"yfov": YFOV, "aspectRatio": 1, "znear": 0.01}
        }],
        "accessors": glb.accessors,
        "bufferViews": glb.views,
        "buffers": [{"byteLength": len(glb.binary)}],
    }, bytes(glb.binary)


def numbers(values):
    """Shortest digits that read back as the same double; no trailing .0."""
    return " ".join(repr(float(value)).removesuffix(".0") for value in values)


def pbrt_materials(name, color, metallic, roughness):
    """Lines of MakeNamedMaterial; a mix of two is named as the whole. pbrt's alpha is the square of
    our roughness."""
    diffuse = f'"string type" "diffuse" "rgb reflectance" [{numbers(color)}]'
    metal = (f'"string type" "conductor" "rgb reflectance" [{numbers(color)}] '
             f'"float roughness" {numbers([roughness ** 2])} "bool remaproughness" false')
    if metallic in (0, 1):
        return [f'MakeNamedMaterial "{name}" {metal if metallic else diffuse}']
    return [
        f'MakeNamedMaterial "{name} 0" {diffuse}', f'MakeNamedMaterial "{name} 1" {metal}',
        f'MakeNamedMaterial "{name}" "string type" "mix" '
        f'"string materials" ["{name} 0" "{name} 1"] '
        f'"float amount" {numbers([metallic])}'
    ]


def pbrt_document(metal):
    """The same scene in PBRT v4. Scale -1 1 1 turns pbrt's left-handed camera into ours."""
    eye = CAMERA
    target = (eye[0], eye[1], eye[2] + 1)
    lines = [
        "# The Cornell box in metres, Y up; written by scripts/assets/make_cornell_box.py.",
        "Scale -1 1 1", f"LookAt {numbers(eye)}  {numbers(target)}  0 1 0",
        f'Camera "perspective" "float fov" {numbers([math.degrees(YFOV)])}',
        'Film "rgb" "integer xresolution" 512 "integer yresolution" 512', "WorldBegin"
    ]
    table, number_of = materials(metal)
    for entry in table:
        lines += pbrt_materials(*entry)
    for name, material, quads in surfaces():
        points = [value / 1000 for quad in quads for point in quad for value in point]
        indices = [4 * i + k for i in range(len(quads)) for k in (0, 1, 2, 0, 2, 3)]
        lines += [
            "", f"# {name}", "AttributeBegin",
            f'  NamedMaterial "{table[number_of(name, material)][0]}"'
        ]
        if material == LIGHT:
            lines.append(f'  AreaLightSource "diffuse" "rgb L" [{numbers(EMISSION)}]')
        lines += [
            f'  Shape "trianglemesh" "point3 P" [{numbers(points)}]',
            f'    "integer indices" [{numbers(indices)}]', "AttributeEnd"
        ]
    return "\n".join(lines) + "\n"


def main():
    default = pathlib.Path(__file__).resolve().parents[2] / "assets" / "scenes" / "cornell_box.glb"
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--out", type=pathlib.Path, default=default,
        help="the .glb, beside which the .pbrt is put; default: assets/scenes/cornell_box.glb")
    parser.add_argument("--metal", action="store_true",
                        help="blocks and two walls of rough metal; needs --out")
    args = parser.parse_args()
    path = args.out
    if args.metal and path == default:
        parser.error("--metal: name another file with --out; the default one is the shipped scene")
    scene, binary = document(args.metal)
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) +
        struct.pack("<I4s", len(text), b"JSON") + text +
        struct.pack("<I4s", len(binary), b"BIN\0") + binary)
    pbrt = path.with_suffix(".pbrt")
    pbrt.write_text(pbrt_document(args.metal))
    for file in (path, pbrt):
        print(f"{file}: {file.stat().st_size} bytes")


if __name__ == "__main__":
    main()
