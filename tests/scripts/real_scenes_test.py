#!/usr/bin/env python3
"""scripts/witnesses/real_scenes.py: its figures on pictures made by hand, which files it takes for
scenes, and a folder with a lit scene, a dark one and a broken one.

usage: tests/scripts/real_scenes_test.py BUILD
"""
import contextlib
import io
import json
import pathlib
import shutil
import sys
import tempfile
import unittest
import zlib
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "witnesses"))
sys.dont_write_bytecode = True
import exr  # noqa: E402
import real_scenes  # noqa: E402

BUILD = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else ROOT / "build"
QUAD = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 4 3 2 1\n"  # front upwards, without a light


def run(*arguments, flags=()):
    output = io.StringIO()
    argv = ["real_scenes.py", *map(str, arguments), "--build", str(BUILD), *flags]
    with mock.patch.object(sys, "argv", argv), contextlib.redirect_stdout(output):
        real_scenes.main()
    return output.getvalue()


class Figures(unittest.TestCase):
    def test_of_equal_pictures(self):
        picture = [(i, 2 * i, 1) for i in range(12)]
        found = real_scenes.compare(picture, picture, 4, 3)
        self.assertEqual(found, {"ratio": 1, "rmse": 0, "block_rmse": 0})

    def test_of_a_brighter_picture(self):
        found = real_scenes.compare([(3, 3, 3)] * 64, [(2, 2, 2)] * 64, 8, 8)
        self.assertAlmostEqual(found["ratio"], 1.5)
        self.assertAlmostEqual(found["rmse"], 0.5)
        self.assertAlmostEqual(found["block_rmse"], 0.5)

    def test_blocks_leave_noise_out(self):
        noisy = [(1 + (-1)**x, ) * 3 for _ in range(8) for x in range(16)]
        found = real_scenes.compare(noisy, [(1, 1, 1)] * 128, 16, 8)
        self.assertAlmostEqual(found["rmse"], 1)
        self.assertAlmostEqual(found["block_rmse"], 0)

    def test_of_a_black_reference(self):
        found = real_scenes.compare([(1, 1, 1)], [(0, 0, 0)], 1, 1)
        self.assertEqual(found, {"ratio": None, "rmse": None, "block_rmse": None})

    def test_the_worst_comes_first(self):
        record = lambda error, block: {"error": error, "block_rmse": block}
        records = [record("", 0.1), record("", None), record("", 0.5), record("broken", None)]
        records.sort(key=real_scenes.badness)
        self.assertEqual([r["block_rmse"] for r in records], [None, 0.5, 0.1, None])
        self.assertEqual(records[0]["error"], "broken")


class Lines(unittest.TestCase):
    def test_warnings_and_what_was_traced(self):
        text = ("room.glb: 12 triangles\nroom.glb: 1 directional light, but the model was trained "
                "without any: indirect light is path-traced, 64 paths a pixel\nwarning: dark\n")
        self.assertEqual(real_scenes.warnings_of(text), ["dark"])
        self.assertEqual(len(real_scenes.traced_of(text)), 1)
        self.assertIn("directional", real_scenes.traced_of(text)[0])


class Files(unittest.TestCase):
    def test_parts_of_scenes_are_left_out(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "mesh").mkdir()
            shape = 'Shape "plymesh" "string filename" "mesh/a.ply"'
            (folder / "scene.pbrt").write_text("WorldBegin\n" + shape)
            (folder / "materials.pbrt").write_text('Material "diffuse"')
            for file in ("mesh/a.ply", "mesh/b.PLY", "c.txt"):
                (folder / file).write_text("")
            scenes, parts = real_scenes.scenes_in(folder)
            self.assertEqual([s.name for s in scenes], ["b.PLY", "scene.pbrt"])
            self.assertEqual(parts, 2)

    def test_png_holds_its_bytes(self):
        data = exr.png(bytes(range(18)), 3, 2)
        at = data.index(b"IDAT")
        size = int.from_bytes(data[at - 4:at], "big")
        rows = zlib.decompress(data[at + 4:at + 4 + size])
        self.assertEqual(rows, b"\0" + bytes(range(9)) + b"\0" + bytes(range(9, 18)))


