#!/usr/bin/env python3
"""Compares pictures of surfaces with normal maps with Mitsuba's `normalmap`.

    mi/bin/python scripts/validation/mitsuba_normal_map.py --render build/bin/lte_render

Mitsuba as validate_against_mitsuba.py needs it. A floor whose map is noise lies under a lamp and a
sky, of four kinds: matt beside a red wall, of metal, with mirrored texture coordinates, seen from
behind. lte_render gets it as a .gltf, Mitsuba as the same triangles; both trace paths. Prints a
line a kind: the bias of the picture's mean, and the largest difference of a block of 8 x 8 pixels.
Exits with 1 above --max-bias or --max-block.

Mitsuba shows a matt surface black where the viewer is below the horizon of a shading normal, lte by
its irradiance: the camera looks steeply enough to see none, and paths from the wall meet few.
"""
import argparse
import base64
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from mitsuba_metal import register_conductor

WIDTH, HEIGHT, DEPTH = 64, 48, 4
CAMERA = {"origin": [0.2, 3.0, 1.2], "target": [0.1, 0.0, 0.1], "up": [0, 1, 0], "vfov": 50}
LIGHT, INTENSITY, SKY = [0.8, 1.5, -0.9], 6.0, 0.3
FLOOR = np.array([[-2, 0, 2], [2, 0, 2], [2, 0, -2], [-2, 0, -2]], np.float32)  # front +y
WALL = np.array([[-2, 0, -2], [2, 0, -2], [2, 2, -2], [-2, 2, -2]], np.float32)  # front +z
FLOOR_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
COLOR, RED, ROUGHNESS = [0.8, 0.7, 0.5], [0.7, 0.1, 0.1], 0.5
KINDS = ("matt", "metal", "mirrored", "behind")


def noise():
    """[24, 24, 3] 8-bit codes of directions up to 35 degrees off."""
    rng = np.random.default_rng(3)
    angle, around = np.radians(35) * rng.random((24, 24)) ** 0.5, 2 * np.pi * rng.random((24, 24))
    x, y = np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around)
    xy = 128 + 127.5 * np.stack([x, y], -1)
    z = 127.5 * (1 + np.cos(angle))[..., None]
    return np.clip(np.round(np.concatenate([xy, z], -1)), 0, 255).astype(np.uint8)


def geometry(kind):
    """(positions, uv) of the floor. From behind, it faces down and is seen from its back."""
    floor, uv = FLOOR.copy(), FLOOR_UV.copy()
    if kind == "mirrored":
        uv[:, 0] = 1 - uv[:, 0]
    if kind == "behind":
        floor, uv = floor[::-1].copy(), uv[::-1].copy()
    return floor, uv


def write_gltf(path, kind, png):
    binary, views, accessors = b"", [], []

    def add(array, component, kind_of):
        nonlocal binary
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
        accessors.append({
            "bufferView": len(views) - 1, "componentType": component, "count": len(array),
            "type": kind_of
        })
        if kind_of == "VEC3":
            accessors[-1].update(min=array.min(0).tolist(), max=array.max(0).tolist())
        binary += array.tobytes()
        return len(accessors) - 1

    def uri(kind_of, data):
        return f"data:{kind_of};base64,{base64.b64encode(data).decode()}"

    floor, uv = geometry(kind)
    indices = add(FACES.reshape(-1), 5125, "SCALAR")
    meshes = [{
        "primitives": [{
            "attributes": {
                "POSITION": add(floor, 5126, "VEC3"), "TEXCOORD_0": add(uv, 5126, "VEC2")
            },
            "indices": indices, "material": 0
        }]
    }]
    if kind == "matt":
        meshes.append({
            "primitives": [{
                "attributes": {"POSITION": add(WALL, 5126, "VEC3")}, "indices": indices,
                "material": 1
            }]
        })
    surface = {
        "baseColorFactor": [*COLOR, 1], "metallicFactor": int(kind == "metal"),
        "roughnessFactor": ROUGHNESS
    }
    red = {"baseColorFactor": [*RED, 1], "metallicFactor": 0}
    document = {
        "asset": {"version": "2.0"}, "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes) + 1))}],
        "nodes": [{"mesh": i} for i in range(len(meshes))] + [{
            "translation": LIGHT, "extensions": {"KHR_lights_punctual": {"light": 0}}
        }],
        "meshes": meshes, "bufferViews": views, "accessors": accessors,
        "materials": [{"pbrMetallicRoughness": surface, "normalTexture": {"index": 0}},
                      {"pbrMetallicRoughness": red}],
        "textures": [{"source": 0}], "images": [{"uri": uri("image/png", png)}],
        "buffers": [{
            "byteLength": len(binary), "uri": uri("application/octet-stream", binary)
        }],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {
            "KHR_lights_punctual": {"lights": [{"type": "point", "intensity": INTENSITY}]}
        }
    }
    path.write_text(json.dumps(document))


