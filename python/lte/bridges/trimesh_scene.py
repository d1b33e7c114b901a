"""Scenes of trimesh, by its own exporter: STL, DAE, 3MF, OFF and what else it reads."""

import json
import pathlib
import struct
import tempfile
from typing import Any


def load(scene: Any, **options: Any) -> Any:
    import lte
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.glb"
        path.write_bytes(_matt(scene.export(file_type="glb")))
        return lte.load(path, **options)


def _matt(data: bytes) -> bytes:
    """The .glb with metal only where it is stated: by default glTF's surfaces are white metal."""
    length, = struct.unpack_from("<I", data, 12)
    made = json.loads(data[20:20 + length])
    materials = made.setdefault("materials", [])
    for material in materials:
        pbr = material.setdefault("pbrMetallicRoughness", {})
        if "metallicRoughnessTexture" not in pbr:
            pbr.setdefault("metallicFactor", 0)
    for mesh in made.get("meshes", []):
        for primitive in mesh["primitives"]:
            primitive.setdefault("material", len(materials))
    materials.append({"pbrMetallicRoughness": {"metallicFactor": 0}})
    text = json.dumps(made).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    return (struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
            + text + rest)
