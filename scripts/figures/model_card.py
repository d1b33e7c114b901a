#!/usr/bin/env python3
"""Prints a model's card, in Markdown: what it has learnt from, how long, and what it is worth.

usage: scripts/figures/model_card.py NAME --log LOG --data DATA [DATA ...]
           [--test TITLE=EVAL.json ...] [--maps TITLE=INCIDENT.json ...]

LOG is the log.jsonl of a training, each DATA a data set that it read, EVAL.json and INCIDENT.json
what `lte_eval --json` and `experiment_directions --json` have written. It needs Python's standard
library alone.
"""
import argparse
import json
import pathlib
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


def data_line(folder):
    """A data set in words."""
    dataset = read_json(pathlib.Path(folder) / "dataset.json")
    scenes = dataset["scenes"]
    splits = [f"{sum(s['split'] == split for s in scenes):,} {split}"
              for split in ("train", "val", "test") if any(s["split"] == split for s in scenes)]
    points = sorted({s["scene_points"] for s in scenes})
    shown = f"{points[0]:,}" if len(points) == 1 else f"{points[0]:,} to {points[-1]:,}"
    name = pathlib.Path(folder).name
    return (f"`{name}`: {plural(len(scenes), 'scene')} ({', '.join(splits)}) of the "
            f"seed {dataset['seed']}, {shown} scene points")


def training_line(log):
    with open(log, encoding="utf-8") as file:
        try:
            lines = [json.loads(line) for line in file if line.strip()]
        except ValueError as error:
            raise ValueError(f"{log}: a line is no JSON: {error}") from error
    steps = [line for line in lines if "loss" in line]
    if not steps:
        raise ValueError(f"{log}: has no step")
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
            "SSIM views", "FLIP views", "worth samples a point", "a pixel"]
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
    args = parser.parse_args()
    facts = [["data", "; ".join(map(data_line, args.data))], ["training", training_line(args.log)]]
    parts = [f"# {args.name}", table(["", ""], facts)]
    for make, results in ((test_table, args.test), (map_table, args.maps)):
        for title, path in results:
            try:
                parts.append(make(args.name, title, read_json(path)))
            except KeyError as missing:
                raise ValueError(f"{path}: has no {missing}") from missing
    print("\n\n".join(parts))


if __name__ == "__main__":
    try:
        main()
    except OSError as error:
        sys.exit(f"model_card.py: {error.filename}: {error.strerror}")
    except ValueError as error:
        sys.exit(f"model_card.py: {error}")
