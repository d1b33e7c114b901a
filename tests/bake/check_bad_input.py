#!/usr/bin/env python3
"""What lte_bake says of scenes and flags that it cannot bake: one line, exit code 1, and the files
of an earlier bake as they were. And what it bakes all the same, and says so.

usage: tests/bake/check_bad_input.py LTE_BAKE
"""
import base64
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

QUAD = ((0, 0, 0), (0, 0, 2), (2, 0, 2), (2, 0, 0))
CUBE = [((0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)), ((0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)),
        ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), ((0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)),
        ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)), ((1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0))]
LAMP = [{"type": "point", "intensity": 10, "at": (1, 1.5, 1)}]


def write_gltf(path, quads, lights=(), uv1=None, **material):
    """A scene of a mesh a quad; `uv1` for all of them."""
    data, views, accessors, meshes = b"", [], [], []

    def add(values, kind, code, component):
        nonlocal data
        packed = b"".join(struct.pack("<" + code * len(value), *value) for value in values)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        accessor = {"bufferView": len(views) - 1, "componentType": component, "type": kind,
                    "count": len(values)}
        if kind == "VEC3":
            accessor["min"], accessor["max"] = [0, 0, 0], [3, 2, 3]
        accessors.append(accessor)
        data += packed
        return len(accessors) - 1

    for quad in quads:
        attributes = {"POSITION": add(quad, "VEC3", "f", 5126)}
        if uv1 is not None:
            attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"] = add(uv1, "VEC2", "f", 5126)
        indices = add([(0,), (1,), (2,), (0,), (2,), (3,)], "SCALAR", "I", 5125)
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices,
                                       "material": 0}]})
    nodes = [{"mesh": k} for k in range(len(meshes))]
    extensions = {}
    if lights:
        extensions = {"KHR_lights_punctual": {"lights": [
            {"name": f"lamp{k}", **{key: light[key] for key in light if key != "at"}}
            for k, light in enumerate(lights)]}}
        nodes += [{"translation": light["at"], "extensions": {"KHR_lights_punctual": {"light": k}}}
                  for k, light in enumerate(lights)]
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": list(extensions), "extensions": extensions,
        "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "meshes": meshes, "materials": [{"doubleSided": True, **material}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": uri}]}))


def main():
    tool = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene, out = folder / "scene.gltf", folder / "out"

        def bake(*flags, density=8):
            return subprocess.run([tool, str(scene), "--out", str(out), "--quality", "draft",
                                   "--texels-per-metre", str(density), *flags],
                                  capture_output=True, text=True, timeout=300)

        def content():
            return {path.name: path.read_bytes() for path in out.iterdir()}

        def expect(condition, what):
            if not condition:
                sys.exit(f"check_bad_input: {what}")

        def refused(word, *flags, density=8):
            run = bake(*flags, density=density)
            lines = [line for line in run.stderr.splitlines() if "warning" not in line
                     and ("error" in line or word in line)]
            expect(run.returncode == 1 and len(lines) == 1 and word in lines[0],
                   f"expected 1 line with '{word}', got rc {run.returncode}: {run.stderr}")
            expect(content() == kept, f"'{word}' cost an earlier bake")

        write_gltf(scene, [QUAD], LAMP)
        good = bake()
        expect(good.returncode == 0, good.stderr)
        kept = content()

        refused("has no TEXCOORD_1", "--set", "keep_uvs=on")
        refused("more than 16384", density=20000)
        refused("bend goes with --format vertex-colors", "--set", "bend=0.1")
        refused("light map", "--set", "max_memory=200M", density=2000)
        write_gltf(scene, [QUAD, [(x, 1, z) for x, _, z in QUAD]], LAMP,
                   uv1=[(0, 0), (1, 0), (1, 1), (0, 1)])
        refused("overlaps", "--set", "keep_uvs=on")
        write_gltf(scene, [QUAD])
        refused("nothing emits light")
        write_gltf(scene, [[(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]], LAMP)
        refused("area")
        write_gltf(scene, [QUAD], LAMP)
        refused("probes", "--probes", "none")
        write_gltf(scene, [QUAD], [
            {"type": "spot", "intensity": 10, "at": (1, 1, 1),
             "spot": {"innerConeAngle": 0, "outerConeAngle": 0.3}}])
        refused("light reaches no texel")
        write_gltf(scene, [QUAD], [
            {"type": "point", "intensity": 1, "at": (0.0004 * k, 1, 1)} for k in range(5000)])
        for form in ("gltf", "vertex-colors"):
            refused("5000 layers", "--by-light", "--set", "max_memory=200M", "--format", form,
                    density=64)
            refused("--by-light goes with --integrator gather or path", "--by-light",
                    "--integrator", "network", "--format", form)

        # A probe in a block.
        write_gltf(scene, [quad[::-1] for quad in CUBE],
                   [{"type": "point", "intensity": 10, "at": (0.5, 3, 0.5)}], doubleSided=False)
        refused("probes are in walls", "--probes", "1x1x1")

        # A triangle without area has no texels, and a line says so.
        write_gltf(scene, [QUAD, [(0, 1, 0), (1, 1, 0), (2, 1, 0), (3, 1, 0)]], LAMP)
        run = bake()
        expect(run.returncode == 0 and "2 triangles have no area" in run.stderr, run.stderr)
        write_gltf(scene, CUBE, [{"type": "point", "intensity": 10, "at": (0.5, 0.7, 0.5)}],
                   pbrMetallicRoughness={"metallicFactor": 1, "roughnessFactor": 0.5})
        run = bake()
        expect(run.returncode == 0 and "6 of 6 surfaces are metal and were baked as matt"
               in run.stderr, run.stderr)
        kept = content()
        write_gltf(scene, [[(float("nan"), 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)]], LAMP)
        refused("not finite")
        print("check_bad_input: every fault has its line")


main()
