#!/usr/bin/env python3
"""Prints a model's card, in Markdown: its data, its training, and its errors.

usage: scripts/figures/model_card.py NAME --log LOG --data DATA [DATA ...]
           [--test TITLE=EVAL.json ...] [--maps TITLE=INCIDENT.json ...]
           [--provenance OUT.json --command COMMAND]

LOG is the log.jsonl of a training, each DATA a data set that it read, EVAL.json and INCIDENT.json
what `lte_eval --json` and `experiment_directions --json` have written. OUT.json takes how the model
was made: COMMAND, the commit, data sets with their seeds, and runs. It needs Python's standard
library alone.
"""
import argparse
import json
import pathlib
import subprocess
import sys

ROWS = (
    ("neural", None),
    ("neural_and_4_denoised", "with 4 denoised samples"),
    ("light_cache", "what it starts from, interpolated"),
    ("path_tracing_64", "path tracing, 64 samples"),
    ("path_tracing_64_denoised", "64 samples, denoised"),
    ("path_tracing_4_denoised", "4 samples, denoised"),
    ("constant_mean", "constant mean"),
)
MAP_ROWS = (
    ("neural", None),
    ("seen", "seen of the points"),
    ("even", "its irradiance from everywhere"),
)
MAP_METRICS = ("logrel", "log_mse", "mse")
WORST = 3


def number(value):
    if value is None:
        return ""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:#.3g}"


def table(head, rows):
    ruled = ["|" + "|".join(["---", *["---:"] * (len(head) - 1)]) + "|"]
    return "\n".join(
        [f"| {' | '.join(head)} |", *ruled, *(f"| {' | '.join(row)} |" for row in rows)])


def read_json(path):
    with open(path, encoding="utf-8") as file:
        try:
            return json.load(file)
        except ValueError as error:
            raise ValueError(f"{path}: is no JSON: {error}") from error


def plural(count, noun):
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def read_data(folder):
    """A data set: its name, seed, scenes by split, and scene points from least to most."""
    dataset = read_json(pathlib.Path(folder) / "dataset.json")
    scenes = dataset["scenes"]
    splits = {split: sum(s["split"] == split for s in scenes) for split in ("train", "val", "test")}
    points = [s["scene_points"] for s in scenes]
    return {"name": pathlib.Path(folder).name, "seed": dataset["seed"],
            "scenes": {split: count for split, count in splits.items() if count},
            "scene_points": [min(points), max(points)]}


def data_line(data):
    """A data set in words."""
    splits = ", ".join(f"{count:,} {split}" for split, count in data["scenes"].items())
    least, most = data["scene_points"]
    shown = f"{least:,}" if least == most else f"{least:,} to {most:,}"
    return (f"`{data['name']}`: {plural(sum(data['scenes'].values()), 'scene')} ({splits}) of the "
            f"seed {data['seed']}, {shown} scene points")


def read_log(log):
    with open(log, encoding="utf-8") as file:
        try:
            lines = [json.loads(line) for line in file if line.strip()]
        except ValueError as error:
            raise ValueError(f"{log}: a line is no JSON: {error}") from error
    if not any("loss" in line for line in lines):
        raise ValueError(f"{log}: has no step")
    return lines


def training_runs(lines):
    """Steps and last losses of each run in a log: a step below the one before begins another."""
    runs, last = [], None
    for line in lines:
        if last is None or line["step"] < last:
            runs.append({})
        last = line["step"]
        runs[-1].update({key: line[key] for key in ("step", "loss", "val_loss") if key in line})
    return [{"steps": run.pop("step"), **run} for run in runs]


def commit():
    """The revision of the sources, marked if they were changed; None outside of a repository."""
    root = pathlib.Path(__file__).resolve().parents[2]
    git = subprocess.run(["git", "-C", root, "describe", "--always", "--dirty",
                          "--abbrev=40", "--exclude=*"], capture_output=True, text=True,
                         check=False)
    return git.stdout.strip() if git.returncode == 0 else None