def lte_picture(mi, render, folder, kind, spp):
    png = folder / "map.png"
    mi.Bitmap(noise()).write(str(png))
    write_gltf(folder / "scene.gltf", kind, png.read_bytes())
    (folder / "camera.json").write_text(json.dumps(CAMERA))
    subprocess.run([
        render, str(folder / "scene.gltf"), "--camera", str(folder / "camera.json"),
        "--environment", f"{SKY},{SKY},{SKY}", "--size", f"{WIDTH}x{HEIGHT}", "--integrator",
        "path", "--spp", str(spp), "--set", "denoise=off", "--set", f"depth={DEPTH - 1}",
        "--out", str(folder / "lte.exr"), "--quiet"
    ], check=True)
    parts = dict(mi.Bitmap(str(folder / "lte.exr")).split())
    return np.array(parts["<root>"].convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))


def mesh(mi, folder, name, positions, uv, bsdf):
    rows = np.hstack([positions, uv]).astype("<f4")
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex 4\n" +
              "".join(f"property float {c}\n" for c in "xyzuv") +
              "element face 2\nproperty list uchar int vertex_indices\nend_header\n")
    faces = np.zeros(2, np.dtype([("n", "u1"), ("i", "<i4", 3)]))
    faces["n"], faces["i"] = 3, FACES
    path = folder / f"{name}.ply"
    path.write_bytes(header.encode() + rows.tobytes() + faces.tobytes())
    return {
        "type": "ply", "filename": str(path), "face_normals": True,
        "bsdf": {"type": "twosided", "bsdf": bsdf}
    }


def mitsuba_picture(mi, folder, kind, spp):
    codes = noise().astype(np.float32)
    texels = np.concatenate([(codes[..., :2] - 128) / 255 + 0.5, codes[..., 2:] / 255], -1)
    if kind == "mirrored":  # Mitsuba's y is n x s whichever way V runs
        texels[..., 1] = 1 - texels[..., 1]
    if kind == "behind":  # `twosided` keeps x and y for the back; there, lte turns the normal over
        texels[..., 0] = 1 - texels[..., 0]
    color = {"type": "rgb", "value": COLOR}
    surface = {"type": "diffuse", "reflectance": color}
    if kind == "metal":
        surface = {
            "type": "lte_conductor", "alpha": ROUGHNESS ** 2,
            **{f"f0_{c}": v for c, v in zip("rgb", COLOR)}
        }
    mapped = {
        "type": "normalmap", "bsdf": surface,
        "normalmap": {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True}
    }
    positions, uv = geometry(kind)
    look = mi.ScalarTransform4f.look_at(CAMERA["origin"], CAMERA["target"], CAMERA["up"])
    scene = {
        "type": "scene", "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": 1000},
        "sensor": {
            "type": "perspective", "fov": CAMERA["vfov"], "fov_axis": "y", "to_world": look,
            "film": {
                "type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}
            }
        },
        "floor": mesh(mi, folder, "floor", positions, uv, mapped),
        "lamp": {
            "type": "point", "position": LIGHT,
            "intensity": {"type": "rgb", "value": [INTENSITY] * 3}
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [SKY] * 3}}
    }
    if kind == "matt":
        red = {"type": "diffuse", "reflectance": {"type": "rgb", "value": RED}}
        scene["wall"] = mesh(mi, folder, "wall", WALL, FLOOR_UV, red)
    return np.array(mi.render(mi.load_dict(scene), spp=spp, seed=5))[..., :3]


def blocks(picture):
    return picture.reshape(HEIGHT // 8, 8, WIDTH // 8, 8, 3).mean((1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--render", required=True, help="path of lte_render")
    parser.add_argument("--spp", type=int, default=1024, help="paths a pixel, of both")
    parser.add_argument("--max-bias", type=float, default=0.005)
    parser.add_argument("--max-block", type=float, default=0.02)
    args = parser.parse_args()
    try:
        import mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        register_conductor(mi)
    except ImportError as error:
        raise SystemExit(f"Mitsuba is not usable ({error}); see --help for how to install it")
    mi.set_log_level(mi.LogLevel.Error)
    print("| floor | bias of the mean, % | largest of a block, % |\n|---|---:|---:|")
    failed = False
    for kind in KINDS:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            ours = lte_picture(mi, args.render, folder, kind, args.spp)
            theirs = mitsuba_picture(mi, folder, kind, args.spp)
        bias = ours.mean() / theirs.mean() - 1
        block = np.abs(blocks(ours) / blocks(theirs) - 1).max()
        print(f"| {kind} | {100 * bias:+.3f} | {100 * block:.2f} |", flush=True)
        failed |= abs(bias) > args.max_bias or block > args.max_block
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
