#!/usr/bin/env python3
"""scripts/figures/paper.py: rows from what a program writes, runs that go on, and its errors."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "figures" / "paper.py"
sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPT.parent))
from paper_tables import cornell, edits, growth  # noqa: E402


def area(corners):
    """Of a triangle, with its normal: half the cross product of two edges."""
    (a, b, c), (d, e, f) = ([q - p for p, q in zip(corners[0], corner)] for corner in corners[1:])
    return (b * f - c * e) / 2, (c * d - a * f) / 2, (a * e - b * d) / 2

# Writes a result to the file behind --json, and counts how often it was run.
PROGRAM = """#!/usr/bin/env python3
import json, pathlib, sys
calls = pathlib.Path(__file__).with_suffix(".calls")
calls.write_text(calls.read_text() + "x" if calls.exists() else "x")
out = pathlib.Path(sys.argv[sys.argv.index("--json") + 1])
out.write_text(json.dumps({"answers": 1234, "largest_change": 0.5}))
"""


class Paper(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.out = pathlib.Path(self.folder.name) / "out"
        self.bin = pathlib.Path(self.folder.name) / "bin"
        self.bin.mkdir()

    def paper(self, *words):
        return subprocess.run([sys.executable, SCRIPT, *words, "--out", self.out, "--bin",
                               self.bin], capture_output=True, text=True, check=False)

    def program(self, text=PROGRAM):
        path = self.bin / "experiment_consistency"
        path.write_text(text)
        path.chmod(0o755)
        return path.with_suffix(".calls")

    def test_a_row_keeps_what_the_program_wrote_and_is_not_measured_again(self):
        calls = self.program()
        for _ in range(2):
            done = self.paper("flicker", "--quick")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("1,234 answers", done.stdout)
        self.assertEqual(calls.read_text(), "x")
        row = json.loads((self.out / "quick" / "flicker.json").read_text())
        self.assertEqual(row["command"], "scripts/figures/paper.py flicker --quick")
        self.assertEqual(row["rows"], [{"answers": 1234, "largest_change": 0.5}])
        self.assertTrue(row["commands"][0].startswith("experiment_consistency "))
        self.assertIn("|1,234|0.5|", self.paper("--table", "flicker").stdout)

    def test_programs_of_another_folder_find_what_is_there(self):
        self.program()
        self.assertEqual(self.paper("flicker", "--quick").returncode, 0)
        self.bin = self.bin.parent / "other"
        self.bin.mkdir()
        calls = self.program()
        done = self.paper("flicker", "--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(calls.exists())

    def test_a_table_without_a_run_names_the_command_that_makes_it(self):
        done = self.paper("--table", "roadmap", "--quick")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.strip().count("\n"), 0)
        self.assertIn("scripts/figures/paper.py roadmap --quick makes it", done.stderr)

    def test_a_program_that_fails_ends_the_row_with_its_message(self):
        self.program("#!/bin/sh\necho no such scene >&2\nexit 1\n")
        done = self.paper("flicker", "--quick")
        self.assertEqual(done.returncode, 1)
        self.assertIn("experiment_consistency ended with 1: no such scene", done.stderr)
        self.assertFalse((self.out / "quick" / "flicker.json").exists())

    def test_an_unknown_row_is_refused(self):
        done = self.paper("table7")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no row table7: expected table1, ", done.stderr)

    def test_the_page_is_that_of_the_files(self):
        done = self.paper("--page", "--check")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_changed_room_differs_in_what_was_changed_alone(self):
        def parts(path):
            data = path.read_bytes()
            size = int.from_bytes(data[12:16], "little")
            self.assertEqual(int.from_bytes(data[8:12], "little"), len(data))
            return json.loads(data[20:20 + size]), data[20 + size:]
        source = ROOT / edits.ROOM
        before, rest = parts(source)
        for change in ("none", *edits.CHANGES):
            target = pathlib.Path(self.folder.name) / "room.glb"
            edits.changed_room(source, target, change)
            after, same = parts(target)
            self.assertEqual(rest, same)
            differs = sum(a != b for key in ("nodes", "materials")
                          for a, b in zip(before[key], after[key]))
            self.assertEqual(differs, {"none": 0, "lamp moved 1 m": 3, "sofa moved 0.6 m": 4}
                             .get(change, 1), change)


    def test_a_power_law_has_its_exponent_and_an_interval(self):
        xs = (10, 30, 100, 300, 1000)
        slope, half = growth.power_law([(x, 5 * x ** -0.4) for x in xs])
        self.assertAlmostEqual(slope, -0.4)
        self.assertLess(half, 1e-6)
        _, half = growth.power_law([(x, 5 * x ** -0.4 * (1.2 if i % 2 else 0.8))
                                          for i, x in enumerate(xs)])
        self.assertGreater(half, 0.1)

    def test_variants_are_measured_against_the_same_seed_as_trained(self):
        maker, trainer = self.bin / "lte_datagen", self.bin / "experiment_paper"
        maker.write_text(PROGRAM)
        trainer.write_text("""#!/usr/bin/env python3
import json, pathlib, sys
words = sys.argv
seed = int(words[words.index("--seed") + 1])
share = 0.1 * seed * (2 if "model.query_neighbours=8" in words else 1)
pathlib.Path(words[words.index("--json") + 1]).write_text(json.dumps(
    {"cpu_seconds": 10, "steps": 100, "scenes": 5, "parameters": 7, "peak_rss_mb": 1,
     "test": {"mse": 9, "share": share}}))
""")
        for path in (maker, trainer):
            path.chmod(0o755)
        done = self.paper("hyperparameters", "--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("kappa 8 2 ± 0; 64 points 1 ± 0", done.stdout)
        rows = json.loads((self.out / "quick" / "hyperparameters.json").read_text())["rows"]
        self.assertEqual({row["step_ms"] for row in rows}, {100})

    def test_what_lpips_needs_is_named_in_one_line(self):
        done = subprocess.run([sys.executable, "-S", SCRIPT.parent / "perceptual_distance.py", "a",
                               "b"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^perceptual_distance.py: LPIPS: no module numpy; pip "
                                      r"install numpy\n$")

    def test_a_triangle_is_filled_by_smaller_ones_wound_alike(self):
        corners = ((0.0, 0.0, 1.0), (2.0, 0.5, 0.0), (-1.0, 3.0, 0.5))
        positions, triangles = cornell.divided(corners, 5)
        self.assertEqual(len(triangles), 25)
        for triangle in triangles:
            for part, whole in zip(area([positions[i] for i in triangle]), area(corners)):
                self.assertAlmostEqual(part, whole / 25)

    def test_the_box_keeps_its_surface(self):
        with tempfile.TemporaryDirectory() as folder:
            box = pathlib.Path(folder) / "box.glb"
            self.assertEqual(cornell.tessellated(ROOT / cornell.BOX, box, 3), 32 * 9)
            again = pathlib.Path(folder) / "again.glb"
            self.assertEqual(cornell.tessellated(box, again, 2), 32 * 36)


if __name__ == "__main__":
    unittest.main()
