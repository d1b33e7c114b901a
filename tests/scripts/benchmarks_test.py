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
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "figures" / "benchmarks.py"
sys.path.insert(0, str(SCRIPT.parent))
import benchmark_charts  # noqa: E402
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

    def test_points_have_a_row_an_integrator_of_its_last_run(self):
        def run(integrator, rays):
            return {"integrator": integrator, "rays": rays, "worth": 2 * rays, "least": rays,
                    "error": 1 / rays, "mean_within": 1, "processor_seconds": rays / 10}
        rows = benchmark_tables.point_rows({"probe": {"scenes": [{}, {}], "methods": [
            run("gather", 16), run("gather", 64), run("path", 256)]}})
        self.assertEqual([(row["method"], row["rooms"], row["worth"]) for row in rows],
                         [("gather", 2, 128), ("path", 2, 512)])
        self.assertEqual(rows[0]["runs"], [{"rays": 16, "error": 1 / 16, "cpu_seconds": 1.6},
                                           {"rays": 64, "error": 1 / 64, "cpu_seconds": 6.4}])

    def test_edits_have_a_row_a_method_and_a_time_a_kind(self):
        def edit(kind, seconds, **more):
            return {"scene": "a.glb", "edit": kind, "noise": 0.2,
                    "methods": {"gather-draft": {"seconds": seconds, "error": 0.1, **more}}}
        [row] = benchmark_tables.edit_rows({"edits": {
            "edits": [edit("lamp", 1, again=0.25), edit("object", 4), edit("lamp", 2, again=0.75)],
            "methods": [{"method": "gather-draft", "seconds": 7 / 3, "error": 0.1}]}})
        self.assertEqual((row["lamp"], row["object"], row["again"]), (1.5, 4, 0.5))
        self.assertEqual([(f["edit"], f["seconds"]) for f in row["edits"]],
                         [("lamp", 1), ("object", 4), ("lamp", 2)])
        [row] = benchmark_tables.edit_rows({"edits": {
            "edits": [edit("lamp", 1)],
            "methods": [{"method": "gather-draft", "seconds": 1, "error": 0.1}]}})
        self.assertIsNone(row["again"])

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


class Charts(unittest.TestCase):
    """Where dots lie, read from the SVG."""

    def dots(self, svg):
        root = xml.etree.ElementTree.fromstring(svg)
        space = "{http://www.w3.org/2000/svg}"
        circles = [(float(c.get("cx")), float(c.get("cy"))) for c in root.iter(space + "circle")]
        names = [t.text for t in root.iter(space + "text") if t.get("text-anchor") == "start"]
        return dict(zip(names, circles, strict=True))

    def test_texels_are_of_the_scenes_that_all_methods_have(self):
        def row(method, *figures):
            return {"method": method, "scenes": {"bake": [
                {"scene": f"{k}.glb", "processor_seconds": s, "rel_mse": e}
                for k, (s, e) in enumerate(figures)], "million": []}}
        few = [row("bake draft", (1, 0.04), (99, 9)), row("bake final", (4, 0.0025)),
               row("paths 16, OIDN", (2, 0.01), (99, 9))]
        svg = benchmark_charts.texels_chart(few)
        self.assertIn("256,000 texels, 1 scenes", svg)
        dots = self.dots(svg)
        self.assertEqual(set(dots), {"bake draft", "bake final", "paths 16, OIDN"})
        draft, middle, final = dots["bake draft"], dots["paths 16, OIDN"], dots["bake final"]
        # Twice the time and half the error each, on logarithmic axes.
        for axis in (0, 1):
            self.assertAlmostEqual(middle[axis] - draft[axis], final[axis] - middle[axis], delta=.2)
            self.assertGreater(middle[axis], draft[axis])

    def test_edits_have_a_dot_a_method_and_a_line_an_integrator(self):
        rows = [{"method": method, "cpu_seconds": seconds, "error": error, "edits": [{}] * 9}
                for method, seconds, error in (
                    ("gather-draft", 0.2, 0.1), ("gather-final", 2, 0.04), ("denoised-4", 1, 0.1),
                    ("network-draft", 1, 0.2))]
        svg = benchmark_charts.edits_chart(rows)
        self.assertIn("from edit to picture, 9 edits", svg)
        dots = self.dots(svg)
        self.assertEqual(set(dots), {"gather draft", "gather final", "denoised 4", "network draft"})
        self.assertLess(dots["gather draft"][0], dots["gather final"][0])
        self.assertLess(dots["gather draft"][1], dots["gather final"][1])  # down is less error
        self.assertEqual(svg.count('fill="none"'), 3)

    def test_points_have_a_dot_a_run_and_a_line_an_integrator(self):
        rows = [{"method": "gather", "runs": [{"rays": rays, "error": 1 / rays, "cpu_seconds": rays}
                                              for rays in (16, 64)]},
                {"method": "path", "runs": [{"rays": 64, "error": 0.5, "cpu_seconds": 8}]}]
        svg = benchmark_charts.points_chart(rows)
        self.assertEqual(set(self.dots(svg)), {"gather 16", "gather 64", "path 64"})
        self.assertEqual(svg.count('fill="none"'), 2)


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
