#!/usr/bin/env python3
"""Compares irradiance of `lte_datagen probe` with Mitsuba 3, an independent renderer, on the same
scene and points.

Needs Mitsuba and numpy in a virtual environment of their own, and LLVM's shared library for
Mitsuba's compiler. Mitsuba 3.5.2 runs with LLVM 15, which Debian 12 has (libllvm15); Mitsuba 3.9
aborts with it and wants a newer one. Where LLVM is not found, set DRJIT_LIBLLVM_PATH to its file.

    python3 -m venv mi && mi/bin/pip install mitsuba==3.5.2 'numpy<2'
    mi/bin/python scripts/validation/validate_against_mitsuba.py --datagen build/bin/lte_datagen \\
        assets/scenes/cornell_box.glb

Reads .glb files by itself (the subset that lte writes: one buffer, float attributes, embedded
pictures), draws points evenly over the surfaces, on the front side, and estimates on both sides
with D hits after leaving the point. Mitsuba's
share: direct light by its emitter sampling and hits at the point, balanced, the rest by its `path`
integrator along cosine-distributed rays, without Russian roulette. Metals are described in
mitsuba_metal.py.

The same scene in another format, for our side alone, is named behind a comma: room.glb,room.pbrt.
--environment lights scenes from all around: constant R,G,B or an equirectangular .pfm.

Prints a line a scene: relative bias of the irradiance summed over points, with its standard error;
the bias in standard errors; the bias of direct light alone, whose error the tool does not state;
and of the residuals (difference over standard error of each point and channel) the mean, the
variance and the share below two. --runs takes several independent runs of our side, so that its
errors are known well enough for residuals to be those of a unit normal (expect 0, 1 and 95.4 %).
Exits with 1 if a bias of the total exceeds --max-bias.

--time prints what both take for the same error instead (mitsuba_timing.py); --rays 4096 --samples
4096 do.
"""
import argparse
import csv
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy as np

from mitsuba_metal import register_conductor, surface_bsdf
import mitsuba_timing

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
DTYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WRAPS = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
KNOWN_EXTENSIONS = {
    "KHR_materials_emissive_strength", "KHR_lights_punctual", "KHR_texture_transform"
}


class Glb:
    """A binary glTF file: its JSON, and accessors as arrays."""
    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        magic, version, _ = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or version != 2:
            raise SystemExit(f"{path}: not a binary glTF 2.0 file")
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20:20 + length])
        self.binary = data[20 + length + 8:]
        unknown = set(self.json.get("extensionsUsed", [])) - KNOWN_EXTENSIONS
        if unknown:
            raise SystemExit(f"{path}: extensions this script lacks: {', '.join(sorted(unknown))}")

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.binary[start:start + view["byteLength"]]

    def accessor(self, index):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        dtype, width = np.dtype(DTYPES[a["componentType"]]), COMPONENTS[a["type"]]
        if view.get("byteStride", dtype.itemsize * width) != dtype.itemsize * width:
            raise SystemExit("interleaved vertex attributes are not supported by this script")
        values = np.frombuffer(self.view(a["bufferView"]), dtype, a["count"] * width,
                               a.get("byteOffset", 0))
        return values.reshape(a["count"], width)

    def nodes(self):
        """Yields (node, world matrix) over the default scene."""
        stack = [(n, np.eye(4)) for n in self.json["scenes"][self.json.get("scene", 0)]["nodes"]]
        while stack:
            index, parent = stack.pop()
            node = self.json["nodes"][index]
            world = parent @ local_matrix(node)
            yield node, world
            stack += [(child, world) for child in node.get("children", [])]


def local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    out = np.eye(4)
    out[:3, :3] = rotation * np.array(node.get("scale", [1, 1, 1]), float)
    out[:3, 3] = node.get("translation", [0, 0, 0])
    return out


