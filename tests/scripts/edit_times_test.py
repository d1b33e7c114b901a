#!/usr/bin/env python3
"""scripts/figures/edit_times.py, on a program whose time and error are known, and what it reads
.exr files and finds errors by."""
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SCRIPT = HERE.parents[1] / "scripts" / "figures" / "edit_times.py"
sys.path.insert(0, str(SCRIPT.parent))
from exr_file import write_exr  # noqa: E402
from exr_layer import read_layer  # noqa: E402
from pair_error import References  # noqa: E402

WIDTH, HEIGHT = 32, 24
# Indirect light of 2 in pixels that count. The top shines, and a corner shows nothing: what is
# there is no error. Noise of one kind changes sign from column to column, the other from row to
# row, so that their product vanishes in each block.
PICTURE = """
def picture(scale, noise):
    pixels = [(x, y) for y in range({height}) for x in range({width})]
    sign = {{"columns": lambda x, y: (-1)**x, "rows": lambda x, y: (-1)**y, "": lambda x, y: 0}}
    light = [2 * scale + 0.5 * sign[noise](x, y) if y >= 8 and (x >= 8 or y < 16)
             else 1000 * scale for x, y in pixels]
    out = {{f"indirect.{{c}}": list(light) for c in "RGB"}}
    out |= {{f"emission.{{c}}": [float(y < 8) for x, y in pixels] for c in "RGB"}}
    return out | {{"depth.Z": [float(x >= 8 or y < 16) for x, y in pixels]}}
""".format(width=WIDTH, height=HEIGHT)
# A frame takes UNIT seconds, an edit twice that by gathering and, where it is the first of a lamp,
# four times by the network.
UNIT, DELTA = 0.05, 0.04
RENDER = """#!{python}
import json, pathlib, sys, time
sys.path.insert(0, {here!r})
from exr_file import write_exr
{picture}
flag = lambda name: sys.argv[sys.argv.index(name) + 1]
frames, edits = (line.partition(": ")[2] for line in open(flag("--edit")))
frames, edits = int(frames), json.loads(edits)
assert all(0 <= edit["frame"] < frames for edit in edits)
out, network = flag("--out"), flag("--integrator") == "network"
cost = 1 + frames + sum((4 if network else 2) * (edit["frame"] < 2)
                        for edit in {{e["frame"]: e for e in edits}}.values())
for frame in range(frames):
    path = pathlib.Path(out.replace("%d", str(frame)))
    assert not path.exists(), path
    if path.suffix == ".png":
        path.touch()
    elif "--spp" in sys.argv and "denoise=off" in sys.argv:
        assert edits[0]["frame"] == 0 and frames == 1
        noise = {{"101": "columns", "102": "rows"}}[flag("--seed")]
        write_exr(path, {width}, {height}, picture(1, noise))
    else:
        write_exr(path, {width}, {height}, picture(1.05 if network else 0.9, ""))
while path.suffix == ".png" and time.process_time() < {unit} * cost:
    pass
"""


