"""Reads float32 tensors of sample files (docs/dataset.md), which are safetensors."""
import array
import json
import struct


def read_floats(path, *names):
    """The numbers of each tensor as a flat array, and its shape."""
    with open(path, "rb") as file:
        size = struct.unpack("<Q", file.read(8))[0]
        header = json.loads(file.read(size))
        out = []
        for name in names:
            begin, end = header[name]["data_offsets"]
            file.seek(8 + size + begin)
            out.append((array.array("f", file.read(end - begin)), header[name]["shape"]))
        return out
