"""The row of growth: error against steps, scenes and parameters, with power laws fitted."""
import json
import math
import statistics

from error_time import Axis, text

from .words import digits

# Student's t of 95 %, two-sided, by degrees of freedom.
STUDENT = (12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23, 2.20, 2.18)
LOG = "assets/models/lte-paper.log.jsonl"
PAPERS = {"steps": 2e6, "scenes": 12510, "parameters": 41.9e6}  # what the paper trained
WIDTH, HEIGHT, LEFT, GAP, TOP, BOTTOM = 270, 220, 40, 20, 22, 36  # of a panel


def power_law(points):
    """The exponent of a line through logarithms, and half its 95 % interval.

    @param points  pairs of abscissa and error, three at least
    """
    xs, ys = ([math.log(value) for value in values] for values in zip(*points))
    mx, my = statistics.fmean(xs), statistics.fmean(ys)
    spread = sum((x - mx) ** 2 for x in xs)
    slope = sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / spread
    rest = sum((y - my - slope * (x - mx)) ** 2 for x, y in zip(xs, ys))
    freedom = len(points) - 2
    student = STUDENT[min(freedom, len(STUDENT)) - 1]
    return slope, student * math.sqrt(rest / freedom / spread)


def validation(root):
    """Steps of lte-paper, the paper's network at width 32, and its error in rooms that validate."""
    found = [json.loads(line) for line in (root / LOG).read_text().splitlines()]
    return [(each["step"], each["val_mse"]) for each in found if "val_mse" in each]


def steps(root):
    return [{"kind": "steps", "value": step, "seed": "lte-paper", "mse": mse}
            for step, mse in validation(root)]


def kinds_of(rows):
    return [kind for kind in PAPERS if any(row["kind"] == kind for row in rows)]


def law_of(rows, kind):
    return power_law([(row["value"], row["mse"]) for row in rows if row["kind"] == kind])


def panel(rows, kind, left):
    """Dots, the law through them, and a dashed line where the paper stands."""
    points = [(row["value"], row["mse"]) for row in rows if row["kind"] == kind]
    slope, half = power_law(points)
    middle = [statistics.fmean(map(math.log, values)) for values in zip(*points)]

    def law(x):
        return math.exp(middle[1] + slope * (math.log(x) - middle[0]))
    xs = [x for x, _ in points]
    across = Axis([*xs, PAPERS[kind]], left + LEFT, left + WIDTH - GAP)
    up = Axis([y for _, y in points] + [law(x) for x in (min(xs), PAPERS[kind])],
              HEIGHT - BOTTOM, TOP)
    x = across(PAPERS[kind])
    out = [f'<rect x="{left + LEFT}" y="{TOP}" width="{WIDTH - GAP - LEFT}" '
           f'height="{HEIGHT - BOTTOM - TOP}" fill="none" stroke="#aaa"/>',
           f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#999" stroke-dasharray="4 3"/>',
           text(x - 4, TOP + 12, "paper", "end", "#777777")]
    for first, last, dashes in ((min(xs), max(xs), ""), (max(xs), PAPERS[kind], ' '
                                                         'stroke-dasharray="2 3"')):
        out.append(f'<path d="M{across(first):.1f} {up(law(first)):.1f}L{across(last):.1f} '
                   f'{up(law(last)):.1f}" stroke="#d9541e"{dashes}/>')
    out += [f'<circle cx="{across(a):.1f}" cy="{up(b):.1f}" r="3" fill="#1f6fb4"/>'
            for a, b in points]
    out += [text(left + LEFT - 4, up(value) + 4, f"{value:g}", "end") for value in up.ticks()]
    out += [text(across(value), HEIGHT - BOTTOM + 14, f"{value:,.0f}", "middle")
            for value in (min(xs), max(xs))]
    words = f"{kind}: exponent {digits(slope, 2)} ± {digits(half, 2)}"
    return [*out, text(left + LEFT, TOP - 8, words)]


def chart(rows):
    width = WIDTH * len(kinds_of(rows))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * width}" '
           f'viewBox="0 0 {width} {HEIGHT}" '
           'font-family="sans-serif" font-size="11">',
           '<rect width="100%" height="100%" fill="#fff"/>']
    for i, kind in enumerate(kinds_of(rows)):
        out += panel(rows, kind, i * WIDTH)
    return "\n".join([*out, "</svg>", ""])


def line(rows):
    parts = []
    for kind in kinds_of(rows):
        slope, half = law_of(rows, kind)
        values = [row["value"] for row in rows if row["kind"] == kind]
        parts.append(f"{kind} {min(values):,} to {max(values):,}: exponent {digits(slope, 2)} ± "
                     f"{digits(half, 2)}")
    left = [kind for kind in PAPERS if kind not in kinds_of(rows)]
    return "MSE by " + "; ".join(parts) + (f"; by {' and '.join(left)} not run" if left else "")