class Scenes(unittest.TestCase):
    def test_of_every_kind(self):
        with tempfile.TemporaryDirectory() as name:
            folder, out = pathlib.Path(name) / "scenes", pathlib.Path(name) / "out"
            folder.mkdir()
            shutil.copy(ROOT / "assets/scenes/cornell_box.glb", folder / "box.glb")
            (folder / "dark.obj").write_text(QUAD)
            (folder / "broken.gltf").write_text("{")
            arguments = (folder, "--out", out, "--size", "24x18", "--spp", "32")
            self.assertNotIn("(kept)", run(*arguments))
            results = json.loads((out / "results.json").read_text())
            found = {r["scene"]: r for r in results["scenes"]}
            self.assertEqual(results["scenes"][0]["scene"], "broken.gltf")
            self.assertIn("broken.gltf", found["broken.gltf"]["error"])
            # At this size the lamp is a few pixels, whose edges rule the mean.
            self.assertTrue(0.5 < found["box.glb"]["ratio"] < 2, found["box.glb"]["ratio"])
            indirect = found["box.glb"]["indirect"]
            self.assertTrue(0.8 < indirect["ratio"] < 1.25, indirect["ratio"])
            self.assertGreater(indirect["rmse"], indirect["block_rmse"])
            self.assertIn(f"indirect light {indirect['ratio']:.3f}, ",
                          (out / "index.html").read_text())
            self.assertEqual(found["box.glb"]["added"], "")
            self.assertGreater(found["box.glb"]["network"]["peak_mb"], 10)
            self.assertTrue(found["dark.obj"]["added"].startswith("--"))
            self.assertIsNotNone(found["dark.obj"]["ratio"])
            page = (out / "index.html").read_text()
            self.assertEqual(page.count("data:image/png"), 4)
            self.assertNotIn("src=\"http", page)
            self.assertLess(page.index("broken.gltf"), page.index("box.glb"))
            self.assertEqual(run(*arguments).count("(kept)"), 3)
            self.assertNotIn("(kept)", run(*arguments[:-1], "8"))
            run(*arguments, flags=("--", "--environment", "0,9,0"))
            results = json.loads((out / "results.json").read_text())
            under_sky = {r["scene"]: r for r in results["scenes"]}["box.glb"]
            self.assertEqual(under_sky["error"], "")
            self.assertNotEqual(under_sky["indirect"]["ratio"], indirect["ratio"])

    def test_layers_of_a_picture(self):
        with tempfile.TemporaryDirectory() as name:
            picture = pathlib.Path(name) / "box.exr"
            scene = ROOT / "assets/scenes/cornell_box.glb"
            done = real_scenes.run([
                str(BUILD / "bin/lte_render"), str(scene), "--mode", "reference", "--output",
                "normal", "--size", "20x17", "--out", str(picture)
            ], 60)
            self.assertEqual(done["rc"], 0, done["stderr"])
            width, height, layers = exr.read_exr(picture)
            self.assertEqual((width, height), (20, 17))
            lengths = [sum(v * v for v in normal) for normal in layers["normal"]]
            self.assertTrue(all(abs(v - 1) < 1e-4 or v == 0 for v in lengths))
            self.assertGreater(sum(lengths), 100)
            self.assertEqual(len(layers["depth"]), 20 * 17)

    def test_a_run_that_takes_too_long_is_ended(self):
        done = real_scenes.run(["sleep", "20"], 0.2)
        self.assertIsNone(done["rc"])
        self.assertLess(done["seconds"], 5)


if __name__ == "__main__":
    unittest.main()
