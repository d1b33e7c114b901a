"""A scene of lte's as the dict that mitsuba.load_dict() takes, for any RGB variant."""

import pathlib
import tempfile
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lte.bridges.glb_file import GlbFile
from lte.bridges.mitsuba_scene import spot_share

WRAPS = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
BEHIND = 1e-4  #: metres between the two sides of what shines from both
SKY = 4096  #: columns of a sky at least: Mitsuba interpolates between texels, lte does not


#: Of a glTF material's numbers, its color for Mitsuba, and its name: a BSDF.
Surface = Callable[[dict[str, Any], dict[str, Any], str], dict[str, Any]]


def export(scene: Any, surface: Surface | None = None, shift: Any = (0, 0, 0)) -> dict[str, Any]:
    """What lies at `shift` comes to lie at the origin."""
    import mitsuba as mi
    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    if not mi.variant().endswith("_rgb"):
        raise ValueError(f"variant: expected one of RGB, got {mi.variant()}")
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.glb"
        scene.save(path)
        export = _Export(mi, GlbFile(path), pathlib.Path(folder), surface or _surface)
        return export.run(scene, np.asarray(shift, np.float64))


def _rgb(value: Any) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(v) for v in value]}


def _surface(pbr: dict[str, Any], color: dict[str, Any], name: str) -> dict[str, Any]:
    """Of metal, Mitsuba's principled has Schlick's Fresnel as lte, and another masking."""
    matt = {"type": "diffuse", "reflectance": color}
    metallic = float(pbr["metallicFactor"])
    if metallic == 0:
        return matt
    if "metallicRoughnessTexture" in pbr:
        warnings.warn(f"{name}: the picture of its roughness is left out", stacklevel=2)
    metal = {"type": "principled", "base_color": color, "metallic": 1.0,
             "roughness": float(pbr["roughnessFactor"])}
    if metallic == 1:
        return metal
    return {"type": "blendbsdf", "weight": metallic, "bsdf_0": matt, "bsdf_1": metal}


