#!/usr/bin/env python3
"""scripts/figures/learning_curves.py on logs written by hand: the table's figures, where the plot
puts its points, and what it refuses."""
import contextlib
import io
import json
import pathlib
import runpy
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from unittest import mock

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "figures" / "learning_curves.py"


def run(*arguments, code=0):
    """What the script prints: on standard output, or on standard error where a code other than 0 is
    expected."""
    output, error = io.StringIO(), io.StringIO()
    argv = [str(SCRIPT), *map(str, arguments)]
    with mock.patch.object(sys, "argv", argv), contextlib.redirect_stdout(output), \
            contextlib.redirect_stderr(error):
        try:
            runpy.run_path(str(SCRIPT), run_name="__main__")
        except SystemExit as end:
            if end.code != code:
                raise AssertionError(
                    f"{arguments}: exit code {end.code}: {error.getvalue()}") from end
    return output.getvalue() if code == 0 else error.getvalue()


def cells(output, name):
    """A row of the table by the heads of its columns."""
    lines = [
        [cell.strip() for cell in line.strip("|").split(" | ")] for line in output.splitlines()
    ]
    return dict(zip(lines[0], next(line for line in lines[2:] if line[0] == name)))


class LearningCurves(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def log(self, name, losses, end=""):
        """Validation losses at steps 10, 20, ..., with a line of training before each."""
        folder = self.folder / name
        folder.mkdir()
        lines = []
        for i, loss in enumerate(losses):
            lines.append({
                "step": 10 * i + 10, "loss": 2 * loss, "grad_norm": 0.5, "seconds": 360.0 * (i + 1)
            })
            lines.append({
                "step": 10 * i + 10, "val_loss": loss, "val_mse": None,
                "val_scenes": {"room": loss}
            })
        (folder / "log.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines) + end)
        return folder

    def data(self, run_folder, train):
        root = self.folder / "data" / run_folder.name
        root.mkdir(parents=True)
        scenes = [{"split": "train"}] * train + [{"split": "val"}] * 3
        (root / "dataset.json").write_text(json.dumps({"scenes": scenes}))
        (run_folder / "config.yaml"
        ).write_text(f'seed: 1\ndata:\n  scene_points: 0\n  root: "{root}"\ntrain:\n  steps: 30\n')

    def test_table_has_the_logs_figures(self):
        a = self.log("a", [0.5, 0.125, 0.25], end='{"step":40,"val_lo')
        b = self.log("b", [0.4])
        self.data(a, 7)
        output = run(a, f"other={b / 'log.jsonl'}", "--scenes", "other=12")
        self.assertEqual(
            cells(output, "a"), {
                "run": "a", "scenes": "7", "steps": "30", "hours": "0.3", "loss": "0.5",
                "val_loss": "0.25", "lowest": "0.125", "at step": "20"
            })
        self.assertEqual(cells(output, "other")["scenes"], "12")
        self.assertEqual(cells(run(b), "b")["scenes"], "–")

    def test_evaluations_stand_beside(self):
        a, b = self.log("a", [0.5]), self.log("b", [0.4])
        neural = {"points": {"mse": 0.03}, "views": {"mse": 0.02, "ssim": None}}
        (self.folder / "a.json").write_text(
            json.dumps({
                "metrics": {"neural": neural},
                "equal_samples": {"neural": {"points": {"all": 8.25}, "views": {"all": None}}}
            }))
        output = run(a, b, "--eval", f"a={self.folder / 'a.json'}")
        row = cells(output, "a")
        self.assertEqual([row["points MSE"], row["views MSE"], row["views SSIM"]],
                         ["0.03", "0.02", "–"])
        self.assertEqual([row["worth paths a point"], row["worth paths a pixel"]], ["8.25", "–"])
        self.assertEqual(cells(output, "b")["points MSE"], "–")

    def test_plot_spans_its_axes_with_logarithms(self):
        runs = [
            f"{name}={self.log(name, losses)}" for name, losses in (("x", [1, 0.1, 0.01]),
                                                                    ("<y>", [0.5, 0.25]))
        ]
        plot = self.folder / "curves.svg"
        run(*runs, "--scenes", "x=100", "--scenes", "<y>=10", "--out", plot)
        tree = xml.etree.ElementTree.parse(plot)
        lines = [[tuple(map(float, point.split(",")))
                  for point in element.get("points").split()]
                 for element in tree.iter()
                 if element.tag.endswith("polyline")]
        # 460 x 320 a panel, margins 62, 14, 26 and 40: x from 62 to 446, y from 280 up to 26.
        self.assertEqual(lines[0], [(62, 26), (254, 153), (446, 280)])
        self.assertEqual([x for x, _ in lines[1]], [62, 254])
        self.assertEqual(lines[2], [(522, 26), (906, 280)])  # 10 scenes at 0.25, 100 at 0.01
        texts = [element.text for element in tree.iter() if element.tag.endswith("text")]
        for word in ("<y>", "val_loss by step", "training scenes", "last val_loss", "0.1"):
            self.assertIn(word, texts)

    def test_plot_of_one_value_is_a_dot_and_scenes_that_are_unknown_or_alike_have_none(self):
        plot, a = self.folder / "curves.svg", self.log("a", [0.5])
        run(a, "--out", plot)
        tags = [element.tag.split("}")[1] for element in xml.etree.ElementTree.parse(plot).iter()]
        self.assertEqual(tags.count("circle"), 1)
        self.assertNotIn("training scenes", plot.read_text())
        run(a, self.log("b", [0.4]), "--scenes", "a=7", "--scenes", "b=7", "--out", plot)
        self.assertNotIn("training scenes", plot.read_text())

    def test_narrow_ranges_have_ticks(self):
        plot = self.folder / "curves.svg"
        run(self.log("a", [0.073, 0.071, 0.069]), "--out", plot)
        self.assertIn(">0.07<", plot.read_text())

    def test_refuses_with_one_line(self):
        a = self.log("a", [0.5])
        (self.folder / "empty.jsonl").write_text("no JSON\n")
        (self.folder / "bad.json").write_text("{")
        for arguments, words in (([self.folder / "none"], ["none/log.jsonl", "No such file"]),
                                 ([self.folder / "empty.jsonl"], ["empty.jsonl", "nothing"]),
                                 ([a, a], ['"a"', "two runs"]), ([a, "--eval", "b=x.json"], [
                                     'no run is named "b"', "there are: a"
                                 ]), ([a, "--eval", f"a={self.folder / 'bad.json'}"],
                                      ["bad.json",
                                       "not JSON"]), ([a, "--scenes",
                                                       "a=many"], ["a=many", "number of scenes"]),
                                 ([a, "--scenes",
                                   "7"], ["NAME=VALUE"]), ([a, "--metric",
                                                            "val_lost"], ["val_lost", "val_loss"]),
                                 ([a, "--out",
                                   self.folder / "none" / "c.svg"], ["c.svg", "No such file"])):
            error = run(*arguments, code=1)
            self.assertEqual(error.count("\n"), 1, error)
            for word in words:
                self.assertIn(word, error)
        run(a, "--out", "curves.pdf", code=2)


if __name__ == "__main__":
    unittest.main()
