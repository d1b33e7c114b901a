"""Writes surfaces, lamps, panes and a camera as one .glb, its meshes by Draco. In the file y is
up."""
import json
import math
import struct

import cv2
import DracoPy
import numpy as np

JPEG_QUALITY = 85
POSITION_BITS, UV_BITS = 16, 14  # a step of 0.1 mm in a wall of 7 m
BYTE, UINT, FLOAT = 5121, 5125, 5126
DRACO = "KHR_draco_mesh_compression"
DRACO_KINDS = {0: "POSITION", 2: "COLOR_0", 3: "TEXCOORD_0"}  # GeometryAttribute::Type
Y_UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], np.float64)


def blackbody(kelvin):
    """Linear sRGB of luminance 1, by the cubic fit of Kim et al. to the Planckian locus."""
    t = 1e3 / kelvin
    x = (-0.2661239 * t**3 - 0.2343589 * t**2 + 0.8776956 * t + 0.179910 if kelvin < 4000 else
         -3.0258469 * t**3 + 2.1070379 * t**2 + 0.2226347 * t + 0.240390)
    y = (-0.9549476 * x**3 - 1.37418593 * x**2 + 2.09137015 * x - 0.16748867 if kelvin < 4000 else
         3.0817580 * x**3 - 5.87338670 * x**2 + 3.75112997 * x - 0.37001483)
    to_rgb = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                       [0.0556434, -0.2040259, 1.0572252]])
    return np.maximum(to_rgb @ np.array([x / y, 1, (1 - x - y) / y]), 0)


def sphere(radius):
    """(positions, triangles) of a globe wound outwards: 16 meridians, 7 circles, two poles."""
    columns, rows = 16, 8
    positions, triangles = [(0, 0, radius)], []
    for i in range(1, rows):
        for j in range(columns):
            theta, phi = math.pi * i / rows, 2 * math.pi * j / columns
            positions.append((radius * math.sin(theta) * math.cos(phi),
                              radius * math.sin(theta) * math.sin(phi), radius * math.cos(theta)))
    positions.append((0, 0, -radius))
    at = lambda i, j: 1 + (i - 1) * columns + j % columns
    for j in range(columns):
        triangles.append((0, at(1, j), at(1, j + 1)))
        triangles.append((len(positions) - 1, at(rows - 1, j + 1), at(rows - 1, j)))
        for i in range(1, rows - 1):
            triangles.append((at(i, j), at(i + 1, j), at(i + 1, j + 1)))
            triangles.append((at(i, j), at(i + 1, j + 1), at(i, j + 1)))
    return np.array(positions), np.array(triangles)


def area(positions, triangles):
    p = positions[triangles]
    return 0.5 * np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum()


