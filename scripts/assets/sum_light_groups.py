#!/usr/bin/env python3
"""Makes one light group of all groups of baked scenes, so that their files are smaller.

Light is linear, so at the gains that a data set is evaluated with nothing changes but rounding.
assets/data/homes-test is `lte_datagen generate --config configs/data/homes_test.yaml` after this.
Errors of estimates add as lte/data/light_groups.h has it. Standard library alone.

usage: scripts/assets/sum_light_groups.py SCENE.safetensors ...     (each is replaced)
"""
import array
import json
import math
import os
import pathlib
import re
import struct
import sys

GROUPED = re.compile(r"(scene_)?(direct|indirect)(_back)?|view\d+_(direct|indirect)")


def read(path):
    """The header, and each tensor's bytes."""
    raw = path.read_bytes()
    size, = struct.unpack_from("<Q", raw)
    header = json.loads(raw[8:8 + size])
    return header, {name: raw[8 + size + entry["data_offsets"][0]:
                              8 + size + entry["data_offsets"][1]]
                    for name, entry in header.items() if name != "__metadata__"}


def write(path, header, data):
    """Replaces the file at once. Widest values come first, so that all are aligned."""
    width = {"F32": 4, "I32": 4, "F16": 2, "U8": 1}
    names = sorted(data, key=lambda name: (-width[header[name]["dtype"]], name))
    at = 0
    for name in names:
        header[name]["data_offsets"] = [at, at + len(data[name])]
        at += len(data[name])
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    part = path.with_suffix(".part")
    part.write_bytes(struct.pack("<Q", len(text)) + text + b"".join(data[n] for n in names))
    os.replace(part, path)


def floats(raw):
    return array.array("f", raw)


def error_of_sum(error, light, groups):
    """Of the sum over the groups, relative, as half precision."""
    count = len(error) // groups
    out = []
    for i in range(count):
        mean = variance = 0.0
        for g in range(groups):
            at = g * count + i
            grey = sum(light[3 * at:3 * at + 3]) / 3
            mean += grey
            variance += (error[at] * grey) ** 2
        out.append(min(1.0, math.sqrt(variance) / mean) if mean > 0 else 0.0)
    return struct.pack(f"<{count}e", *out)


def sum_groups(raw, groups):
    """In float32 from group to group, as lte adds them."""
    values = floats(raw)
    count = len(values) // groups
    out = values[:count]
    for g in range(1, groups):
        for i in range(count):
            out[i] += values[g * count + i]
    return out.tobytes()


def sum_scene(path):
    header, data = read(path)
    groups = header["direct"]["shape"][0]
    if groups == 1:
        return
    if "scene_error" in data:
        indirect, back = floats(data["scene_indirect"]), floats(data["scene_indirect_back"])
        front = array.array("f", (a - b for a, b in zip(indirect, back)))
        for name, light in (("scene_error", front), ("scene_error_back", back)):
            error = struct.unpack(f"<{len(data[name]) // 2}e", data[name])
            data[name] = error_of_sum(error, light, groups)
            header[name]["shape"][0] = 1
    for name in filter(GROUPED.fullmatch, data):
        data[name] = sum_groups(data[name], groups)
        header[name]["shape"][0] = 1
    lights = array.array("i", data["scene_light"])
    data["scene_light"] = array.array("i", (min(light, 0) for light in lights)).tobytes()
    header["__metadata__"].pop("lte_checksum", None)
    write(path, header, data)


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__.strip())
        return 0 if len(sys.argv) > 1 else 2
    for name in sys.argv[1:]:
        try:
            sum_scene(pathlib.Path(name))
        except (OSError, ValueError, KeyError, struct.error) as error:
            print(f"sum_light_groups.py: {name}: not a baked scene ({error})", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
