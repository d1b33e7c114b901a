#!/usr/bin/env python3
"""scripts/figures/point_errors.py, on answers whose error is known."""
import json
import pathlib
import unittest

import stand_in_tools

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "figures" / "point_errors.py"
# A sample of two light groups, whose light is 0.5 and 1.5 at each of four points, with a variance
# of 0.01 of the mean over all paths.
TENSORS = {"indirect": ([0.5] * 12 + [1.5] * 12, [2, 4, 3]), "variance": ([0.01] * 4, [4])}
# Of gather a fifth too bright at two points and too dark at the others with 256 rays, twice that
# with 64; of the network the truth.
PROBE = """#!{python}
import csv, sys
flag = lambda name: sys.argv[sys.argv.index(name) + 1]
rows = list(csv.DictReader(open(flag("--points"))))
with open(flag("--out"), "w", newline="") as file:
    out = csv.writer(file)
    out.writerow([f"{{k}}_{{c}}" for k in ("total", "direct") for c in "rgb"])
    for i, row in enumerate(rows):
        assert float(row["px"]) == 3 * i and row["ny"] == "1.0"
        off = (256 / int(flag("--spp")))**0.5 * (0.2 if i % 2 else -0.2)
        off = off if flag("--integrator") == "gather" else 0
        out.writerow([7 + 2 + off] * 3 + [7] * 3)
"""


class PointErrors(stand_in_tools.ScriptTest):
    SCRIPT, PROBE, TENSORS = SCRIPT, PROBE, TENSORS
    FLAGS = ("--rays", "100")
    HEADER = {"__metadata__": {"rays": "100"}}

    def test_takes_the_variance_of_the_reference_off(self):
        done = self.run_script("--json", self.folder / "out.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "out.json").read_text())
        self.assertEqual([scene["name"] for scene in result["scenes"]], ["a.glb", "b.obj"])
        methods = {f"{m['integrator']} {m['rays']}": m for m in result["methods"]}
        self.assertEqual(list(methods), ["gather 16", "gather 64", "gather 256", "network 16",
                                         "network 64", "network 256", "path 64", "path 256",
                                         "path 1024"])
        gather, network = methods["gather 256"], methods["network 256"]
        # A path has the variance 100 * 0.01, and the answers an error of 0.04 less 0.01.
        self.assertAlmostEqual(gather["worth"], 1 / 0.03, 3)
        self.assertAlmostEqual(gather["error"], 0.03**0.5 / 2, 6)
        self.assertAlmostEqual(methods["gather 64"]["worth"], 1 / (0.16 - 0.01), 3)
        self.assertAlmostEqual(result["scenes"][0]["gather 256"]["mean_ratio"], 1, 6)
        self.assertEqual(gather["mean_within"], 2)
        self.assertAlmostEqual(network["worth"], 1000, 6,
                               "no more is claimed than the reference can tell")

    def test_says_which_command_failed(self):
        done = self.run_with_a_failing_probe()
        self.assertEqual(done.returncode, 1)
        self.assertIn("lte_probe: no light", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
