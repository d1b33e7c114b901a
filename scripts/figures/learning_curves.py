#!/usr/bin/env python3
"""Compares runs of lte_train: a table of their errors, validation error against steps, and, where
runs have different numbers of scenes, final error against these.

  scripts/figures/learning_curves.py runs/small runs/large
  scripts/figures/learning_curves.py 100=runs/a 1000=runs/b --eval 100=a.json --eval 1000=b.json
  --out curves.svg

A run is a run directory or its log.jsonl, with a name before it or that of its folder. --eval adds
the figures of a file that `lte_eval --json` has written for the run's model. The number of training
scenes is that of the data set in the run's config.yaml, where it is found, or as --scenes says. The
table is Markdown. An .svg needs Python alone, a .png matplotlib.
"""
import argparse
import html
import json
import math
import pathlib
import re
import sys

COLORS = ("#1f6fb4", "#d9541e", "#2b9348", "#8c4fb3", "#b8860b", "#0e9aa7", "#a83252", "#555555")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM, LINE = 460, 320, 62, 14, 26, 40, 15
EVAL_COLUMNS = (("points MSE", lambda e: e["metrics"]["neural"]["points"]["mse"]),
                ("views MSE", lambda e: e["metrics"]["neural"]["views"]["mse"]),
                ("views SSIM", lambda e: e["metrics"]["neural"]["views"]["ssim"]),
                ("worth paths a point", lambda e: e["equal_samples"]["neural"]["points"]["all"]),
                ("worth paths a pixel", lambda e: e["equal_samples"]["neural"]["views"]["all"]))


def fail(message):
    print(f"learning_curves.py: {message}", file=sys.stderr)
    raise SystemExit(1)


def read_log(path):
    """Lines of the log; what is no object with a step is left out, as the last line may have been
    cut short."""
    try:
        text = path.read_text()
    except OSError as error:
        fail(f"{path}: {error.strerror}")
    lines = []
    for line in text.splitlines():
        try:
            record = json.loads(line)
        except ValueError:
            continue
        if isinstance(record, dict) and isinstance(record.get("step"), int):
            lines.append(record)
    if not lines:
        fail(f"{path}: tells nothing yet; is it the log of a run?")
    return lines


def read_json(path):
    try:
        return json.loads(path.read_text())
    except OSError as error:
        fail(f"{path}: {error.strerror}")
    except ValueError as error:
        fail(f"{path}: not JSON: {error}")


def scenes_of_data(run):
    """Training scenes of the data set that config.yaml beside the log names; None where that cannot
    be told."""
    try:
        config = (run / "config.yaml").read_text()
        block = re.search(r"^data:\n((?:[ \t].*\n|\n)*)", config, re.MULTILINE).group(1)
        root = re.search(r"^\s+root:\s*(.*?)\s*$", block, re.MULTILINE).group(1).strip("\"'")
        entries = json.loads((pathlib.Path(root) / "dataset.json").read_text())["scenes"]
        return sum(entry["split"] == "train" for entry in entries)
    except (OSError, AttributeError, ValueError, KeyError, TypeError):
        return None


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def series(log, field):
    return [(line["step"], line[field]) for line in log if is_number(line.get(field))]


def named(text, flag):
    name, equals, value = text.partition("=")
    if not equals or not name or not value:
        fail(f'{flag} "{text}": expected NAME=VALUE with the name of a run')
    return name, value


class Run:
    def __init__(self, text):
        name, equals, path = text.partition("=")
        folder = pathlib.Path(path if equals else text)
        log = folder if folder.suffix == ".jsonl" else folder / "log.jsonl"
        self.name = name if equals else log.resolve().parent.name
        self.log = read_log(log)
        self.scenes = scenes_of_data(log.parent)
        self.evaluation = None

    def last(self, field):
        points = series(self.log, field)
        return points[-1][1] if points else None


def read_runs(args):
    runs = {}
    for text in args.runs:
        run = Run(text)
        if run.name in runs:
            fail(f'two runs are named "{run.name}"; name them: NAME={text}')
        runs[run.name] = run
    for flag, texts in (("--eval", args.eval), ("--scenes", args.scenes)):
        for text in texts:
            name, value = named(text, flag)
            if name not in runs:
                fail(f'{flag} "{text}": no run is named "{name}" (there are: {", ".join(runs)})')
            if flag == "--eval":
                runs[name].evaluation = read_json(pathlib.Path(value))
            elif not value.isdigit() or int(value) < 1:
                fail(f'{flag} "{text}": expected a number of scenes of 1 or more')
            else:
                runs[name].scenes = int(value)
    return list(runs.values())


