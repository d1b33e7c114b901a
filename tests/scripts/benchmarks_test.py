#!/usr/bin/env python3
"""scripts/figures/benchmarks.py: the rows that it takes from the programs' results
(benchmark_outputs.json, what they wrote for small scenes), the page that it writes, and what it
refuses."""
import copy
import json
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "figures" / "benchmarks.py"
sys.path.insert(0, str(SCRIPT.parent))
import benchmark_tables  # noqa: E402
import benchmarks  # noqa: E402

OUTPUTS = json.loads((pathlib.Path(__file__).parent / "benchmark_outputs.json").read_text())
# Writes its part of OUTPUTS where --json says, as the program of that name does.
STAND_IN = """#!{python}
import json, sys
words = sys.argv
if words[1] == "{fails}":
    sys.exit("lte_bench: no such scene")
outputs = json.load(open({outputs!r}))
json.dump(outputs[words[1][:6]], open(words[words.index("--json") + 1], "w"))
"""


def run(*arguments, code=0):
    done = subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True,
                          text=True, check=False)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr}")
    return done.stdout if code == 0 else done.stderr


class Rows(unittest.TestCase):
    def test_counts_rooms_with_a_mean_within_five_per_cent(self):
        rows = benchmark_tables.outside_rows({"scenes": OUTPUTS["scenes"]})
        self.assertEqual([row["method"] for row in rows], ["gather", "paths-16"])
        self.assertEqual([row["mean_within"] for row in rows], [1, 1])
        self.assertAlmostEqual(rows[0]["worth"], 70.833, 3)
        other = copy.deepcopy(OUTPUTS["scenes"])
        other["scenes"][0]["methods"]["gather"]["irradiance"]["mean_ratio"] = 1.06
        rows = benchmark_tables.outside_rows({"scenes": other})
        self.assertEqual([row["mean_within"] for row in rows], [0, 1])

    def test_whole_pictures_have_means_over_rooms(self):
        dark = copy.deepcopy(OUTPUTS["scenes"])
        [room] = dark["scenes"]
        first = room["methods"]["gather"]["whole"]
        other = copy.deepcopy(room)
        other["methods"]["gather"]["whole"].update(
            flip=first["flip"] + 0.2, ssim=first["ssim"] - 0.4, mean=2 * first["mean"], mse=-1,
            mse_stderr=4 * first["mse"])
        unlit = copy.deepcopy(room)
        unlit["methods"]["gather"] = {"not_measured": "has a sun"}
        dark["scenes"] += [other, unlit]
        whole = benchmark_tables.outside_rows({"scenes": dark})[0]["whole"]
        self.assertAlmostEqual(whole["flip"], first["flip"] + 0.1)
        self.assertAlmostEqual(whole["ssim"], first["ssim"] - 0.2)
        # Below noise, four times the error of a picture twice as bright: the same again.
        self.assertAlmostEqual(whole["mse"], first["mse"] / first["mean"] ** 2)

    def test_a_first_view_holds_what_is_done_once(self):
        rows = benchmark_tables.picture_rows({"plain": OUTPUTS["pareto"], "m": OUTPUTS["pareto"]})
        names = [row["method"] for row in rows]
        self.assertEqual(names[:4], ["paths-1", "denoised-1", "gather-draft", "paths-1, m"])
        draft = rows[2]["cornell_box"]
        self.assertAlmostEqual(draft["first"], 0.0770306, 6)
        self.assertAlmostEqual(draft["further"], 0.0040176, 6)

    def test_takes_the_path_tracer_s_own_rate(self):
        [row] = benchmark_tables.path_rows({"Cornell_box": OUTPUTS["pathtrace"]})
        self.assertEqual(row["scene"], "Cornell box")
        self.assertAlmostEqual(row["rate"], 7.486588, 5)

    def test_training_takes_the_first_line_that_tells_a_rate(self):
        log = [{"step": 0, "val_loss": 1}, {"step": 40, "queries_per_s": 5, "rss_mb": 7},
               {"step": 42, "queries_per_s": 9, "rss_mb": 8}]
        self.assertEqual(benchmark_tables.training_rows({"float32": log}),
                         [{"run": "float32", "queries": 5, "mib": 7}])

    def test_numbers_have_three_digits(self):
        for value, text in ((None, ""), ("1 to 2", "1 to 2"), (29412, "29,400"), (1.0, "1"),
                            (0.00052, "0.00052"), (24.44, "24.4"), (0, "0")):
            self.assertEqual(benchmarks.number(value), text)

    def test_a_flag_stays_beside_its_value(self):
        lines = benchmarks.wrapped("tool " + "--flag value " * 12)
        self.assertGreater(len(lines), 1)
        for line in lines:
            self.assertLessEqual(len(line), benchmarks.COLUMNS - 4)
            self.assertEqual(line.count("--flag"), line.count("value"))


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.page = self.folder / "benchmarks.md"
        self.page.write_text("# Benchmarks\n<!-- table network -->\n<!-- end -->\nThe end.\n")

    def stand_in(self, fails="nothing"):
        tool = self.folder / "lte_bench"
        outputs = str(pathlib.Path(__file__).parent / "benchmark_outputs.json")
        tool.write_text(STAND_IN.format(python=sys.executable, outputs=outputs, fails=fails))
        tool.chmod(tool.stat().st_mode | stat.S_IXUSR)
        return ("--docs", self.folder, "--bin", self.folder, "--work", self.folder / "work")

    def test_runs_commands_and_writes_file_and_page(self):
        run("--run", "network", "--machine", "a machine", *self.stand_in())
        file = json.loads((self.folder / "benchmarks" / "network.json").read_text())
        self.assertEqual(file["machine"], "a machine")
        self.assertEqual(len(file["commands"]), 4)
        self.assertEqual([row["work"] for row in file["rows"]],
                         ["encode a scene"] * 2 + ["decode a picture"] * 2)
        text = self.page.read_text()
        self.assertIn("| encode a scene | 1,000 | fp32 | 0.0131 | 71.7 | 4.6 | 12.8 |", text)
        self.assertTrue(text.endswith("<!-- end -->\nThe end.\n"))
        run("--check", "--docs", self.folder)

    def test_check_fails_where_the_page_says_otherwise(self):
        run("--run", "network", *self.stand_in())
        self.page.write_text(self.page.read_text().replace("0.0131", "0.0031"))
        self.assertIn("differs", run("--check", "--docs", self.folder, code=1))

    def test_a_failed_command_leaves_the_file_as_it_was(self):
        error = run("--run", "network", *self.stand_in(fails="decoder"), code=1)
        self.assertEqual(error.strip().splitlines()[-1],
                         "benchmarks.py: lte_bench ended with 1: lte_bench: no such scene")
        self.assertFalse((self.folder / "benchmarks" / "network.json").exists())

    def test_refuses_in_one_line(self):
        self.assertIn("expected outside", run("--run", "speed", code=2))
        flags = self.stand_in()
        (self.folder / "lte_bench").unlink()
        self.assertIn("build it", run("--run", "network", *flags, code=1))
        (self.folder / "benchmarks" / "network.json").write_text("{")
        error = run("--docs", self.folder, code=1)
        self.assertIn("is no JSON", error)
        self.assertEqual(error.count("\n"), 1, error)

    def test_the_shipped_page_has_what_its_files_say(self):
        run("--check")


if __name__ == "__main__":
    unittest.main()
