#!/usr/bin/env python3
"""Runs the program of one experiment on a tiny input and checks a number that it writes.

usage: experiments/smoke.py BUILD SUBJECT
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCENES, MODELS = ROOT / "assets/scenes", ROOT / "assets/models"
BOX = SCENES / "cornell_box.glb"
RIVALS = ROOT / "experiments/paper/rivals.yaml"  # of the training of other papers' networks


class Subject:
    def __init__(self, build, name, folder):
        self.bin, self.name, self.folder = build / "bin", name, folder

    def tool(self, name, *arguments):
        words = [self.bin / name, *map(str, arguments)]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{name} ended with {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def run(self, *arguments):
        """The JSON that the program of this subject writes."""
        out = self.folder / "out.json"
        self.tool(f"experiment_{self.name}", *arguments, "--quiet", "--json", out)
        return json.loads(out.read_text())


def check(holds, what):
    if not holds:
        sys.exit(f"smoke.py: {what}")
    print(f"holds: {what}")


def attention(subject):
    picture = subject.folder / "attention.png"
    result = subject.run(BOX, "--point", "0.28,0,0.28", "--size", "32x24", "--out", picture)
    check(abs(result["sum"] - result["read"]) < 1e-3 * result["read"],
          f"weights of {result['read']} latents have mean 1 (sum {result['sum']})")
    check(picture.stat().st_size > 200, "there is a picture")


def consistency(subject):
    result = subject.run(BOX, "--size", "24x16", "--frames", 2, "--degrees", 3, "--spp", 2)
    check(result["answers"] > 10, f"{result['answers']} answers are compared")
    check(result["largest_change"] == 0, "the network's answers at a point do not change")


def directions(subject):
    data = subject.folder / "data"
    subject.tool("lte_datagen", "generate", "--config", ROOT / "configs/data/glossy_test.yaml",
                 "--out", data, "--scenes", 1, "--set", "incident.points=4", "--set",
                 "incident.samples=32", "--set", "rays=16", "--quiet")
    result = subject.run("--checkpoint", MODELS / "lte-radiance.safetensors", "--data", data,
                         "--traced", data)
    check(result["traced"]["mse"] == 0, "a data set has no error against itself")
    fits = result["harmonics"]["least_squares"]
    errors = [fit["mse"] for fit in fits]
    check(all(b < a for a, b in zip(errors, errors[1:])),
          f"error of {len(fits)} fits by harmonics falls with the degree")
    check(0 < result["neural"]["logrel"] < result["even"]["logrel"],
          "the network's maps are closer than its irradiance from everywhere")


def gathered_base(subject):
    result = subject.run(BOX, "--points", 200, "--paths", 64, "--records", 500, "--rays", "4,64")
    worth = {(row["name"], row["rays"]): row["worth"] for row in result["answers"]}
    for table in result["tables"]:
        name = table["name"]
        check(worth[name, 64] > 2 * worth[name, 4] > 0, f"{name}: more rays have less error")
    ratio = {(row["name"], row["rays"]): row["mean_ratio"] for row in result["answers"]}
    sweeps = [ratio[f"swept-{count}", 64] for count in (1, 2, 3)]
    check(sweeps == sorted(sweeps) and sweeps[0] < 0.95, "each sweep adds the next reflection")
    check(abs(ratio["raw", 64] - 1) < 0.05, "rays that read traced light have the paths' mean")


def guiding(subject):
    rows = subject.run(SCENES / "guiding_screen.glb", "--checkpoint",
                       MODELS / "lte-radiance.safetensors", "--size", "16x12", "--columns", 4,
                       "--rows", 3, "--paths", 2048, "--points", 128, "--radius", 1)
    plain = rows[0]["mean"]
    for row in rows:
        if "irradiance" in row["name"]:
            continue
        error = 5 * (row["relative_variance_8"] * 8 / 2048 / 12) ** 0.5 + 0.02
        check(abs(row["mean"] / plain - 1) < error,
              f"{row['name']}: mean within {100 * error:.1f} % of unguided paths")


def paper(subject):
    stored, fused = (subject.run("memory", "--network", "vanilla", "--primitives", 2048, "--side",
                                 8, "--channels", 32, "--attention", how)["peak_rss_mb"]
                     for how in ("stored", "fused"))
    check(stored > fused + 14 * 2048 ** 2 * 4 / 2 ** 20,
          f"attention that is stored takes more memory ({stored:.0f} MB) than fused ({fused:.0f})")
    sample = subject.folder / "box.safetensors"
    subject.tool("lte_datagen", "bake", BOX, "--out", sample, "--queries", 2000, "--rays", 64,
                 "--scene-points", 1024, "--views", 0, "--quiet")
    for method in ("grid", "latents-mean", "latents-decoder"):
        result = subject.run("by-heart", sample, "--method", method, "--seconds", 2, "--batch", 512)
        last = result["looks"][-1]["held_out_relmse"]
        check(last < 0.6 * result["first_relmse"], f"{method} learns the box: error {last:.3f}")
    data = subject.folder / "data"
    subject.tool("lte_datagen", "generate", "--config", ROOT / "configs/data/boxes_small.yaml",
                 "--out", data, "--scenes", 8, "--set", "rays=16", "--set", "query_points=256",
                 "--set", "scene_points=256", "--set", "val_share=0.25", "--set",
                 "test_share=0.25", "--set", "evaluation_splits=[train,test]", "--set",
                 "views.width=32", "--set", "views.height=24", "--set", "views.rays=64", "--set",
                 "light_paths=8", "--glb", "--quiet")
    known = {"vanilla": 189475, "encoder": 2569507, "whole": 2640579}  # parameters at width 32
    for network, parameters in known.items():
        result = subject.run("roadmap", "--network", network, "--config", RIVALS, "--data", data,
                             "--steps", 20, "--looks", 2, "--set", "data.scene_points=256", "--set",
                             "data.queries_per_scene=128", "--set", "train.warmup_steps=2")
        check(result["parameters"] == parameters, f"{network} has {parameters} parameters")
        check(0 < result["loss"] < 1.5 * result["first_loss"] and
              result["loss"] != result["first_loss"], f"{network} is trained, and stays sane")
        check([look["step"] for look in result["looks"]] == [10, 20] and
              result["test"]["scenes"] == 2, "there are two looks, and a test")
    rivals(subject, data)


def rivals(subject, data):
    """Networks of other papers, gathered light and draws of points, on the views of boxes."""
    shading = {seconds: subject.run("deep-shading", "--data", data, "--split", "test", "--test",
                                    data, "--seconds", seconds) for seconds in (0.5, 5)}
    check(shading[5]["parameters"] == 133489, "Deep Shading has the authors' parameters")
    check(shading[5]["ssim"] > shading[0.5]["ssim"] and
          shading[5]["mse"] < 0.8 * shading[0.5]["mse"],
          f"it learns two views by heart: SSIM {shading[5]['ssim']:.3f}")
    points = subject.run("hermosilla", "--config", RIVALS, "--data", data, "--test", data, "--also",
                         data, "--seconds", 4, "--tuned-seconds", 4, "--set",
                         "data.scene_points=256", "--set", "data.queries_per_scene=128")
    check(points["tuned"]["mse"] < points["mse"], "the point network learns from a scene's points")
    check(points["also"][0]["mse"] == points["mse"],
          "what was tuned to scenes does not answer the next data set")
    gathered = subject.run("gathered", "--data", data)
    check(gathered["worth"] > 16 and gathered["denoised"]["worth"] > gathered["worth"],
          f"16 gathered rays are worth {gathered['worth']:.0f} paths, and more when denoised")
    check(gathered["mse"] < 0.5 * points["mse"], "and nearer than a network of seconds")
    draws = {row["draw"]: row for row in
             subject.run("sampling", "--data", data, "--checkpoint",
                         MODELS / "lte.safetensors", "--candidates", 4096, "--points", 1024)}
    check(len(draws) == 5 and draws["area"]["ratio"] == 1, "five draws are compared")
    check(all(abs(row["points"] - 1024) < 8 and 0.2 < row["ratio"] < 5 for row in draws.values()),
          "each has the points that were asked for, and a sane error")


def replay(subject):
    rows = subject.run(BOX, "--points", 50, "--paths", 32, "--seconds", 0.01)
    stopped = {row["stopped"] for row in rows if "stopped" in row}
    check(len(rows) == 11 and len(stopped) == 1 and stopped.pop() > 1000,
          "every entry point stops the same rays")


def sampling(subject):
    table = subject.tool("experiment_sampling", BOX, "--rays", 64, "--points", 8, "--repeats", 4,
                         "--reference-rays", 1024)
    gains = [float(line.split("|")[6]) for line in table.splitlines()
             if line.startswith("| stratification")]
    check(len(gains) == 1 and gains[0] > 1,
          f"stratified paths are worth {gains} times as many independent ones")


def stability(subject):
    result = subject.run("--quick")
    check(result["holds"] and len(result["rows"]) > 20, "every row keeps its bound")
    check(all(row["non_finite"] == 0 for row in result["rows"]), "every answer is finite")


def main():
    subjects = {f.__name__: f for f in (attention, consistency, directions, gathered_base,
                                        guiding, paper, replay, sampling, stability)}
    if len(sys.argv) != 3 or sys.argv[2] not in subjects:
        sys.exit(f"{__doc__.strip()}\nsubjects: {', '.join(subjects)}")
    with tempfile.TemporaryDirectory() as folder:
        build = pathlib.Path(sys.argv[1]).resolve()
        subjects[sys.argv[2]](Subject(build, sys.argv[2], pathlib.Path(folder)))


if __name__ == "__main__":
    main()
