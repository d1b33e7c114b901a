"""Scene files of nori, Mitsuba, RenderFormer and Tungsten as .glb: Lambertian surfaces, area lights
and the camera. What is metal or glass there becomes matt, of albedo 0.8 or its own color."""
import json
import math
import posixpath
import re
import xml.etree.ElementTree as xml

from rooms.glb import Document
from rooms.shapes import Mesh, box, sphere

from .matrices import (IDENTITY, Z_UP, apply, moved, product, rotation, scaling, translation)

MATT = (0.8, 0.8, 0.8)


class Unread(Exception):
    """One line that names what a file has and this does not know."""


def obj_mesh(text):
    mesh = Mesh()
    for line in text.decode(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            mesh.points.append(tuple(float(w) for w in words[1:4]))
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) for w in words[1:]]
            corners = [c - 1 if c > 0 else len(mesh.points) + c for c in corners]
            mesh.triangles += [(corners[0], corners[i], corners[i + 1])
                               for i in range(1, len(corners) - 1)]
    mesh.uvs = [(0.0, 0.0)] * len(mesh.points)
    return mesh


def numbers(text):
    return [float(v) for v in re.split(r"[\s,]+", text.strip())]


def add(doc, name, mesh, albedo, radiance=None, double_sided=False):
    material = doc.material(name, tuple(round(v, 6) for v in albedo), emission=radiance,
                            double_sided=double_sided)
    doc.add(name, mesh, material)


# ---- nori and Mitsuba ----


def color(node):
    """Of <rgb>, <color> or <spectrum>; a sampled one by its means over three bands."""
    value = node.get("value")
    if ":" not in value:
        parts = numbers(value)
        return parts * 3 if len(parts) == 1 else parts
    samples = [tuple(map(float, pair.split(":"))) for pair in value.split(",")]

    def at(wavelength):
        for (w0, v0), (w1, v1) in zip(samples, samples[1:]):
            if w0 <= wavelength <= w1:
                return v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0)
        return samples[0][1] if wavelength < samples[0][0] else samples[-1][1]

    bands = ((580, 660), (500, 570), (420, 490))
    return [sum(at(low + i * (high - low) / 8) for i in range(9)) / 9 for low, high in bands]


def xyz(node, default):
    if node.get("value") is not None:
        parts = numbers(node.get("value"))
        return parts * 3 if len(parts) == 1 else parts
    return [float(node.get(axis, default)) for axis in "xyz"]


def transform(node):
    """The product of a <transform>'s steps, the last one outermost."""
    out = IDENTITY
    for step in node if node is not None else ():
        if step.tag == "translate":
            m = translation(*xyz(step, 0))
        elif step.tag == "scale":
            m = scaling(*xyz(step, 1))
        elif step.tag == "rotate":
            axis = numbers(step.get("axis")) if step.get("axis") else xyz(step, 0)
            m = rotation(axis, float(step.get("angle")))
        elif step.tag == "matrix":
            v = numbers(step.get("value"))
            m = tuple(tuple(v[4 * i:4 * i + 4]) for i in range(4))
        else:
            raise Unread(f"transform <{step.tag}>")
        out = product(m, out)
    return out


def albedo_of(node):
    if node is None or node.get("type") in ("conductor", "dielectric", "mirror", "microfacet"):
        return MATT
    if node.get("type") == "twosided":
        return albedo_of(node.find("bsdf"))
    found = [child for child in node if child.get("name") in ("albedo", "reflectance", "kd",
                                                              "diffuse_reflectance")]
    return color(found[0]) if found else (0.5, 0.5, 0.5)


