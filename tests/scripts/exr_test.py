#!/usr/bin/env python3
"""scripts/witnesses/exr.py: reads what lte_render writes.

usage: tests/scripts/exr_test.py BUILD
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "witnesses"))
sys.dont_write_bytecode = True
import exr  # noqa: E402

BUILD = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else ROOT / "build"


class Layers(unittest.TestCase):
    def test_of_a_picture(self):
        with tempfile.TemporaryDirectory() as name:
            picture = pathlib.Path(name) / "box.exr"
            scene = ROOT / "assets/scenes/cornell_box.glb"
            subprocess.run([BUILD / "bin/lte_render", scene, "--quiet", "--mode", "reference",
                            "--output", "normal", "--size", "20x17", "--out", picture], check=True)
            width, height, layers = exr.read_exr(picture)
            self.assertEqual((width, height), (20, 17))
            lengths = [sum(v * v for v in normal) for normal in layers["normal"]]
            self.assertTrue(all(abs(v - 1) < 1e-4 or v == 0 for v in lengths))
            self.assertGreater(sum(lengths), 100)
            self.assertEqual(len(layers["depth"]), 20 * 17)


if __name__ == "__main__":
    unittest.main()
