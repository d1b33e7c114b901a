"""Furniture and fittings. Each function takes the document, a name, materials by number and a
place, `at` (x, z) with the floor at y = `floor`, turned by degrees about +y; at 0 fronts face +z.
"""
import random

from .shapes import Mesh, block, box, cylinder, lathe, merged, rod, rounded, sheet, sphere


def put(doc, name, mesh, material, at, turn=0.0, floor=0.0):
    doc.add(name, mesh, material, (at[0], floor, at[1]), turn)


def table(doc, name, wood, at, size=(1.4, 0.74, 0.8), turn=0.0, floor=0.0):
    w, h, d = size
    parts = [rounded((w, 0.04, d), 0.015, (0, h - 0.04, 0), 2)]
    for x in (-1, 1):
        parts += [block((0.06, h - 0.04, 0.06), (x * (w / 2 - 0.08), 0, z * (d / 2 - 0.08)))
                  for z in (-1, 1)]
        parts.append(block((0.025, 0.08, d - 0.22), (x * (w / 2 - 0.08), h - 0.13, 0)))
    put(doc, name, merged(parts), wood, at, turn, floor)


def round_table(doc, name, wood, at, radius=0.5, height=0.72, floor=0.0):
    profile = [(0, 0), (0.26, 0), (0.26, 0.02), (0.06, 0.06), (0.035, 0.3), (0.05, height - 0.08),
               (0.12, height - 0.03), (radius, height - 0.03), (radius, height), (0, height)]
    put(doc, name, lathe(profile, 32), wood, at, 0, floor)


def chair(doc, name, wood, at, turn=0.0, floor=0.0):
    parts = [rounded((0.44, 0.04, 0.42), 0.015, (0, 0.43, 0), 2)]
    for x in (-0.19, 0.19):
        parts.append(rod((x, 0, 0.18), (x * 0.9, 0.43, 0.16), 0.018, 8))
        parts.append(rod((x, 0, -0.2), (x * 0.92, 0.92, -0.24), 0.018, 8))
    parts += [block((0.34, 0.06, 0.02), (0, y, -0.225)) for y in (0.58, 0.72, 0.86)]
    put(doc, name, merged(parts), wood, at, turn, floor)


def stool(doc, name, wood, at, height=0.45, floor=0.0):
    parts = [cylinder(0.17, 0.035, (0, height - 0.035, 0))]
    parts += [rod((x, 0, z), (x * 0.6, height - 0.03, z * 0.6), 0.016, 8)
              for x in (-0.17, 0.17) for z in (-0.17, 0.17)]
    put(doc, name, merged(parts), wood, at, 0, floor)


def sofa(doc, name, cloth, pillow, at, width=1.9, turn=0.0):
    seats = 2 if width < 2 else 3
    each = (width - 0.4) / seats
    parts = [rounded((width, 0.28, 0.85), 0.05, (0, 0.1, 0)),
             rounded((width, 0.55, 0.22), 0.08, (0, 0.28, -0.32))]
    parts += [rounded((0.2, 0.42, 0.85), 0.07, (x * (width / 2 - 0.1), 0.2, 0)) for x in (-1, 1)]
    parts += [rounded((each - 0.02, 0.16, 0.6), 0.06, (each * (i + 0.5 - seats / 2), 0.36, 0.08))
              for i in range(seats)]
    parts += [cylinder(0.025, 0.1, (x * (width / 2 - 0.12), 0, z), 8)
              for x in (-1, 1) for z in (-0.35, 0.35)]
    put(doc, name, merged(parts), cloth, at, turn)
    for i, x in enumerate((-1, 1)):
        cushion = rounded((0.42, 0.4, 0.12), 0.055).pitched(-20).moved(
            x * (width / 2 - 0.45), 0.5, -0.1)
        put(doc, f"{name} cushion {i}", cushion, pillow, at, turn)