def shape_mesh(node, read):
    kind = node.get("type")
    if kind == "obj":
        named = [child for child in node if child.get("name") == "filename"]
        return obj_mesh(read(named[0].get("value")))
    if kind == "sphere":
        center = [child for child in node if child.get("name") == "center"]
        radius = [child for child in node if child.get("name") == "radius"]
        return sphere(float(radius[0].get("value")) if radius else 1.0,
                      xyz(center[0], 0) if center else (0, 0, 0), 32)
    if kind == "cube":
        return box((-1, -1, -1), (1, 1, 1))
    if kind == "rectangle":
        return Mesh().face([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    raise Unread(f"shape of type {kind}")


def xml_camera(doc, root, scale):
    sensor = root.find("sensor") if root.find("sensor") is not None else root.find("camera")
    look = sensor.find("transform/lookat")
    value = lambda name, default: next(
        (child.get("value") for child in sensor.iter() if child.get("name") == name), default)
    fov = math.radians(float(value("fov", "40")))
    if root.find("camera") is not None:  # nori's angle is that of the width
        fov = 2 * math.atan(math.tan(fov / 2) * float(value("height", "1")) /
                            float(value("width", "1")))
    eye, target = ([scale * v for v in numbers(look.get(end))] for end in ("origin", "target"))
    doc.camera("camera", eye, target, round(fov, 6))


def from_xml(name, path, read, scale):
    root = xml.fromstring(read(path))
    beside = lambda file: read(posixpath.join(posixpath.dirname(path), file))
    doc = Document(name, "get_outside_scenes.py")
    bsdfs = {node.get("id"): node for node in root.findall("bsdf")}
    xml_camera(doc, root, scale)
    for i, node in enumerate(n for n in root if n.tag in ("shape", "mesh")):
        bsdf = node.find("bsdf")
        if bsdf is None and node.find("ref") is not None:
            bsdf = bsdfs.get(node.find("ref").get("id"))
        m = product(scaling(scale, scale, scale), transform(node.find("transform")))
        emitter = node.find("emitter")
        radiance = None
        if emitter is not None:
            radiance = color(next(c for c in emitter if c.get("name") == "radiance"))
        add(doc, node.get("id") or f"shape {i}", moved(shape_mesh(node, beside), m),
            albedo_of(bsdf), radiance)
    return doc


# ---- RenderFormer ----


def from_renderformer(name, path, read, scale):
    """z up there; lamps shine on both sides; an object that only reflects like a mirror is as
    bright here, but matt."""
    scene = json.loads(read(path))
    doc = Document(name, "get_outside_scenes.py")
    world = product(scaling(scale, scale, scale), Z_UP)
    for key, entry in scene["objects"].items():
        mesh = obj_mesh(read(posixpath.join(posixpath.dirname(path), entry["mesh_path"])))
        move = entry["transform"]
        if move.get("normalize"):
            center = [sum(p[k] for p in mesh.points) / len(mesh.points) for k in range(3)]
            mesh = mesh.moved(*(-c for c in center))
            size = 2 * max(math.hypot(*p) for p in mesh.points)
            mesh = mesh.scaled(1 / size, 1 / size, 1 / size)
        turns = [rotation(axis, angle) for axis, angle in
                 zip(((1, 0, 0), (0, 1, 0), (0, 0, 1)), move["rotation"])]
        m = product(world, translation(*move["translation"]), scaling(*move["scale"]),
                    turns[2], turns[1], turns[0])
        look = entry["material"]
        albedo = [min(0.95, d + s) for d, s in zip(look["diffuse"], look["specular"])]
        glow = look["emissive"] if max(look["emissive"]) > 0 else None
        add(doc, key, moved(mesh, m), albedo, glow, True)
    for i, view in enumerate(scene["cameras"]):
        doc.camera(f"camera {i}", apply(world, view["position"]), apply(world, view["look_at"]),
                   round(math.radians(view["fov"]), 6))
    return doc


# ---- Tungsten ----


def from_tungsten(name, path, read, scale):
    scene = json.loads(read(path))
    doc = Document(name, "get_outside_scenes.py")
    albedos = {bsdf["name"]: bsdf["albedo"] for bsdf in scene["bsdfs"]}
    for entry in scene["primitives"]:
        move = entry["transform"]
        size = move.get("scale", 1)
        x, y, z = move.get("rotation", (0, 0, 0))
        m = product(scaling(scale, scale, scale), translation(*move.get("position", (0, 0, 0))),
                    rotation((0, 1, 0), y), rotation((1, 0, 0), x), rotation((0, 0, 1), z),
                    scaling(*(size if isinstance(size, list) else [size] * 3)))
        if entry["type"] == "quad":
            mesh = Mesh().face([(-0.5, 0, -0.5), (-0.5, 0, 0.5), (0.5, 0, 0.5), (0.5, 0, -0.5)])
        elif entry["type"] == "cube":
            mesh = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
        else:
            raise Unread(f"primitive of type {entry['type']}")
        albedo = albedos[entry["bsdf"]]
        add(doc, entry["name"], moved(mesh, m),
            albedo if isinstance(albedo, list) else [min(0.8, albedo)] * 3, entry.get("emission"))
    camera = scene["camera"]
    width, height = camera["resolution"]
    fov = 2 * math.atan(math.tan(math.radians(camera["fov"]) / 2) * height / width)
    eye, target = ([scale * v for v in camera["transform"][end]]
                   for end in ("position", "look_at"))
    doc.camera("camera", eye, target, round(fov, 6))
    return doc