class _Export:
    def __init__(self, mi: Any, glb: GlbFile, folder: pathlib.Path, surface: Surface) -> None:
        self.mi, self.glb, self.folder, self.surface = mi, glb, folder, surface
        self.parts: dict[str, Any] = {"type": "scene"}
        self.pictures: dict[int, NDArray[np.float32]] = {}

    def run(self, scene: Any, shift: NDArray[np.float64]) -> dict[str, Any]:
        for number, (node, world) in enumerate(self.glb.nodes()):
            world[:3, 3] -= shift
            extension = node.get("extensions", {}).get("KHR_lights_punctual")
            if "mesh" in node:
                primitive, = self.glb.json["meshes"][node["mesh"]]["primitives"]
                self._shape(primitive, world, f"shape{number}")
            elif extension:
                self._lamp(self.glb.lamps()[extension["light"]], world, f"lamp{number}")
            elif "camera" in node:
                lens = self.glb.json["cameras"][node["camera"]]["perspective"]
                self.parts[f"camera{number}"] = self._camera(lens, world)
        sky = scene._made.sky()
        if sky is not None:
            self.parts["sky"] = self._sky(*sky)
        return self.parts

    def _shape(self, primitive: dict[str, Any], world: NDArray[np.float64], name: str) -> None:
        attributes = primitive["attributes"]
        at = self.glb.accessor(attributes["POSITION"]) @ world[:3, :3].T + world[:3, 3]
        faces = self.glb.accessor(primitive["indices"]).reshape(-1, 3)
        if np.linalg.det(world[:3, :3]) < 0:
            faces = faces[:, ::-1]
        material = self.glb.json["materials"][primitive["material"]]
        pbr, strength = material["pbrMetallicRoughness"], material.get("extensions", {}).get(
            "KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        if "normalTexture" in material:
            warnings.warn(f"{material['name']}: its normal map is left out", stacklevel=2)
        base, glow = pbr.get("baseColorTexture"), material.get("emissiveTexture")
        factor = np.array(pbr["baseColorFactor"][:3])
        emission = np.array(material.get("emissiveFactor", [0, 0, 0])) * strength
        uv = self._uv(attributes, base or glow)
        colors = None
        if "COLOR_0" in attributes:
            colors = self.glb.accessor(attributes["COLOR_0"])[:, :3] * factor
        color = self._color(base, factor, uv)
        if colors is not None and base is None:
            color = {"type": "mesh_attribute", "name": "vertex_color"}
        elif colors is not None and not np.allclose(colors, factor):
            warnings.warn(f"{material['name']}: colors of vertices are left out", stacklevel=2)
        made: dict[str, Any] = {"type": "ply", "face_normals": True, "bsdf": {
            "type": "twosided", "bsdf": self.surface(pbr, color, material["name"])}}
        if emission.any():
            if base and glow and _place(base) != _place(glow):
                warnings.warn(f"{material['name']}: the picture of its light is left out",
                              stacklevel=2)
                glow = None
            made["emitter"] = {"type": "area", "radiance": self._color(glow, emission, uv)}
            if material.get("doubleSided"):  # Mitsuba's shine from the front: another one behind
                back = self._ply(_behind(at, faces), faces[:, ::-1], uv, colors)
                self.parts[f"{name}_back"] = self.mi.load_dict({**made, "filename": back})
        self.parts[name] = self.mi.load_dict(
            {**made, "filename": self._ply(at, faces, uv, colors)})

    def _uv(self, attributes: dict[str, int],
            reference: dict[str, Any] | None) -> NDArray[np.float64] | None:
        if reference is None:
            return None
        turn = reference.get("extensions", {}).get("KHR_texture_transform", {})
        attribute = f"TEXCOORD_{turn.get('texCoord', reference.get('texCoord', 0))}"
        if attribute not in attributes:
            return None
        scaled = self.glb.accessor(attributes[attribute]) * np.array(turn.get("scale", [1, 1]))
        c, s = np.cos(turn.get("rotation", 0.0)), np.sin(turn.get("rotation", 0.0))
        out: NDArray[np.float64] = scaled @ np.array([[c, -s], [s, c]]) + np.array(
            turn.get("offset", [0, 0]))
        return out

    def _color(self, reference: dict[str, Any] | None, factor: NDArray[np.float64],
               uv: NDArray[np.float64] | None) -> dict[str, Any]:
        if reference is None or uv is None:
            return _rgb(factor)
        texture = self.glb.json["textures"][reference["index"]]
        sampler = self.glb.json["samplers"][texture["sampler"]]
        if sampler["wrapS"] != sampler["wrapT"]:
            warnings.warn("a picture that repeats along one axis alone repeats along both",
                          stacklevel=2)
        texels = self._texels(texture["source"]) * factor.astype(np.float32)
        return {"type": "bitmap", "bitmap": self.mi.Bitmap(texels), "raw": True,
                "wrap_mode": WRAPS[sampler["wrapS"]]}

    def _texels(self, image: int) -> NDArray[np.float32]:
        """Linear."""
        mi = self.mi
        if image not in self.pictures:
            path = self.folder / "picture.png"
            path.write_bytes(self.glb.view(self.glb.json["images"][image]["bufferView"]))
            self.pictures[image] = np.array(mi.Bitmap(str(path)).convert(
                mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))
        return self.pictures[image]

    def _lamp(self, light: dict[str, Any], world: NDArray[np.float64], name: str) -> None:
        value = np.array(light.get("color", [1, 1, 1])) * light["intensity"]
        if "range" in light:
            warnings.warn(f"{light['name']}: its range is left out", stacklevel=2)
        at, to = world[:3, 3], -world[:3, 2]
        made: dict[str, Any]
        if light["type"] == "point":
            made = {"type": "point", "position": at.tolist(), "intensity": _rgb(value)}
        elif light["type"] == "directional":
            made = {"type": "directional", "direction": to.tolist(), "irradiance": _rgb(value)}
        else:
            full, none = light["spot"]["innerConeAngle"], light["spot"]["outerConeAngle"]
            up = world[:3, 1]
            made = {"type": "spot", "intensity": _rgb(value / spot_share(full, none)),
                    "beam_width": float(np.degrees(full)), "cutoff_angle": float(np.degrees(none)),
                    "to_world": self.mi.ScalarTransform4f.look_at(
                        at.tolist(), (at + to).tolist(), up.tolist())}
        self.parts[name] = made

    def _camera(self, lens: dict[str, Any], world: NDArray[np.float64]) -> dict[str, Any]:
        turned = world @ np.diag([-1.0, 1, -1, 1])
        return {"type": "perspective", "fov": float(np.degrees(lens["yfov"])), "fov_axis": "y",
                "to_world": self.mi.ScalarTransform4f(turned.tolist())}

    def _sky(self, texels: NDArray[np.float32], axes: NDArray[np.float32]) -> dict[str, Any]:
        """lte's picture has +X in its middle, Mitsuba's -Z at its edge."""
        if texels.shape[:2] == (1, 1):
            return {"type": "constant", "radiance": _rgb(texels[0, 0])}
        many = max(1, SKY // texels.shape[1])
        finer = texels.repeat(many, 0).repeat(many, 1)
        turned = np.roll(finer, -round(finer.shape[1] / 4), axis=1)
        place = np.eye(4)
        place[:3, :3] = axes.T
        return {"type": "envmap", "bitmap": self.mi.Bitmap(turned),
                "to_world": self.mi.ScalarTransform4f(place.tolist())}

    def _ply(self, at: NDArray[Any], faces: NDArray[Any], uv: NDArray[Any] | None,
             colors: NDArray[Any] | None) -> str:
        """Binary; Mitsuba takes u, v for the picture and r, g, b for the attribute vertex_color."""
        columns, names = [at], ["x", "y", "z"]
        if uv is not None:
            columns, names = [*columns, uv], [*names, "u", "v"]
        if colors is not None:
            columns, names = [*columns, colors], [*names, "r", "g", "b"]
        rows = np.zeros(len(faces), np.dtype([("count", "u1"), ("corner", "<i4", 3)]))
        rows["count"], rows["corner"] = 3, faces
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(at)}",
                  *(f"property float {name}" for name in names), f"element face {len(faces)}",
                  "property list uchar int vertex_indices", "end_header", ""]
        path = self.folder / "mesh.ply"
        path.write_bytes("\n".join(header).encode() + np.hstack(columns).astype("<f4").tobytes()
                         + rows.tobytes())
        return str(path)


def _place(reference: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in reference.items() if key != "index"}


def _behind(at: NDArray[Any], faces: NDArray[Any]) -> NDArray[Any]:
    a, b, c = (at[faces[:, k]] for k in range(3))
    normal, normals = np.cross(b - a, c - a), np.zeros_like(at)
    for k in range(3):
        np.add.at(normals, faces[:, k], normal)
    length = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    out: NDArray[Any] = at - BEHIND * normals / length
    return out
