#!/usr/bin/env python3
"""scripts/figures/edit_times.py, on programs whose time and error are known."""
import contextlib
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

HERE = pathlib.Path(__file__).resolve().parent
SCRIPT = HERE.parents[1] / "scripts" / "figures" / "edit_times.py"
sys.path.insert(0, str(SCRIPT.parent))
import edit_times  # noqa: E402

NOISE = 0.25
ERRORS = {"gather": 0.1, "network": 0.05}


def play(command):
    """Does what lte_render and lte_eval would, and returns processor seconds.

    A run takes a second, each frame one more, and an edit two by gathering and, where it is the
    first of a lamp or no lamp's, four by the network.
    """
    command = [str(word) for word in command]

    def flag(name):
        return command[command.index(name) + 1]
    if command[0].endswith("lte_eval"):
        assert flag("--layer") == "indirect"
        first, second = (pathlib.Path(command[i + 1]).read_text()
                         for i, word in enumerate(command) if word == "--reference")
        assert {first, second} == {"paths 101", "paths 102"}, (first, second)
        error = ERRORS[pathlib.Path(command[2]).read_text()]
        pathlib.Path(flag("--json")).write_text(json.dumps([{"error": error, "noise": NOISE}]))
        return 0
    frames, edits = (line.partition(": ")[2] for line in open(flag("--edit"), encoding="utf-8"))
    frames, edits = int(frames), json.loads(edits)
    assert all(0 <= edit["frame"] < frames for edit in edits)
    integrator, out = flag("--integrator"), flag("--out")
    for frame in range(frames):
        path = pathlib.Path(out.replace("%d", str(frame)))
        assert not path.exists(), path
        if integrator == "path":
            assert flag("--set") == "denoise=off" and frames == 1 and edits[0]["frame"] == 0
            path.write_text(f"paths {flag('--seed')}")
        else:
            path.write_text(integrator)
    cost = 4 if integrator == "network" else 2
    return 1 + frames + sum(cost * (frame < 2) for frame in {edit["frame"] for edit in edits})


class EditTimes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def words(self, *more):
        return ["living_room", "--bin", str(self.folder), "--work", str(self.folder / "work"),
                "--methods", "gather-draft,network-draft", *map(str, more)]

    def test_takes_the_time_of_the_edit_and_the_error_after_it(self):
        out = self.folder / "out.json"
        with mock.patch.object(edit_times, "processor_seconds", play), \
                mock.patch.object(sys, "argv", [str(SCRIPT), *self.words("--json", out)]), \
                contextlib.redirect_stdout(io.StringIO()):
            edit_times.main()
        result = json.loads(out.read_text())
        self.assertEqual([(edit["scene"], edit["edit"]) for edit in result["edits"]],
                         [("living_room.glb", kind) for kind in ("lamp", "object", "material")])
        for edit in result["edits"]:
            gather, network = edit["methods"]["gather-draft"], edit["methods"]["network-draft"]
            self.assertEqual((gather["error"], network["error"]), (0.1, 0.05))
            self.assertEqual(edit["noise"], NOISE)
            # A frame and its edit.
            self.assertEqual((gather["seconds"], network["seconds"]), (3, 5))
            self.assertNotIn("again", gather)
        lamp, moved, _ = (edit["methods"]["network-draft"] for edit in result["edits"])
        self.assertEqual(lamp["again"], 1)
        self.assertNotIn("again", moved)
        gather, network = result["methods"]
        self.assertEqual((gather["method"], network["method"]), ("gather-draft", "network-draft"))
        self.assertAlmostEqual(gather["error"], 0.1, 9)
        self.assertEqual(network["seconds"], 5)

    def test_short_runs_are_repeated_and_the_least_counts(self):
        seconds = iter([0.5, 0.2, 0.4, 7, 0.1])
        args = mock.Mock(work=self.folder, bin=self.folder, size="8x6", repeats=3)
        with mock.patch.object(edit_times, "processor_seconds", lambda _: next(seconds)):
            self.assertEqual(edit_times.least_seconds(args, "a.glb", (), ()), 0.2)
            self.assertEqual(edit_times.least_seconds(args, "a.glb", (), ()), 7)

    def test_says_in_one_line_what_failed(self):
        def run(text, *more):
            tool = self.folder / "lte_render"
            tool.write_text(text)
            tool.chmod(0o755)
            return subprocess.run([sys.executable, SCRIPT, *self.words(*more)],
                                  capture_output=True, text=True, check=False)
        done = run("#!/bin/sh\necho 'lte_render: no lamp' >&2; exit 1\n")
        self.assertEqual(done.returncode, 1)
        self.assertIn("lte_render: no lamp", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn("no method magic: expected gather-draft",
                      run("", "--methods", "magic").stderr)


if __name__ == "__main__":
    unittest.main()
