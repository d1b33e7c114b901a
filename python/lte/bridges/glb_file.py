"""A .glb that lte has written, as its JSON and arrays."""

import json
import pathlib
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
DTYPES: dict[int, Any] = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


class GlbFile:
    """One buffer, and attributes that are not interleaved."""

    def __init__(self, path: pathlib.Path) -> None:
        data = path.read_bytes()
        length, = struct.unpack_from("<I", data, 12)
        self.json: dict[str, Any] = json.loads(data[20:20 + length])
        self._binary = data[20 + length + 8:]

    def view(self, index: int) -> bytes:
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self._binary[start:start + view["byteLength"]]

    def accessor(self, index: int) -> NDArray[Any]:
        made = self.json["accessors"][index]
        width = COMPONENTS[made["type"]]
        values = np.frombuffer(self.view(made["bufferView"]), DTYPES[made["componentType"]],
                               made["count"] * width, made.get("byteOffset", 0))
        return values.reshape(made["count"], width)

    def nodes(self) -> Iterator[tuple[dict[str, Any], NDArray[np.float64]]]:
        """Nodes, which lte writes without children, with their matrix."""
        for index in self.json["scenes"][0]["nodes"]:
            node = self.json["nodes"][index]
            yield node, np.array(node["matrix"], float).reshape(4, 4).T

    def lamps(self) -> list[dict[str, Any]]:
        extension = self.json.get("extensions", {}).get("KHR_lights_punctual", {})
        return list(extension.get("lights", ()))