def bed(doc, name, wood, linen, blanket, at, size=(1.6, 2.0), turn=0.0):
    """The head is at -z."""
    w, d = size
    frame = [block((w + 0.08, 0.22, d + 0.08), (0, 0.1, 0)),
             rounded((w + 0.1, 0.9, 0.06), 0.025, (0, 0.1, -d / 2 - 0.06), 2)]
    frame += [block((0.07, 0.1, 0.07), (x * w / 2, 0, z * d / 2)) for x in (-1, 1) for z in (-1, 1)]
    put(doc, name, merged(frame), wood, at, turn)
    put(doc, f"{name} mattress", rounded((w, 0.2, d), 0.06, (0, 0.32, 0)), linen, at, turn)
    put(doc, f"{name} blanket", rounded((w + 0.06, 0.12, d * 0.62), 0.05, (0, 0.44, d * 0.18)),
        blanket, at, turn)
    pillows = 2 if w > 1.2 else 1
    for i in range(pillows):
        x = (i - (pillows - 1) / 2) * w * 0.48
        put(doc, f"{name} pillow {i}",
            rounded((0.62, 0.14, 0.42), 0.065, (x, 0.5, -d / 2 + 0.32)), linen, at, turn)


def shelf(doc, name, wood, colors, at, size=(1.2, 2.0, 0.3), boards=5, turn=0.0, seed=1):
    """A bookcase with books, boxes, bowls and gaps."""
    w, h, d = size
    rng = random.Random(seed)
    pitch = h / boards
    parts = [block((0.02, h, d), (x * (w / 2 - 0.01), 0, 0)) for x in (-1, 1)]
    parts += [block((w - 0.04, 0.02, d), (0, i * pitch, 0)) for i in range(boards)]
    parts += [block((w, 0.02, d), (0, h - 0.02, 0)), block((w, h, 0.008), (0, 0, -d / 2 + 0.004))]
    put(doc, name, merged(parts), wood, at, turn)
    things = {color: [] for color in colors}
    for level in range(boards):
        x, y, room = -w / 2 + 0.03, level * pitch + 0.02, pitch - 0.05
        while x < w / 2 - 0.2:
            pile = things[rng.choice(colors)]
            kind = rng.random()
            if kind < 0.72:
                thick, tall = rng.uniform(0.015, 0.05), room * rng.uniform(0.6, 0.95)
                pile.append(block((thick, tall, d * rng.uniform(0.6, 0.85)),
                                  (x + thick / 2, y, -0.02)))
                x += thick + 0.002
            elif kind < 0.8:
                pile.append(rounded((0.16, room * 0.6, d * 0.7), 0.012, (x + 0.09, y, 0), 1))
                x += 0.19
            elif kind < 0.86:
                pile.append(lathe([(0, 0), (0.03, 0), (0.075, 0.05), (0.05, 0.12), (0.03, 0.15),
                                   (0.04, 0.19)], 14, (x + 0.09, y, 0)))
                x += 0.19
            else:
                x += rng.uniform(0.05, 0.16)
    for i, color in enumerate(colors):
        if things[color]:
            put(doc, f"{name} things {i}", merged(things[color]), color, at, turn)


def cupboard(doc, name, wood, knob, at, size=(0.9, 0.85, 0.5), drawers=3, turn=0.0, floor=0.0):
    w, h, d = size
    parts = [block((w, h - 0.06, d), (0, 0.06, 0)), block((w - 0.08, 0.06, d - 0.08))]
    each = (h - 0.1) / drawers
    for i in range(drawers):
        parts.append(rounded((w - 0.04, each - 0.015, 0.02), 0.008, (0, 0.08 + i * each, d / 2), 1))
        put(doc, f"{name} knob {i}",
            sphere(0.018, (0, 0.08 + (i + 0.5) * each, d / 2 + 0.03), 10), knob, at, turn, floor)
    put(doc, name, merged(parts), wood, at, turn, floor)


def plant(doc, name, pot, leaf, at, height=0.9, leaves=14, seed=3, floor=0.0):
    rng = random.Random(seed)
    put(doc, f"{name} pot", lathe([(0, 0), (0.13, 0), (0.17, 0.26), (0.19, 0.26), (0.19, 0.3),
                                   (0.16, 0.3), (0.15, 0.25), (0, 0.25)], 20), pot, at, 0, floor)
    parts = []
    for i in range(leaves):
        reach, lift = rng.uniform(0.2, 0.45) * height, rng.uniform(0.45, 1.0) * height
        rows = []
        for k in range(6):
            t = k / 5
            half = 0.055 * (4 * t * (1 - t) + 0.08)
            rows.append([(-half, 0.25 + lift * t * (1.6 - 0.75 * t), reach * t * t),
                         (half, 0.25 + lift * t * (1.6 - 0.75 * t), reach * t * t)])
        parts.append(Mesh().grid(rows).turned(360 * i / leaves + rng.uniform(-12, 12)))
    put(doc, f"{name} leaves", merged(parts), leaf, at, 0, floor)