class Glb:
    def __init__(self, extras):
        self.binary = bytearray()
        self.json = {
            "extensionsUsed": [DRACO, "KHR_materials_emissive_strength"],
            "extensionsRequired": [DRACO],
            "asset": {"version": "2.0", "generator": "lte make_rooms.py", "extras": extras},
            "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [],
            "accessors": [], "bufferViews": [], "cameras": []}
        self.flat = {}

    def add(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def add_node(self, node):
        self.json["scenes"][0]["nodes"].append(self.add("nodes", node))

    def view(self, data, **extra):
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **extra}
        self.binary.extend(data)
        return self.add("bufferViews", view)

    def accessor(self, component, kind, count, **extra):
        return self.add("accessors", {"componentType": component, "type": kind, "count": count,
                                      **extra})

    def primitive(self, positions, triangles, material, uvs=None, tints=None):
        """Of KHR_draco_mesh_compression: accessors have a type and a count, and no bytes."""
        more = {}
        if uvs is not None:
            flipped = np.stack([uvs[:, 0], 1 - uvs[:, 1]], 1)
            more.update(tex_coord=np.clip(flipped, 0, 1).astype(np.float64),
                        tex_coord_quantization_bits=UV_BITS)
        if tints is not None:
            rgba = np.concatenate([tints, np.ones((len(tints), 1))], 1)
            more["colors"] = np.round(np.clip(rgba, 0, 1) * 255).astype(np.uint8)
        data = DracoPy.encode(positions.astype(np.float32), triangles.astype(np.uint32),
                              quantization_bits=POSITION_BITS, compression_level=7, **more)
        mesh = DracoPy.decode(data)
        points, count = np.asarray(mesh.points), len(mesh.points)
        attributes = {"POSITION": self.accessor(FLOAT, "VEC3", count, min=points.min(0).tolist(),
                                                max=points.max(0).tolist())}
        if uvs is not None:
            attributes["TEXCOORD_0"] = self.accessor(FLOAT, "VEC2", count)
        if tints is not None:
            attributes["COLOR_0"] = self.accessor(BYTE, "VEC4", count, normalized=True)
        ids = {DRACO_KINDS[a["attribute_type"]]: a["unique_id"] for a in mesh.attributes}
        packed = {"bufferView": self.view(data), "attributes": {k: ids[k] for k in attributes}}
        indices = self.accessor(UINT, "SCALAR", np.asarray(mesh.faces).size)
        return {"attributes": attributes, "indices": indices, "material": material,
                "extensions": {DRACO: packed}}

    def material(self, color, **extra):
        """A matt material, seen from both sides; equal ones are shared."""
        factor = [round(float(c), 3) for c in color] + [1]
        key = json.dumps([factor, extra])
        if key not in self.flat:
            self.flat[key] = self.add("materials", {
                "pbrMetallicRoughness": {"baseColorFactor": factor, "metallicFactor": 0,
                                         "roughnessFactor": 1, **extra}, "doubleSided": True})
        return self.flat[key]

    def texture(self, image):
        """image: [H, W, 3] sRGB in [0, 1], bottom row first."""
        pixels = np.round(image[::-1, :, ::-1] * 255).astype(np.uint8)
        done, data = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
        assert done
        source = self.add("images", {"bufferView": self.view(data.tobytes()),
                                     "mimeType": "image/jpeg"})
        return self.add("textures", {"source": source})

    def add_object(self, name, surfaces, matrix):
        """matrix: [4, 4] of the object in Blender's frame; it is applied."""
        primitives, textures = [], {}
        for s in surfaces:
            positions = (s.positions @ matrix[:3, :3].T + matrix[:3, 3]) @ Y_UP.T
            triangles = s.triangles if np.linalg.det(matrix[:3, :3]) > 0 else s.triangles[:, ::-1]
            if s.image is not None:
                if id(s.image) not in textures:
                    textures[id(s.image)] = self.texture(s.image)
                material = self.material([1, 1, 1],
                                         baseColorTexture={"index": textures[id(s.image)]})
                primitives.append(self.primitive(positions, triangles, material, uvs=s.uvs))
            elif s.tints is not None:
                top = np.maximum(s.tints.max(0), 1e-3)
                primitives.append(self.primitive(positions, triangles, self.material(top),
                                                 tints=s.tints / top))
            else:
                primitives.append(self.primitive(positions, triangles, self.material(s.color)))
        mesh = self.add("meshes", {"name": name, "primitives": primitives})
        self.add_node({"name": name, "mesh": mesh})

    def add_emitter(self, name, positions, triangles, light):
        """light: linear radiance in W/(m² sr)."""
        strength = float(np.max(light))
        material = self.add("materials", {
            "name": name, "emissiveFactor": [round(float(c), 4) for c in light / strength],
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
            "extensions": {"KHR_materials_emissive_strength": {
                "emissiveStrength": round(strength, 3)}}})
        primitive = self.primitive(positions @ Y_UP.T, triangles, material)
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def add_lamp(self, name, center, radius, watts, kelvin):
        """A sphere of a point light's radius and power: L = watts / (pi area)."""
        positions, triangles = sphere(radius)
        light = watts / (math.pi * area(positions, triangles)) * blackbody(kelvin)
        mesh = self.add_emitter(name, positions, triangles, light)
        self.add_node({"name": name, "mesh": mesh, "translation": (Y_UP @ center).tolist()})

    def add_pane(self, name, positions, triangles, radiance, kelvin):
        """Shines to the side that its triangles are wound for."""
        self.add_node({"name": name, "mesh": self.add_emitter(
            name, positions, triangles, radiance * blackbody(kelvin))})

    def add_camera(self, eye, yaw, pitch, yfov):
        camera = self.add("cameras", {"type": "perspective", "name": "camera", "perspective": {
            "yfov": yfov, "aspectRatio": 4 / 3, "znear": 0.02}})
        # A glTF camera looks along -z: turned about y by yaw - 90 degrees, then about x by pitch.
        a, b = (yaw - math.pi / 2) / 2, pitch / 2
        rotation = [math.cos(a) * math.sin(b), math.sin(a) * math.cos(b),
                    -math.sin(a) * math.sin(b), math.cos(a) * math.cos(b)]
        self.add_node({"name": "camera", "camera": camera, "rotation": rotation,
                       "translation": (Y_UP @ eye).tolist()})

    def save(self, path):
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        whole = 12 + 8 + len(text) + 8 + len(self.binary)
        part = path.with_suffix(".part")
        part.write_bytes(struct.pack("<4sII", b"glTF", 2, whole) +
                         struct.pack("<I4s", len(text), b"JSON") + text +
                         struct.pack("<I4s", len(self.binary), b"BIN\0") + bytes(self.binary))
        part.replace(path)