def training_line(lines):
    steps = [line for line in lines if "loss" in line]
    validations = [line["val_loss"] for line in lines if "val_loss" in line]
    out = f"{plural(steps[-1]['step'], 'step')}, training loss {number(steps[-1]['loss'])}"
    if validations:
        out += f", validation loss {number(validations[-1])} (least {number(min(validations))})"
    return out


def test_table(name, title, result):
    worth, metrics = result["equal_samples"], result["metrics"]
    rows = []
    for key, label in ROWS:
        if key not in metrics:
            continue
        points, views = metrics[key]["points"], metrics[key]["views"]
        ends = worth.get(key, {"points": {}, "views": {}})
        paths = []
        for part in ("points", "views"):
            text = number(ends[part].get("all"))
            interval = ends[part].get("interval") or [None, None]
            if key == "neural" and None not in interval:
                text += f" ({number(interval[0])} to {number(interval[1])})"
            paths.append(text)
        errors = [number(points["mse"]), *(number(views[k]) for k in ("mse", "ssim", "flip"))]
        rows.append([f"**{name}, {title}**" if label is None else label, *errors, *paths])
    head = [f"mean over {plural(result['scenes'], 'scene')} (95 %)", "MSE points", "MSE views",
            "SSIM views", "FLIP views", "spp, points", "spp, views"]
    scenes = [(s["equal_samples"]["neural"], s["name"]) for s in result["per_scene"]]
    scenes = sorted((s for s in scenes if s[0]["views"] is not None), key=lambda s: s[0]["views"])
    worst = "; ".join(f"`{scene}` {number(of['views'])} a pixel, {number(of['points'])} a point"
                      for of, scene in scenes[:WORST])
    return table(head, rows) + (f"\n\nWorst: {worst}." if worst else "")


def map_table(name, title, result):
    rows = [[f"**{name}, {title}**" if label is None else label,
             *(number(result[key][metric]) for metric in MAP_METRICS)]
            for key, label in MAP_ROWS if key in result]
    for fit in result["harmonics"].get("least_squares", []):
        if fit["degree"] in (6, 12):
            rows.append([f"spherical harmonics, l ≤ {fit['degree']}, fitted to the truth",
                         *(number(fit[metric]) for metric in MAP_METRICS)])
    return table([f"maps of {plural(result['scenes'], 'scene')}", *MAP_METRICS], rows)


def titled(text):
    title, equals, path = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"expected TITLE=FILE, got {text!r}")
    return title, path


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name")
    parser.add_argument("--log", required=True)
    parser.add_argument("--data", nargs="+", required=True)
    parser.add_argument("--test", type=titled, action="append", default=[])
    parser.add_argument("--maps", type=titled, action="append", default=[])
    parser.add_argument("--provenance")
    parser.add_argument("--command")
    args = parser.parse_args()
    if (args.provenance is None) != (args.command is None):
        parser.error("--provenance and --command go together")
    data, log = [read_data(folder) for folder in args.data], read_log(args.log)
    facts = [["data", "; ".join(map(data_line, data))], ["training", training_line(log)]]
    parts = [f"# {args.name}", table(["", ""], facts)]
    for make, results in ((test_table, args.test), (map_table, args.maps)):
        for title, path in results:
            try:
                parts.append(make(args.name, title, read_json(path)))
            except KeyError as missing:
                raise ValueError(f"{path}: has no {missing}") from missing
    if args.provenance:
        made = {"model": args.name, "made_by": "one script", "command": args.command,
                "commit": commit(), "data": data, "runs": training_runs(log)}
        pathlib.Path(args.provenance).write_text(json.dumps(made, indent=2) + "\n",
                                                 encoding="utf-8")
    print("\n\n".join(parts))


if __name__ == "__main__":
    try:
        main()
    except OSError as error:
        sys.exit(f"model_card.py: {error.filename}: {error.strerror}")
    except ValueError as error:
        sys.exit(f"model_card.py: {error}")
