#!/usr/bin/env python3
"""scripts/validation/check_expected_errors.py, on answers whose error is known."""
import json
import pathlib
import unittest

import stand_in_tools

SCRIPT = (pathlib.Path(__file__).resolve().parents[2] / "scripts" / "validation" /
          "check_expected_errors.py")
# The truth is 2, known to 0.3. Of gather, which expects 0.4, errors are 0.49, 0.51, 0.99 and 1.01;
# the network has none.
PROBE = """#!{python}
import csv, sys
flag = lambda name: sys.argv[sys.argv.index(name) + 1]
off = {{"path": [0] * 4, "gather": [0.49, -0.51, 0.99, -1.01], "network": [0] * 4}}
rows = list(csv.DictReader(open(flag("--points"))))
assert [float(row["px"]) for row in rows] == [0, 3, 6, 9] and rows[0]["ny"] == "1.0"
with open(flag("--out"), "w", newline="") as file:
    out = csv.writer(file)
    out.writerow([f"{{k}}_{{c}}" for k in ("total", "stderr") for c in "rgb"] + ["expected_error"])
    for error in off[flag("--integrator")]:
        out.writerow([2 + error] * 3 + [0.3] * 3 + [0.4])
"""


class ExpectedErrors(stand_in_tools.ScriptTest):
    SCRIPT, PROBE = SCRIPT, PROBE
    INTERPRETER = ("-S",)  # without the package, whose embeddings need real scenes

    def test_counts_with_the_error_of_the_reference(self):
        done = self.run_script("--json", self.folder / "out.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(list(result["scenes"]), ["a", "b"])
        self.assertEqual(result["within"], {"gather": [0.25, 0.75], "network": [1, 1]})
        self.assertIn("gather: 25 % within the expected error, 75 % within twice that", done.stdout)

    def test_says_which_command_failed(self):
        done = self.run_with_a_failing_probe()
        self.assertEqual(done.returncode, 1)
        self.assertIn("lte_probe: no light", done.stderr)


if __name__ == "__main__":
    unittest.main()