def middle_of(glb):
    """Of scenes far from the origin; else zero."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for node, world in glb.nodes():
        for primitive in glb.json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            local = glb.accessor(primitive["attributes"]["POSITION"]).astype(float)
            points = local @ world[:3, :3].T + world[:3, 3]
            low, high = np.minimum(low, points.min(0)), np.maximum(high, points.max(0))
    middle = np.round((low + high) / 2)
    return middle if np.abs(middle).max() > 16 * (high - low).max() else np.zeros(3)


def texture_transform(ref):
    return ref.get("extensions", {}).get("KHR_texture_transform", {})


def transformed_uv(uv, ref):
    """KHR_texture_transform: translation * rotation * scale, rotation counter-clockwise with v
    pointing down."""
    t = texture_transform(ref)
    angle = t.get("rotation", 0.0)
    c, s = np.cos(angle), np.sin(angle)
    scaled = uv * np.array(t.get("scale", [1, 1]))
    return scaled @ np.array([[c, -s], [s, c]]) + np.array(t.get("offset", [0, 0]))


class MitsubaScene:
    """Builds the scene for Mitsuba, and keeps the triangles from which points are drawn."""
    def __init__(self, mi, glb, folder, environment="", plain_metal=False):
        self.mi, self.glb, self.folder, self.plain_metal = mi, glb, pathlib.Path(
            folder), plain_metal
        self.parts = {"type": "scene"}
        self.triangles = []
        self.shift = middle_of(glb)  # Mitsuba calculates in floats, and has no frame of its own
        if environment:
            self.parts["environment"] = self.sky(environment)
        for node, world in glb.nodes():
            if "mesh" in node:
                for primitive in glb.json["meshes"][node["mesh"]]["primitives"]:
                    self.add_primitive(primitive, world)
            light = node.get("extensions", {}).get("KHR_lights_punctual")
            if light:
                self.add_light(
                    glb.json["extensions"]["KHR_lights_punctual"]["lights"][light["light"]], world)
        self.triangles = np.concatenate(self.triangles)
        self.scene = mi.load_dict(self.parts)

    def add_light(self, light, world):
        intensity = np.array(light.get("color", [1, 1, 1])) * light.get("intensity", 1.0)
        value = {"type": "rgb", "value": [float(v) for v in intensity]}
        if light["type"] == "point" and "range" not in light:
            part = {
                "type": "point", "position": [float(v) for v in world[:3, 3] - self.shift],
                "intensity": value
            }
        elif light["type"] == "directional":
            direction = -world[:3, 2] / np.linalg.norm(world[:3, 2])
            part = {
                "type": "directional", "direction": [float(v) for v in direction],
                "irradiance": value
            }
        else:
            raise SystemExit(
                f"a {light['type']} light has no exact twin in Mitsuba (spot falloff, range)")
        self.parts[f"light{len(self.parts)}"] = part

    def add_primitive(self, primitive, world):
        attributes = primitive["attributes"]
        local = self.glb.accessor(attributes["POSITION"]).astype(float)
        positions = local @ world[:3, :3].T + (world[:3, 3] - self.shift)
        corners = self.glb.accessor(primitive["indices"]) if "indices" in primitive else np.arange(
            len(local))
        faces = corners.reshape(-1, 3).astype(np.int32)
        if np.linalg.det(world[:3, :3]) < 0:
            faces = faces[:, ::-1]
        self.triangles.append(positions[faces])
        material = self.glb.json["materials"][primitive["material"]]
        pbr = material.get("pbrMetallicRoughness", {})
        base, glow = pbr.get("baseColorTexture"), material.get("emissiveTexture")
        strength = material.get("extensions", {}).get("KHR_materials_emissive_strength",
                                                      {}).get("emissiveStrength", 1.0)
        emission = np.array(material.get("emissiveFactor", [0, 0, 0]), float) * strength
        if base and glow and {k: v for k, v in base.items() if k != "index"
                             } != {k: v for k, v in glow.items() if k != "index"}:
            raise SystemExit(
                "base color and emission with different texture coordinates are not supported")
        ref = base or glow
        uv = None
        uv_index = texture_transform(ref).get('texCoord', ref.get('texCoord', 0)) if ref else 0
        uv_set = f"TEXCOORD_{uv_index}" if ref else ""
        if uv_set in attributes:
            uv = transformed_uv(self.glb.accessor(attributes[uv_set]).astype(float), ref)
        colors = self.glb.accessor(
            attributes["COLOR_0"])[:, :3] if "COLOR_0" in attributes else None
        factor = np.array(pbr.get("baseColorFactor", [1, 1, 1, 1])[:3], float)
        if base and colors is not None and not np.all(colors == 1):
            raise SystemExit(
                "vertex colors that multiply a texture are not supported by this script")
        reflectance = self.color(base, factor, uv)
        if colors is not None and not base:
            reflectance = {"type": "mesh_attribute", "name": "vertex_color"}
            colors = (colors * factor).astype(np.float32)
        shape = {
            "type": "ply", "face_normals": True,
            "bsdf": {"type": "twosided", "bsdf": surface_bsdf(pbr, reflectance, self.plain_metal)}
        }
        if emission.max() > 0:
            shape["emitter"] = {"type": "area", "radiance": self.color(glow, emission, uv)}
            if material.get("doubleSided"
                           ):  # Mitsuba's shine from their fronts: a second one behind the first
                behind = self.offset_back(positions, faces)
                back = {
                    **shape, "filename":
                        str(self.write_ply(behind, faces[:, ::-1], uv, colors, "back"))
                }
                self.parts[f"back{len(self.parts)}"] = back
        shape["filename"] = str(self.write_ply(positions, faces, uv, colors))
        self.parts[f"shape{len(self.parts)}"] = shape

    @staticmethod
    def offset_back(positions, faces):
        """Vertices 0.1 mm behind their faces; flat surfaces alone stay closed."""
        normals = np.zeros_like(positions)
        normal = np.cross(positions[faces[:, 1]] - positions[faces[:, 0]],
                          positions[faces[:, 2]] - positions[faces[:, 0]])
        for k in range(3):
            np.add.at(normals, faces[:, k], normal)
        return positions - 1e-4 * normals / np.linalg.norm(normals, axis=1, keepdims=True)

    def sky(self, text):
        """Constant, or an equirectangular picture whose texels are constant: ours has +X in its
        middle, Mitsuba's -Z at its edge, and interpolates, hence the many texels for one."""
        if len(text.split(",")) == 3:
            return {
                "type": "constant",
                "radiance": {"type": "rgb", "value": [float(v) for v in text.split(",")]}
            }
        mi = self.mi
        texels = np.array(
            mi.Bitmap(text).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32,
                                    srgb_gamma=False))
        texels = np.roll(texels, -texels.shape[1] // 4, axis=1)
        many = max(1, 4096 // texels.shape[1])
        return {"type": "envmap", "bitmap": mi.Bitmap(texels.repeat(many, 0).repeat(many, 1))}

    def color(self, ref, factor, uv):
        """A constant, or the texture decoded to linear and multiplied by the factor."""
        if not ref or uv is None:
            return {"type": "rgb", "value": [float(v) for v in factor]}
        mi, texture = self.mi, self.glb.json["textures"][ref["index"]]
        sampler = self.glb.json["samplers"][texture["sampler"]] if "sampler" in texture else {}
        wraps = {sampler.get(k, 10497) for k in ("wrapS", "wrapT")}
        if len(wraps) != 1:
            raise SystemExit("Mitsuba has one wrap mode for both axes")
        image = self.glb.json["images"][texture["source"]]
        path = self.folder / f"image{texture['source']}.png"
        path.write_bytes(self.glb.view(image["bufferView"]))
        linear = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32,
                                              srgb_gamma=False)
        texels = np.array(linear) * factor.astype(np.float32)
        return {
            "type": "bitmap", "bitmap": mi.Bitmap(texels.astype(np.float32)), "raw": True,
            "wrap_mode": WRAPS[wraps.pop()]
        }

    def write_ply(self, positions, faces, uv, colors, name="mesh"):
        """Binary PLY; Mitsuba takes u, v as texture coordinates and r, g, b as the attribute
        vertex_color."""
        columns, names = [positions], ["x", "y", "z"]
        if uv is not None:
            columns, names = columns + [uv], names + ["u", "v"]
        if colors is not None:
            columns, names = columns + [colors], names + ["r", "g", "b"]
        path = self.folder / f"{name}{len(self.parts)}.ply"
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
        header += "".join(f"property float {name}\n" for name in names)
        header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        rows = np.zeros(len(faces), np.dtype([("n", "u1"), ("i", "<i4", 3)]))
        rows["n"], rows["i"] = 3, faces
        path.write_bytes(header.encode() + np.hstack(columns).astype("<f4").tobytes() +
                         rows.tobytes())
        return path

    def draw_points(self, count, seed):
        """Uniform over the area, less `self.shift`; normals are the fronts'."""
        rng = np.random.default_rng(seed)
        a, b, c = (self.triangles[:, i].astype(float) for i in range(3))
        normals = np.cross(b - a, c - a)
        areas = np.linalg.norm(normals, axis=1)
        chosen = rng.choice(len(areas), count, p=areas / areas.sum())
        u, v = rng.random((2, count, 1))
        flip = u + v > 1
        u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
        positions = a[chosen] * (1 - u - v) + b[chosen] * u + c[chosen] * v
        return positions, normals[chosen] / areas[chosen][:, None]


class Moments:
    """Running mean and variance of the mean over samples, by point and channel."""
    def __init__(self):
        self.count, self.sum, self.squares = 0, 0.0, 0.0

    def add(self, values):  # [points, samples, 3]
        values = values.astype(float)
        self.count += values.shape[1]
        self.sum = self.sum + values.sum(1)
        self.squares = self.squares + (values ** 2).sum(1)

    def mean(self):
        return self.sum / self.count

    def variance(self):
        return np.maximum(self.squares / self.count - self.mean() ** 2, 0) / (self.count - 1)


def mitsuba_irradiance(mi, scene, positions, normals, depth, samples, seed):
    """Moments of (direct, total) irradiance. Total is direct by emitter sampling and hits, plus
    hits 2 to depth."""
    import drjit as dr
    integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 100000})
    per_pass = max(1, min(samples, (1 << 21) // len(positions)))
    direct, total = Moments(), Moments()

    def lanes_of(values, repeats):  # by component: what all versions of Dr.Jit take
        return [mi.Float(np.repeat(column, repeats).astype(np.float32)) for column in values.T]

    for i in range((samples + per_pass - 1) // per_pass):
        lanes = len(positions) * per_pass
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed + i, lanes)
        si = dr.zeros(mi.SurfaceInteraction3f, lanes)
        si.p = mi.Point3f(*lanes_of(positions, per_pass))
        si.n = mi.Normal3f(*lanes_of(normals, per_pass))
        si.sh_frame = mi.Frame3f(si.n)
        ds, weight = scene.sample_emitter_direction(si, sampler.next_2d(), True)
        cosine = dr.dot(ds.d, si.n)
        # Points beside a lamp: light samples alone have no finite variance there, hence the balance
        # heuristic.
        share = dr.select(ds.delta, 1, ds.pdf / (ds.pdf + cosine * dr.inv_pi))
        near = dr.select((ds.pdf > 0) & (cosine > 0), weight * (cosine * share), 0)
        ray = si.spawn_ray(
            si.sh_frame.to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d())))
        first = scene.ray_intersect(ray)
        emitted = first.emitter(scene).eval(first)
        met = mi.DirectionSample3f(scene, first, si)
        light_pdf = scene.pdf_emitter_direction(si, met, dr.neq(first.emitter(scene), None))
        pdf = dr.dot(ray.d, si.n) * dr.inv_pi
        near += dr.pi * emitted * dr.select(pdf > 0, pdf / (pdf + light_pdf), 0)
        radiance, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(ray))
        far = dr.pi * (radiance - emitted)
        shape = (len(positions), per_pass, 3)
        near, far = (np.stack([np.array(c)
                               for c in (v.x, v.y, v.z)], -1).reshape(shape)
                     for v in (near, far))
        direct.add(near)
        total.add(near + far)
    return direct, total