def eval_value(run, figure):
    """None where the run has no evaluation, or that figure could not be measured."""
    if run.evaluation is None:
        return None
    try:
        value = figure(run.evaluation)
    except (KeyError, TypeError):
        return None
    return value if is_number(value) else None


def cell(value):
    return f"{value:.4g}" if is_number(value) and not isinstance(
        value, int) else "–" if value is None else str(value)


def table(runs, metric):
    evaluated = any(run.evaluation is not None for run in runs)
    columns = EVAL_COLUMNS if evaluated else ()
    lines = [
        "| " + " | ".join(["run", "scenes", "steps", "hours", "loss", metric, "lowest", "at step"] +
                          [name for name, _ in columns]) + " |"
    ]
    lines.append("|---" + "|---:" * (7 + len(columns)) + "|")
    for run in runs:
        points = series(run.log, metric)
        best = min(points, key=lambda point: point[1]) if points else (None, None)
        seconds = run.last("seconds")
        row = [
            run.scenes,
            max(line["step"] for line in run.log), None if seconds is None else seconds / 3600,
            run.last("loss"),
            run.last(metric), best[1], best[0], *(eval_value(run, figure) for _, figure in columns)
        ]
        lines.append("| " +
                     " | ".join([run.name.replace("|", "\\|")] + [cell(value) for value in row]) +
                     " |")
    return "\n".join(lines) + "\n"


def panels(runs, metric):
    """(title, label of x, whether x is logarithmic, lines): a line is (name, points)."""
    curves = [(run.name, series(run.log, metric)) for run in runs]
    final = [("last " + metric, [(run.scenes, run.last(metric)) for run in runs])]
    final += [("lte_eval, " + name, [(run.scenes, eval_value(run, figure))
                                     for run in runs])
              for name, figure in EVAL_COLUMNS[:2]]
    drawn = []
    for name, points in final:
        known = sorted(point for point in points if None not in point)
        if known:
            drawn.append((name, known))
    by_step = (f"{metric} by step", "step", False, curves)
    if len({scenes for _, points in drawn for scenes, _ in points}) < 2:
        return [by_step]
    return [by_step, ("final error by scenes", "training scenes", True, drawn)]


def ticks(low, high, logarithmic):
    """Places on an axis and what stands there; those of a logarithmic axis are logarithms."""
    if logarithmic:
        digits = (1,) if math.floor(high) - math.ceil(low) >= 2 else (1, 2, 5)
        values = [
            digit * 10.0 ** decade for decade in range(math.floor(low),
                                                       math.ceil(high) + 1) for digit in digits
        ]
        places = [(math.log10(value), f"{value:g}")
                  for value in values
                  if low <= math.log10(value) <= high]
        if len(places) < 2:  # less than one digit to the next
            places = [
                (math.log10(value), word) for value, word in ticks(10 ** low, 10 ** high, False)
            ]
        return places
    power = 10 ** math.floor(math.log10((high - low) / 5))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= (high - low) / 5)
    return [(i * step, f"{i * step:g}") for i in range(math.ceil(low / step),
                                                       math.floor(high / step) + 1)]


