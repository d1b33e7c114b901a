"""A .glb in the making: meshes in world coordinates, materials, lamps, a camera."""

import json
import pathlib
import struct
import tempfile
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FLOAT, INDEX, ARRAY_BUFFER, ELEMENT_BUFFER = 5126, 5125, 34962, 34963


class Glb:
    def __init__(self) -> None:
        self._binary = bytearray()
        self._json: dict[str, Any] = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "materials": [], "accessors": [], "bufferViews": [], "textures": [],
            "images": [], "cameras": []}
        self._lights: list[dict[str, Any]] = []

    def material(self, *, color: ArrayLike = (0.5, 0.5, 0.5), metallic: float = 0,
                 roughness: float = 1, emission: ArrayLike = (0, 0, 0),
                 picture: int | None = None, glow: int | None = None,
                 double_sided: bool = False) -> int:
        """The number of a new material; `picture` and `glow` are numbers from picture()."""
        pbr: dict[str, Any] = {"baseColorFactor": [*_numbers(color), 1],
                               "metallicFactor": float(metallic),
                               "roughnessFactor": float(roughness)}
        made: dict[str, Any] = {"pbrMetallicRoughness": pbr, "doubleSided": double_sided}
        if picture is not None:
            pbr["baseColorTexture"] = {"index": picture}
        radiance = np.array(_numbers(emission))
        if radiance.any():
            strength = max(1.0, float(radiance.max()))
            made["emissiveFactor"] = _numbers(radiance / strength)
            made["extensions"] = {
                "KHR_materials_emissive_strength": {"emissiveStrength": strength}}
            if glow is not None:
                made["emissiveTexture"] = {"index": glow}
        return self._add("materials", made)

    def picture(self, file: bytes) -> int:
        """The number of a new texture, of a PNG or JPEG."""
        kind = "png" if file[:4] == b"\x89PNG" else "jpeg"
        image = self._add("images", {"bufferView": self._view(file), "mimeType": f"image/{kind}"})
        return self._add("textures", {"source": image})

    def mesh(self, positions: ArrayLike, triangles: ArrayLike, material: int, *,
             uv: ArrayLike | None = None, name: str = "") -> None:
        """Positions [V, 3] and corners [F, 3], counter-clockwise in front; uv [V, 2], v down."""
        corners = np.ascontiguousarray(triangles, "<u4").reshape(-1)
        if not len(corners):
            return
        at = np.ascontiguousarray(positions, "<f4")
        attributes = {"POSITION": self._accessor(at, "VEC3", FLOAT, ARRAY_BUFFER)}
        if uv is not None:
            attributes["TEXCOORD_0"] = self._accessor(np.ascontiguousarray(uv, "<f4"), "VEC2",
                                                      FLOAT, ARRAY_BUFFER)
        made = self._add("meshes", {"name": name, "primitives": [{
            "attributes": attributes, "material": material,
            "indices": self._accessor(corners, "SCALAR", INDEX, ELEMENT_BUFFER)}]})
        self._node({"mesh": made, "name": name})

    def light(self, kind: str, intensity: ArrayLike, *, at: ArrayLike = (0, 0, 0),
              to: ArrayLike = (0, 0, -1), cones: tuple[float, float] | None = None,
              name: str = "") -> None:
        """A lamp of kind point, spot or directional that shines along `to`; W/sr, or W/m².

        `cones` are the angles of a spot's full and no light, in radians.
        """
        strength = max(1e-30, float(np.max(_numbers(intensity))))
        made: dict[str, Any] = {"type": kind, "name": name, "intensity": strength,
                                "color": _numbers(np.array(_numbers(intensity)) / strength)}
        if cones is not None:
            made["spot"] = {"innerConeAngle": float(cones[0]), "outerConeAngle": float(cones[1])}
        self._lights.append(made)
        self._node({"name": name, "matrix": _looking(at, to), "extensions": {
            "KHR_lights_punctual": {"light": len(self._lights) - 1}}})

    def camera(self, matrix: ArrayLike, vfov: float, *, name: str = "camera") -> None:
        """A camera that looks along -Z of `matrix`, [4, 4]; `vfov` in degrees."""
        made = self._add("cameras", {"type": "perspective", "perspective": {
            "yfov": float(np.radians(vfov)), "znear": 0.01}})
        self._node({"name": name, "camera": made,
                    "matrix": np.array(matrix, float).T.reshape(-1).tolist()})

    def save(self, path: pathlib.Path) -> None:
        made = {key: value for key, value in self._json.items() if value}
        made["buffers"] = [{"byteLength": len(self._binary)}]
        used = ["KHR_materials_emissive_strength"]
        if self._lights:
            made["extensions"] = {"KHR_lights_punctual": {"lights": self._lights}}
            used.append("KHR_lights_punctual")
        made["extensionsUsed"] = used
        text = json.dumps(made).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self._binary)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", len(self._binary), b"BIN\0") + self._binary)

    def load(self, name: str, **options: Any) -> Any:
        """As lte.load() has it, without a file that stays."""
        import lte
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / f"{name}.glb"
            self.save(path)
            return lte.load(path, **options)

    def _add(self, kind: str, made: dict[str, Any]) -> int:
        self._json[kind].append(made)
        return len(self._json[kind]) - 1

    def _node(self, made: dict[str, Any]) -> None:
        self._json["scenes"][0]["nodes"].append(self._add("nodes", made))

    def _view(self, data: bytes, target: int | None = None) -> int:
        start = len(self._binary)
        self._binary += data + bytes(-len(data) % 4)
        view = {"buffer": 0, "byteOffset": start, "byteLength": len(data)}
        return self._add("bufferViews", view if target is None else {**view, "target": target})

    def _accessor(self, values: NDArray[Any], kind: str, component: int, target: int) -> int:
        made: dict[str, Any] = {"bufferView": self._view(values.tobytes(), target),
                                "componentType": component, "count": len(values), "type": kind}
        if kind == "VEC3":
            made["min"], made["max"] = values.min(0).tolist(), values.max(0).tolist()
        return self._add("accessors", made)


def _numbers(values: ArrayLike) -> list[float]:
    return np.broadcast_to(np.asarray(values, float), 3).tolist()  # type: ignore[no-any-return]


def _looking(at: ArrayLike, to: ArrayLike) -> list[float]:
    """The matrix, column by column, of what stands at `at` and looks along -Z to `to`."""
    back = -np.asarray(to, float)
    back /= np.linalg.norm(back)
    side = np.cross((0, 1, 0) if abs(back[1]) < 0.9 else (1, 0, 0), back)
    side /= np.linalg.norm(side)
    columns = [side, np.cross(back, side), back, np.asarray(at, float)]
    return [float(value) for i, column in enumerate(columns) for value in (*column, i == 3)]
