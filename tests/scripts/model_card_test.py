#!/usr/bin/env python3
"""scripts/figures/model_card.py on results written by hand: what its tables say, and what it
refuses."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "figures" / "model_card.py"


def run(*arguments, code=0):
    """What the script prints: on standard output, or on standard error where a code other than 0 is
    expected."""
    done = subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], capture_output=True,
                          text=True, check=False)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr}")
    return done.stdout if code == 0 else done.stderr


def scores(mse):
    return {"points": {"mse": mse}, "views": {"mse": mse / 2, "ssim": 0.5, "flip": 0.25}}


def worth(paths):
    of = {"all": paths, "interval": [paths - 1, paths + 1]}
    return {"points": of, "views": of}


class Card(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        data = self.folder / "boxes"
        data.mkdir()
        scenes = [{"split": split, "scene_points": points}
                  for split, points in (("train", 4096), ("train", 8192), ("val", 8192))]
        self.write("boxes/dataset.json", {"seed": 17, "scenes": scenes})
        lines = [{"step": 1, "loss": 0.5}, {"step": 1, "val_loss": 0.25},
                 {"step": 2000, "loss": 0.4}, {"step": 2000, "val_loss": 0.3}]
        (self.folder / "log.jsonl").write_text("\n".join(map(json.dumps, lines)))
        self.given = ["lte-x", "--log", self.folder / "log.jsonl", "--data", data]

    def write(self, name, content):
        (self.folder / name).write_text(json.dumps(content))
        return self.folder / name

    def result(self):
        paths = [{"neural": {"points": k, "views": 10 - k}} for k in range(5)]
        per_scene = [{"name": f"home_{k}", "equal_samples": of} for k, of in enumerate(paths)]
        return {"scenes": 5, "metrics": {"constant_mean": scores(4), "neural": scores(0.5)},
                "equal_samples": {"constant_mean": worth(3), "neural": worth(120)},
                "per_scene": per_scene}

    def test_says_what_it_learnt_from(self):
        card = run(*self.given)
        self.assertTrue(card.startswith("# lte-x\n"))
        self.assertIn("`boxes`: 3 scenes (2 train, 1 val) of the seed 17, 4,096 to 8,192 scene "
                      "points", card)
        self.assertIn("2,000 steps, training loss 0.400, validation loss 0.300 (least 0.250)", card)

    def test_has_a_row_a_predictor_and_the_worst_scenes(self):
        path = self.write("eval.json", self.result())
        card = run(*self.given, "--test", f"homes={path}")
        self.assertIn("| **lte-x, homes** | 0.500 | 0.250 | 0.500 | 0.250 | 120 (119 to 121) | "
                      "120 (119 to 121) |", card)
        self.assertIn("| constant mean | 4.00 | 2.00 | 0.500 | 0.250 | 3.00 | 3.00 |", card)
        self.assertNotIn("denoised", card)
        self.assertIn("Worst: `home_4` 6.00 a pixel, 4.00 a point; `home_3` 7.00 a pixel", card)
        self.assertNotIn("home_1", card)

    def test_has_maps_beside_harmonics(self):
        errors = {"logrel": 0.5, "log_mse": 0.25, "mse": 128}
        fits = [{"degree": degree, **errors} for degree in (5, 6, 12)]
        path = self.write("maps.json", {"scenes": 1, "neural": errors, "even": errors,
                                        "harmonics": {"least_squares": fits}})
        card = run(*self.given, "--maps", f"rooms={path}")
        self.assertIn("| maps of 1 scene | logrel | log_mse | mse |", card)
        self.assertIn("| **lte-x, rooms** | 0.500 | 0.250 | 128 |", card)
        self.assertEqual(card.count("spherical harmonics"), 2)

    def test_writes_how_the_model_was_made(self):
        with open(self.folder / "log.jsonl", "a", encoding="utf-8") as log:
            log.write('\n{"step": 600, "loss": 0.2}')
        out = self.folder / "made.json"
        run(*self.given, "--provenance", out, "--command", "make it")
        made = json.loads(out.read_text())
        self.assertEqual((made["model"], made["command"]), ("lte-x", "make it"))
        self.assertEqual(made["data"], [{"name": "boxes", "seed": 17,
                                         "scenes": {"train": 2, "val": 1},
                                         "scene_points": [4096, 8192]}])
        self.assertEqual(made["runs"], [{"steps": 2000, "loss": 0.4, "val_loss": 0.3},
                                        {"steps": 600, "loss": 0.2}])
        self.assertIn("--command", run(*self.given, "--provenance", out, code=2))

    def test_refuses_what_is_missing_in_one_line(self):
        result = self.result()
        del result["per_scene"]
        path = self.write("eval.json", result)
        for arguments, words in (
                (("--test", f"homes={path}"), ("eval.json", "per_scene")),
                (("--test", f"homes={self.folder / 'none.json'}"), ("none.json",)),
                (("--maps", f"rooms={self.folder / 'log.jsonl'}"), ("log.jsonl", "JSON"))):
            error = run(*self.given, *arguments, code=1)
            self.assertEqual(error.count("\n"), 1, error)
            for word in words:
                self.assertIn(word, error)
        self.assertIn("TITLE=FILE", run(*self.given, "--test", path, code=2))


if __name__ == "__main__":
    unittest.main()
