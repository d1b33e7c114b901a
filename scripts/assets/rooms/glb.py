"""A .glb document in memory: meshes, Lambertian materials, tiny textures, punctual lights, cameras.

Metres, Y up. Positions are rounded to 0.1 mm and pictures are stored, not deflated, so that every
machine writes the same bytes.
"""
import json
import math
import struct
import zlib

STRENGTH = "KHR_materials_emissive_strength"
LIGHTS = "KHR_lights_punctual"


def png(width, height, color_at):
    """An 8-bit RGB picture of sRGB bytes color_at(x, y), in stored blocks."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in color_at(x, y))
                    for y in range(height))
    stored = b"\x78\x01"
    for start in range(0, len(rows), 65535):
        part = rows[start:start + 65535]
        last = start + 65535 >= len(rows)
        stored += struct.pack("<BHH", last, len(part), len(part) ^ 0xFFFF) + part
    stored += struct.pack(">I", zlib.adler32(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in ((b"IHDR", header), (b"IDAT", stored), (b"IEND", b"")))


def looking(eye, target):
    """Quaternion (x, y, z, w) that turns -z towards the target and keeps +y up."""
    d = [t - e for t, e in zip(target, eye)]
    yaw = math.atan2(-d[0], -d[2])
    pitch = math.atan2(d[1], math.hypot(d[0], d[2]))
    cy, sy, cp, sp = (f(a / 2) for a in (yaw, pitch) for f in (math.cos, math.sin))
    return [round(v, 6) for v in (cy * sp, sy * cp, -sy * sp, cy * cp)]


class Document:
    """One scene; its parts are added in order and numbered so."""
    def __init__(self, name, script="make_outside_rooms.py"):
        self.name, self.script, self.blob = name, script, bytearray()
        self.views, self.accessors, self.nodes, self.meshes = [], [], [], []
        self.materials, self.images, self.lights, self.cameras = [], [], [], []
        self.extensions, self.known = set(), {}

    def _view(self, data):
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)})
        self.blob += data + b"\0" * (-len(data) % 4)
        return len(self.views) - 1

    def _floats(self, rows, kind):
        flat = [round(v, 4) + 0.0 for row in rows for v in row]
        data = struct.pack(f"<{len(flat)}f", *flat)
        accessor = {
            "bufferView": self._view(data), "componentType": 5126, "count": len(rows), "type": kind
        }
        if kind == "VEC3":  # the bounds of the stored floats
            stored = list(struct.iter_unpack("<3f", data))
            accessor["min"] = [min(column) for column in zip(*stored)]
            accessor["max"] = [max(column) for column in zip(*stored)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def _indices(self, triangles):
        flat = [corner for triangle in triangles for corner in triangle]
        code, component = ("H", 5123) if max(flat) < 65536 else ("I", 5125)
        data = struct.pack(f"<{len(flat)}{code}", *flat)
        self.accessors.append({
            "bufferView": self._view(data), "componentType": component, "count": len(flat),
            "type": "SCALAR"
        })
        return len(self.accessors) - 1

    def picture(self, width, height, color_at):
        """The number of a texture; color_at gives sRGB bytes."""
        self.images.append({"bufferView": self._view(png(width, height, color_at)),
                            "mimeType": "image/png"})
        return len(self.images) - 1

    def material(self, name, color, texture=None, emission=None, emission_texture=None,
                 double_sided=True):
        """The number of a Lambertian material. Colors are linear albedo, emission is radiance in
        W/(sr m2); textures multiply them."""
        pbr = {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1}
        if texture is not None:
            pbr["baseColorTexture"] = {"index": texture}
        material = {"name": name, "pbrMetallicRoughness": pbr}
        if double_sided:
            material["doubleSided"] = True
        if emission is not None:
            strength = max(1.0, *emission)
            material["emissiveFactor"] = [round(e / strength, 6) for e in emission]
            if strength > 1:
                material["extensions"] = {STRENGTH: {"emissiveStrength": strength}}
                self.extensions.add(STRENGTH)
            if emission_texture is not None:
                material["emissiveTexture"] = {"index": emission_texture}
        self.materials.append(material)
        return len(self.materials) - 1

    def _mesh(self, name, mesh, material):
        """The number of a mesh; one that is there already is shared."""
        key = (material, tuple(mesh.points), tuple(mesh.triangles), tuple(mesh.uvs))
        if key not in self.known:
            attributes = {"POSITION": self._floats(mesh.points, "VEC3")}
            pbr = self.materials[material]
            if "baseColorTexture" in pbr["pbrMetallicRoughness"] or "emissiveTexture" in pbr:
                attributes["TEXCOORD_0"] = self._floats(mesh.uvs, "VEC2")
            self.meshes.append({"name": name, "primitives": [{
                "attributes": attributes, "indices": self._indices(mesh.triangles),
                "material": material
            }]})
            self.known[key] = len(self.meshes) - 1
        return self.known[key]

    def add(self, name, mesh, material, at=(0, 0, 0), turn=0.0):
        """A node with a mesh, turned by degrees about +y and then moved to a place."""
        node = {"name": name, "mesh": self._mesh(name, mesh, material)}
        if any(at):
            node["translation"] = [round(v, 4) for v in at]
        if turn:
            half = math.radians(turn) / 2
            node["rotation"] = [0, round(math.sin(half), 7), 0, round(math.cos(half), 7)]
        self.nodes.append(node)

    def light(self, name, kind, place, intensity, target=None, inner=0.0, outer=0.7):
        """A point or a spot light; intensity in W/sr by channel, angles in radians."""
        strongest = max(intensity)
        light = {"name": name, "type": kind, "intensity": strongest,
                 "color": [round(i / strongest, 6) for i in intensity]}
        node = {"name": name, "translation": list(place),
                "extensions": {LIGHTS: {"light": len(self.lights)}}}
        if kind == "spot":
            light["spot"] = {"innerConeAngle": inner, "outerConeAngle": outer}
            node["rotation"] = looking(place, target)
        self.lights.append(light)
        self.nodes.append(node)
        self.extensions.add(LIGHTS)

    def camera(self, name, eye, target, yfov=0.9):
        self.cameras.append({"name": name, "type": "perspective", "perspective": {
            "yfov": yfov, "aspectRatio": 4 / 3, "znear": 0.01}})
        self.nodes.append({"name": name, "camera": len(self.cameras) - 1,
                           "translation": list(eye), "rotation": looking(eye, target)})

    def bytes(self):
        document = {
            "asset": {"version": "2.0", "generator": f"lte scripts/assets/{self.script}"},
            "scene": 0, "scenes": [{"name": self.name, "nodes": list(range(len(self.nodes)))}],
            "nodes": self.nodes, "meshes": self.meshes, "materials": self.materials,
            "cameras": self.cameras, "accessors": self.accessors, "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.blob)}]
        }
        if self.images:
            document["images"] = self.images
            document["textures"] = [{"source": i} for i in range(len(self.images))]
        if self.lights:
            document["extensions"] = {LIGHTS: {"lights": self.lights}}
        if self.extensions:
            document["extensionsUsed"] = sorted(self.extensions)
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.blob)) +
                struct.pack("<I4s", len(text), b"JSON") + text +
                struct.pack("<I4s", len(self.blob), b"BIN\0") + bytes(self.blob))