def probe(datagen, scene_path, positions, normals, args, seed):
    """Runs our tool on the points; {"direct", "total", "stderr"} as arrays."""
    with tempfile.TemporaryDirectory() as folder:
        given, result = pathlib.Path(folder) / "in.csv", pathlib.Path(folder) / "out.csv"
        with open(given, "w") as file:
            file.write("px,py,pz,nx,ny,nz\n")
            for row in np.hstack([positions, normals]):
                file.write(",".join(f"{v:.9g}" for v in row) + "\n")
        sky = ["--environment", args.environment] if args.environment else []
        subprocess.run([
            datagen, "probe",
            str(scene_path), "--points",
            str(given), "--out",
            str(result), "--rays",
            str(args.rays), "--max-depth",
            str(args.depth), "--seed",
            str(seed), "--quiet", *sky
        ], check=True)
        with open(result, newline="") as file:
            rows = list(csv.DictReader(file))
    return {
        kind: np.array([[float(row[f"{kind}_{c}"]) for c in "rgb"] for row in rows])
        for kind in ("total", "direct", "stderr")
    }


def probe_runs(datagen, scene_path, positions, normals, args):
    """The mean of independent runs, whose stated variances are averaged too."""
    runs = [
        probe(datagen, scene_path, positions, normals, args, args.seed + k)
        for k in range(args.runs)
    ]
    out = {kind: np.mean([run[kind] for run in runs], 0) for kind in ("total", "direct")}
    out["stderr"] = np.sqrt(np.mean([run["stderr"] ** 2 for run in runs], 0) / args.runs)
    return out