def picture_frame(doc, name, frame, canvas, at, y, size=(0.8, 0.6), turn=0.0):
    w, h = size
    bars = [box((-w / 2, 0, 0), (w / 2, 0.04, 0.03)), box((-w / 2, h - 0.04, 0), (w / 2, h, 0.03)),
            box((-w / 2, 0.04, 0), (-w / 2 + 0.04, h - 0.04, 0.03)),
            box((w / 2 - 0.04, 0.04, 0), (w / 2, h - 0.04, 0.03))]
    put(doc, name, merged(bars), frame, at, turn, y)
    inside = sheet((w / 2 - 0.04, 0.012), (-w / 2 + 0.04, 0.012), h - 0.08, base=0.04)
    inside.uvs = [(u / (w - 0.08), 1 - v / (h - 0.08)) for u, v in inside.uvs]
    put(doc, f"{name} canvas", inside, canvas, at, turn, y)


def door_leaf(doc, name, wood, metal, hinge, width=0.88, height=2.02, turn=0.0):
    """The leaf goes from the hinge along +x at turn 0; two raised panels and a handle a side."""
    parts = [box((0, 0.005, -0.02), (width, height, 0.02))]
    for low, high in ((0.15, 0.85), (1.0, 1.85)):
        for z in (-1, 1):
            parts.append(rounded((width - 0.26, high - low, 0.016), 0.007,
                                 (width / 2, low, z * 0.022), 1))
    put(doc, name, merged(parts), wood, hinge, turn)
    handles = [rod((width - 0.07, 0.98, z * 0.02), (width - 0.07, 0.98, z * 0.07), 0.01, 8) +
               rod((width - 0.07, 0.98, z * 0.065), (width - 0.19, 0.98, z * 0.065), 0.01, 8)
               for z in (-1, 1)]
    put(doc, f"{name} handle", merged(handles), metal, hinge, turn)


def lamp_stand(doc, name, metal, at, height=1.4, floor=0.0):
    profile = [(0, 0), (0.15, 0), (0.15, 0.015), (0.03, 0.04), (0.012, 0.06), (0.012, height),
               (0, height)]
    put(doc, name, lathe(profile, 16), metal, at, 0, floor)


def shade(low_radius, high_radius, height, at, segments=28):
    """An open lamp shade, one sheet."""
    return lathe([(low_radius, 0), (high_radius, height)], segments, at)


def pendant_cord(doc, name, material, at, low, high):
    doc.add(name, rod((at[0], low, at[1]), (at[0], high, at[1]), 0.006, 6) +
            cylinder(0.05, 0.02, (at[0], high - 0.02, at[1]), 12), material)


def stairs(doc, name, wood, at, steps=12, rise=0.18, run=0.27, width=1.0, turn=0.0, floor=0.0):
    """Treads and risers that climb along -z from the place."""
    parts = []
    for i in range(steps):
        parts.append(block((width, 0.035, run + 0.03),
                           (0, (i + 1) * rise - 0.035, -(i + 0.5) * run)))
        parts.append(block((width, rise - 0.035, 0.02), (0, i * rise, -i * run - 0.01)))
    put(doc, name, merged(parts), wood, at, turn, floor)


def railing(doc, name, metal, start, end, count=9, height=0.9):
    """Posts and a handrail between two places (x, y, z)."""
    parts = []
    for i in range(count):
        t = i / (count - 1)
        x, y, z = (a + t * (b - a) for a, b in zip(start, end))
        parts.append(rod((x, y, z), (x, y + height, z), 0.012, 6))
    top = [(p[0], p[1] + height, p[2]) for p in (start, end)]
    parts.append(rod(*top, 0.022, 8))
    doc.add(name, merged(parts), metal)


def crates(doc, name, materials, area, count, sizes=(0.25, 0.5), seed=5):
    """Boxes on a floor or on one another; area (x0, z0, x1, z1)."""
    rng = random.Random(seed)
    for i in range(count):
        w, h, d = (rng.uniform(*sizes) for _ in range(3))
        at = (rng.uniform(area[0], area[2]), rng.uniform(area[1], area[3]))
        turn = rng.uniform(-25, 25)
        put(doc, f"{name} {i}", block((w, h, d)), materials[i % len(materials)], at, turn)
        if rng.random() < 0.4:
            put(doc, f"{name} {i} upper", block((w * 0.7, h * 0.7, d * 0.7)),
                materials[(i + 1) % len(materials)], at, turn + 20, h)