def svg_panel(left, title, label, log_x, lines):
    to_x = math.log10 if log_x else float
    placed = [
        (name, [(to_x(x), math.log10(y)) for x, y in points if y > 0]) for name, points in lines
    ]
    placed = [(name, points) for name, points in placed if points]
    text = lambda x, y, anchor, what, color="#555": (
        f'<text x="{left + x:.1f}" y="{y:.1f}" text-anchor="{anchor}" '
        f'fill="{color}">{html.escape(what)}</text>'
    )
    out = [
        text(WIDTH / 2, 16, "middle", title, "#222"),
        text(WIDTH / 2, HEIGHT - 6, "middle", label)
    ]
    if not placed:
        return out + [text(WIDTH / 2, HEIGHT / 2, "middle", "nothing recorded")]
    ranges = []
    for axis in (0, 1):
        values = [point[axis] for _, points in placed for point in points]
        margin = 0 if max(values) > min(values) else 0.05 * abs(values[0]) or 1
        ranges.append((min(values) - margin, max(values) + margin))
    (x0, x1), (y0, y1) = ranges
    place_x = lambda x: LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)
    place_y = lambda y: HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)
    for value, word in ticks(y0, y1, True):
        out.append(
            f'<path stroke="#e4e4e4" '
            f'd="M{left + LEFT} {place_y(value):.1f}H{left + WIDTH - RIGHT}"/>'
        )
        out.append(text(LEFT - 5, place_y(value) + 4, "end", word))
    for value, word in ticks(x0, x1, log_x):
        out.append(
            f'<path stroke="#e4e4e4" d="M{left + place_x(value):.1f} {TOP}V{HEIGHT - BOTTOM}"/>')
        out.append(text(place_x(value), HEIGHT - BOTTOM + 14, "middle", word))
    for i, (name, points) in enumerate(placed):
        color = COLORS[i % len(COLORS)]
        path = [(left + place_x(x), place_y(y)) for x, y in points]
        joined = " ".join(f"{x:.1f},{y:.1f}" for x, y in path)
        out.append(f'<polyline fill="none" stroke-width="1.5" stroke="{color}" points="{joined}"/>')
        if log_x or len(path) == 1:
            out += [f'<circle r="3" fill="{color}" cx="{x:.1f}" cy="{y:.1f}"/>' for x, y in path]
        out.append(text(LEFT, HEIGHT + LINE * (i + 1), "start", name, color))
    return out


def write_svg(path, drawings):
    height = HEIGHT + LINE * (1 + max(len(lines) for *_, lines in drawings))
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH * len(drawings)}" height="{height}" font-family="sans-serif" '
        'font-size="11">', '<rect width="100%" height="100%" fill="#fff"/>'
    ]
    for i, drawing in enumerate(drawings):
        parts += svg_panel(WIDTH * i, *drawing)
    path.write_text("\n".join(parts) + "\n</svg>\n")


def write_png(path, drawings):
    try:
        import matplotlib
    except ImportError:
        fail(f"{path}: a .png needs matplotlib; an .svg does not")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(drawings), figsize=(4.6 * len(drawings), 3.6))
    for axis, (title, label, log_x, lines) in zip(axes, drawings):
        for i, (name, points) in enumerate(lines):
            if points:
                axis.plot(*zip(*points), "o-" if log_x else "-", color=COLORS[i % len(COLORS)],
                          markersize=4, linewidth=1.2, label=name)
        axis.set_yscale("log")
        if log_x:
            axis.set_xscale("log")
        axis.set_title(title, fontsize=9)
        axis.set_xlabel(label, fontsize=8)
        axis.tick_params(labelsize=7)
        axis.grid(True, which="major", linewidth=0.3)
        if axis.lines:
            axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="[NAME=]RUN", help="run directory or log.jsonl")
    parser.add_argument("--eval", action="append", default=[], metavar="NAME=FILE",
                        help="what lte_eval --json wrote; may be repeated")
    parser.add_argument("--scenes", action="append", default=[], metavar="NAME=N",
                        help="training scenes of a run; may be repeated")
    parser.add_argument(
        "--metric", default="val_loss",
        help="field of the log, an error: val_loss, val_loss_median, val_mse, val_relmse")
    parser.add_argument("--out", type=pathlib.Path, help="plot: .svg, or .png with matplotlib")
    args = parser.parse_args()
    if args.out and args.out.suffix not in (".svg", ".png"):
        parser.error(f"--out {args.out}: expected a name that ends in .svg or .png")
    runs = read_runs(args)
    if not any(series(run.log, args.metric) for run in runs):
        fields = sorted(
            {field for run in runs for line in run.log
             for field in line if is_number(line[field])} - {"step"})
        fail(f'--metric {args.metric}: no run has logged it (there are: {", ".join(fields)})')
    if args.out:
        try:
            (write_svg if args.out.suffix == ".svg" else write_png)(args.out,
                                                                    panels(runs, args.metric))
        except OSError as error:
            fail(f"{args.out}: {error.strerror}")
    print(table(runs, args.metric), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