def relative_bias(ours, theirs):
    reference = theirs.mean()
    return (ours - reference).sum() / reference.sum()


def compare(name, ours, total, direct):
    """One line of the table; returns the relative bias. Channels are taken as fully correlated: a
    bound on the error."""
    reference = total.mean()
    bias = relative_bias(ours["total"], total)
    error = np.sqrt(ours["stderr"] ** 2 + total.variance())
    bias_error = np.sqrt((error.sum(1) ** 2).sum()) / reference.sum()
    lit = error > 0
    residual = (ours["total"] - reference)[lit] / error[lit]
    print(
        f"| {name} | {len(error)} | {100 * bias:+.3f} ± {100 * bias_error:.3f} | "
        f"{bias / bias_error:+.1f} | "
        f"{100 * relative_bias(ours['direct'], direct):+.3f} | {residual.mean():+.3f} | "
        f"{residual.var():.3f} | "
        f"{100 * (np.abs(residual) < 2).mean():.1f} |", flush=True)
    return bias


def time_scenes(mi, args):
    """Prints the table of mitsuba_timing.py."""
    mitsuba_timing.print_header()
    for path in map(pathlib.Path, args.scenes):
        with tempfile.TemporaryDirectory() as folder:
            scene = MitsubaScene(mi, Glb(path), folder)
            positions, normals = scene.draw_points(args.points, args.seed)
            mitsuba_timing.compare_times(mi, scene.scene, path, positions, normals, args)
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE.glb[,OURS]")
    parser.add_argument("--environment", default="",
                        help="constant R,G,B or an equirectangular picture, for both sides")
    parser.add_argument("--runs", type=int, default=1, help="independent runs of our side")
    parser.add_argument("--datagen", required=True, help="path of lte_datagen")
    parser.add_argument("--points", type=int, default=256)
    parser.add_argument("--rays", type=int, default=8192, help="our paths a point")
    parser.add_argument("--samples", type=int, default=16384, help="Mitsuba's paths a point")
    parser.add_argument("--depth", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--max-bias", type=float, default=0.005,
                        help="exit with 1 above this relative bias")
    parser.add_argument("--time", action="store_true",
                        help="compare run time at equal error instead")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of both, with --time")
    parser.add_argument("--repeats", type=int, default=8,
                        help="runs of both with seeds of their own, with --time")
    parser.add_argument(
        "--plain-metal", action="store_true", help=
        "metal as Mitsuba's own roughconductor: another masking and no Fresnel, so a bias is "
        "expected"
    )
    args = parser.parse_args()
    try:
        import mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        register_conductor(mi)
    except ImportError as error:
        raise SystemExit(f"Mitsuba is not usable ({error}); see --help for how to install it")
    mi.set_log_level(mi.LogLevel.Error)
    if args.time:
        return time_scenes(mi, args)
    print(
        "| scene | points | bias of total, % | z | bias of direct, % | residuals: mean | variance "
        "| below 2, % |"
    )
    print("|---|---|---|---|---|---|---|---|")
    failed = False
    for name in args.scenes:
        path, _, ours_path = name.partition(",")
        path, ours_path = pathlib.Path(path), ours_path or path
        with tempfile.TemporaryDirectory() as folder:
            scene = MitsubaScene(mi, Glb(path), folder, args.environment, args.plain_metal)
            positions, normals = scene.draw_points(args.points, args.seed)
            ours = probe_runs(args.datagen, ours_path, positions + scene.shift, normals, args)
            direct, total = mitsuba_irradiance(mi, scene.scene, positions, normals, args.depth,
                                               args.samples, args.seed)
        bias = compare(pathlib.Path(ours_path).name, ours, total, direct)
        failed |= abs(bias) > args.max_bias
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
