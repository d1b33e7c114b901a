#!/usr/bin/env python3
"""scripts/assets/sum_light_groups.py: light groups of a scene written by hand become one."""
import json
import math
import pathlib
import struct
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "assets"))
sys.dont_write_bytecode = True
import sum_light_groups  # noqa: E402


def scene(path):
    """Two groups at one point, whose front has 3 and 1 of the light, with errors of 0.5 and 1."""
    tensors = {"direct": ("F32", [2, 1, 3], struct.pack("<6f", 1, 2, 3, 10, 20, 30)),
               "scene_indirect": ("F32", [2, 1, 3], struct.pack("<6f", 4, 4, 4, 1, 1, 1)),
               "scene_indirect_back": ("F32", [2, 1, 3], struct.pack("<6f", 1, 1, 1, 0, 0, 0)),
               "scene_error": ("F16", [2, 1], struct.pack("<2e", 0.5, 1)),
               "scene_error_back": ("F16", [2, 1], struct.pack("<2e", 0.25, 0)),
               "scene_light": ("I32", [2], struct.pack("<2i", -1, 1)),
               "scene_area": ("F32", [1], struct.pack("<f", 7))}
    header, at, body = {"__metadata__": {"name": "s", "lte_checksum": "00"}}, 0, b""
    for name, (dtype, shape, raw) in tensors.items():
        header[name] = {"dtype": dtype, "shape": shape, "data_offsets": [at, at + len(raw)]}
        at, body = at + len(raw), body + raw
    text = json.dumps(header).encode()
    path.write_bytes(struct.pack("<Q", len(text)) + text + body)


class SumLightGroups(unittest.TestCase):
    def test_light_adds_and_errors_add_in_squares(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "s.safetensors"
            scene(path)
            sum_light_groups.sum_scene(path)
            header, data = sum_light_groups.read(path)
            self.assertEqual(header["direct"]["shape"], [1, 1, 3])
            self.assertEqual(struct.unpack("<3f", data["direct"]), (11, 22, 33))
            self.assertEqual(struct.unpack("<3f", data["scene_indirect"]), (5, 5, 5))
            error, = struct.unpack("<e", data["scene_error"])
            self.assertAlmostEqual(error, math.hypot(0.5 * 3, 1 * 1) / 4, delta=1e-3)
            self.assertEqual(struct.unpack("<e", data["scene_error_back"]), (0.25,))
            self.assertEqual(struct.unpack("<2i", data["scene_light"]), (-1, 0))
            self.assertEqual(struct.unpack("<f", data["scene_area"]), (7,))
            self.assertNotIn("lte_checksum", header["__metadata__"])
            before = path.read_bytes()
            sum_light_groups.sum_scene(path)
            self.assertEqual(path.read_bytes(), before, "one group stays as it is")


if __name__ == "__main__":
    unittest.main()
