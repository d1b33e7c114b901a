"""What a room begins with: floor, ceiling and walls over a plan, pictures for surfaces, and the
usual colors."""
import math
import random

from .shapes import Mesh, merged, polygon, sheet

COLORS = {
    "white": (0.8, 0.8, 0.78), "cream": (0.75, 0.69, 0.55), "grey": (0.45, 0.45, 0.46),
    "black": (0.05, 0.05, 0.05), "oak": (0.46, 0.31, 0.17), "walnut": (0.2, 0.11, 0.06),
    "pine": (0.62, 0.45, 0.26), "red": (0.55, 0.08, 0.06), "blue": (0.09, 0.18, 0.45),
    "green": (0.13, 0.35, 0.12), "leaf": (0.08, 0.26, 0.06), "yellow": (0.72, 0.5, 0.08),
    "brass": (0.5, 0.38, 0.15), "steel": (0.35, 0.36, 0.38), "terracotta": (0.5, 0.2, 0.1),
    "linen": (0.85, 0.83, 0.78), "concrete": (0.35, 0.34, 0.32), "pink": (0.7, 0.36, 0.4),
    "turquoise": (0.1, 0.42, 0.42), "plum": (0.25, 0.07, 0.22),
}


class Palette:
    """Materials by the names of COLORS, made when first used."""
    def __init__(self, doc, **other):
        self.doc, self.colors, self.numbers = doc, {**COLORS, **other}, {}

    def __getitem__(self, name):
        if name not in self.numbers:
            self.numbers[name] = self.doc.material(name, self.colors[name])
        return self.numbers[name]


def lamp(doc, name, radiance, double_sided=True):
    return doc.material(name, (0.7, 0.7, 0.7), emission=radiance, double_sided=double_sided)


def panel(x0, z0, x1, z1, y):
    """A sheet that faces down."""
    return Mesh().face([(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)])


def shell(doc, plan, height, floor, wall, ceiling, openings=None, winding="in", reveal=0.12):
    """A floor, a ceiling and a wall per edge of a plan, (x, z) counter-clockwise from above.

    openings: {edge: [(from, to, sill, top), ...]}; winding: fronts "in", "out", or "mixed", where
    every other wall and the ceiling face outwards. wall is a material or one per edge."""
    walls = wall if isinstance(wall, list) else [wall] * len(plan)
    out = lambda k: winding == "out" or winding == "mixed" and k % 2
    wound = lambda mesh, k: mesh.flipped() if out(k) else mesh
    doc.add("floor", wound(polygon(plan, 0.0), 0), floor)
    if ceiling is not None:
        doc.add("ceiling", wound(polygon(plan, height).flipped(), 1), ceiling)
    for k, (a, b) in enumerate(zip(plan, plan[1:] + plan[:1])):
        if walls[k] is None:
            continue
        holes = (openings or {}).get(k, ())
        doc.add(f"wall {k}", wound(sheet(a, b, height, holes, reveal), k), walls[k])


def skirting(doc, plan, material, openings=None, height=0.08):
    """A board in front of the walls of a plan, but for its doors."""
    parts = []
    for k, (a, b) in enumerate(zip(plan, plan[1:] + plan[:1])):
        length = math.hypot(b[0] - a[0], b[1] - a[1])
        aside = (0.012 * (b[1] - a[1]) / length, -0.012 * (b[0] - a[0]) / length)
        doors = [hole for hole in (openings or {}).get(k, ()) if hole[2] == 0]
        parts.append(sheet(*[(p[0] + aside[0], p[1] + aside[1]) for p in (a, b)], height, doors))
    doc.add("skirting", merged(parts), material)


def srgb(color):
    return tuple(round(255 * (12.92 * c if c <= 0.0031308 else 1.055 * c**(1 / 2.4) - 0.055))
                 for c in color)


def checker(a, b, side=16):
    """color_at of a picture: two by two squares of linear colors."""
    first, second = srgb(a), srgb(b)
    return lambda x, y: first if (2 * x // side + 2 * y // side) % 2 else second


def stripes(base, side=32, boards=4, seed=7):
    """Boards along y, each of its own shade, with grain and dark joints."""
    rng = random.Random(seed)
    shades = [rng.uniform(0.7, 1.15) for _ in range(boards)]
    grain = [rng.uniform(0.9, 1.1) for _ in range(side)]

    def color_at(x, y):
        board = x * boards // side
        joint = x % (side // boards) == 0 or y == board * side // boards
        k = shades[board] * grain[x] * (0.45 if joint else 1.0)
        return srgb(min(1.0, c * k) for c in base)

    return color_at


def rings(colors, side=32):
    """Circles about the middle, for rugs and canvases."""
    return lambda x, y: srgb(colors[int(math.hypot(x - side / 2 + 0.5, y - side / 2 + 0.5) * len(
        colors) * 1.3 / side) % len(colors)])


def landscape(side=32):
    """A sky, hills and a low sun: a canvas or what a screen shows."""
    def color_at(x, y):
        u, v = x / (side - 1), y / (side - 1)
        hill = 0.62 + 0.12 * math.sin(5 * u) + 0.05 * math.sin(17 * u + 1)
        if v > hill:
            return srgb((0.03 + 0.1 * (1 - v), 0.12 + 0.25 * (1 - v), 0.04))
        if math.hypot(u - 0.7, v - 0.4) < 0.12:
            return (255, 244, 214)
        return srgb((0.25 + 0.7 * v, 0.35 + 0.25 * v, 0.75 - 0.35 * v))

    return color_at