class EditTimes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_script(self, text, *more):
        tool = self.folder / "lte_render"
        tool.write_text(text)
        tool.chmod(0o755)
        return subprocess.run(
            [sys.executable, SCRIPT, "living_room", "--bin", self.folder, "--work",
             self.folder / "work", "--methods", "gather-draft,network-draft", *more],
            capture_output=True, text=True, check=False)

    def test_takes_the_time_of_the_edit_and_the_error_after_it(self):
        render = RENDER.format(python=sys.executable, here=str(HERE), picture=PICTURE, width=WIDTH,
                               height=HEIGHT, unit=UNIT)
        done = self.run_script(render, "--repeats", "2", "--json", self.folder / "out.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "out.json").read_text())
        self.assertEqual([(edit["scene"], edit["edit"]) for edit in result["edits"]],
                         [("living_room.glb", kind) for kind in ("lamp", "object", "material")])
        for edit in result["edits"]:
            gather, network = edit["methods"]["gather-draft"], edit["methods"]["network-draft"]
            self.assertAlmostEqual(gather["error"], 0.1, 5)
            self.assertAlmostEqual(network["error"], 0.05, 5)
            # The halves differ by 1 in every other pixel.
            self.assertAlmostEqual(edit["half_noise"], 0.25, 5)
            # A frame and its edit; the delta is room for what a busy machine adds.
            self.assertAlmostEqual(gather["seconds"], 3 * UNIT, delta=DELTA)
            self.assertAlmostEqual(network["seconds"], 5 * UNIT, delta=DELTA)
            self.assertNotIn("again", gather)
        lamp, moved, _ = (edit["methods"]["network-draft"] for edit in result["edits"])
        self.assertAlmostEqual(lamp["again"], UNIT, delta=DELTA)
        self.assertNotIn("again", moved)
        gather, network = result["methods"]
        self.assertEqual((gather["method"], network["method"]), ("gather-draft", "network-draft"))
        self.assertAlmostEqual(gather["error"], 0.1, 5)
        self.assertAlmostEqual(network["seconds"], 5 * UNIT, delta=DELTA)

    def test_says_in_one_line_what_failed(self):
        done = self.run_script("#!/bin/sh\necho 'lte_render: no lamp' >&2; exit 1\n")
        self.assertEqual(done.returncode, 1)
        self.assertIn("lte_render: no lamp", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn("no method magic: expected gather-draft",
                      self.run_script("", "--methods", "magic").stderr)


class Errors(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.picture = {}
        exec(PICTURE, self.picture)  # as the stand-in has it

    def write(self, name, channels, width=WIDTH, height=HEIGHT):
        write_exr(self.folder / name, width, height, channels)
        return self.folder / name

    def test_a_firefly_counts_as_four_times_what_is_bright(self):
        def error(brightness):
            a, b, x = (self.picture["picture"](scale, noise)
                       for scale, noise in ((1, "columns"), (1, "rows"), (1, "")))
            x["indirect.R"][20 * WIDTH + 20] = brightness
            truth = References(self.write("a.exr", a), self.write("b.exr", b))
            return truth.error(self.write("x.exr", x))
        self.assertEqual(error(1e6), error(1e9))
        self.assertLess(error(2.1), error(1e6))

    def test_an_error_within_noise_counts_as_its_standard_error(self):
        a, b = (self.picture["picture"](1, noise) for noise in ("columns", "rows"))
        for y in range(8, 16):  # a block whose noise is alike in both: an error of it is none
            for x in range(8, 16):
                b["indirect.R"][y * WIDTH + x] = 4 - a["indirect.R"][y * WIDTH + x]
        truth = References(self.write("a.exr", a), self.write("b.exr", b))
        found = truth.error(self.write("x.exr", self.picture["picture"](1, "")))
        # The block's sum of products is 64 * -0.25, of seven blocks, of 3 * 64 values each.
        of_block, blocks = -16, 7
        rest = [of_block * 6 / 7] + [-of_block / 7] * 6
        spread = sum(r * r for r in rest) * blocks / (blocks - 1)
        self.assertAlmostEqual(found, (spread**0.5 / (7 * 192))**0.5 / 2, 5)

    def test_refuses_a_picture_of_another_size(self):
        a, b = (self.write(name, self.picture["picture"](1, "")) for name in ("a.exr", "b.exr"))
        small = {f"indirect.{c}": [1.0] * 4 for c in "RGB"}
        with self.assertRaisesRegex(ValueError, "is 2x2"):
            References(a, b).error(self.write("x.exr", small, 2, 2))


class Layers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "a.exr"

    def test_reads_blocks_compressed_and_not(self):
        draw = random.Random(1)
        width, height = 5, 37
        noise = [draw.random() for _ in range(width * height)]
        even = [float(k // 7) for k in range(width * height)]
        for channels in ({"Y": noise}, {"a.R": even, "a.G": noise}, {"a.R": even}):
            write_exr(self.path, width, height, channels)
            *size, values = read_layer(self.path, *channels)
            self.assertEqual(size, [width, height])
            for found, put in zip(values, channels.values(), strict=True):
                self.assertEqual(len(found), len(put))
                for x, y in zip(found, put):
                    self.assertAlmostEqual(x, y, 6)

    def test_names_what_it_cannot_read(self):
        write_exr(self.path, 2, 2, {"R": [1.0] * 4})
        with self.assertRaisesRegex(ValueError, "a.exr: has no channel indirect.R"):
            read_layer(self.path, "indirect.R")
        write_exr(self.path, 2, 2, {"R": [1.0] * 4}, compression=4)
        with self.assertRaisesRegex(ValueError, "is not compressed"):
            read_layer(self.path, "R")
        write_exr(self.path, 2, 2, {"R": [1.0] * 4})
        self.path.write_bytes(self.path.read_bytes()[:-4])
        with self.assertRaisesRegex(ValueError, "a.exr: "):
            read_layer(self.path, "R")
        self.path.write_bytes(b"no picture at all")
        with self.assertRaisesRegex(ValueError, "is no .exr"):
            read_layer(self.path, "R")


if __name__ == "__main__":
    unittest.main()
