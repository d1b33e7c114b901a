"""Halls, stairs, a cellar, a stage and a furnace. A function a scene; its first line says what it
tries."""
import math

from . import furniture as f
from .homes import oblong
from .shapes import (Mesh, block, box, cylinder, extruded, lathe, merged, polygon, rounded, sheet,
                     sphere)
from .shell import Palette, checker, lamp, landscape, panel, shell


def hall_columns(doc):
    """Sixteen metres, columns, panels that glow on both sides 5 cm under the ceiling."""
    m = Palette(doc)
    tiles = doc.material("tiles", (1, 1, 1),
                         doc.picture(16, 16, checker((0.7, 0.68, 0.62), (0.35, 0.12, 0.08))))
    plan = oblong(16.0, 8.0)
    floor_plan = polygon(plan, 0.0, 2.0)
    shell(doc, plan, 4.6, m["grey"], m["cream"], m["white"])
    doc.add("tiles", floor_plan.moved(0, 0.005, 0), tiles)
    column = lathe([(0.34, 0), (0.34, 0.12), (0.27, 0.2), (0.25, 0.3), (0.22, 3.9), (0.24, 4.0),
                    (0.34, 4.2), (0.34, 4.4), (0.4, 4.6)], 24)
    for i in range(5):
        for z in (2.0, 6.0):
            doc.add(f"column {i} {z:g}", column, m["linen"], (2.0 + 3.0 * i, 0, z))
    for i in range(4):
        doc.add(f"panel {i}", panel(3.1 + 3 * i, 3.4, 3.9 + 3 * i, 4.6, 4.55),
                lamp(doc, f"panel {i}", (9, 8.7, 8.0)))
    for i, x in enumerate((3.5, 6.5, 9.5, 12.5)):
        f.table(doc, f"table {i}", m["walnut"], (x, 4.0), (1.8, 0.74, 0.9))
        for k, (dx, dz, turn) in enumerate(((-0.5, -0.75, 0), (0.5, -0.75, 0), (-0.5, 0.75, 180),
                                            (0.5, 0.75, 180))):
            f.chair(doc, f"chair {i} {k}", m["oak"], (x + dx, 4.0 + dz), turn + 7 * (k - i))
    for i, x in enumerate((1.0, 15.0)):
        f.plant(doc, f"plant {i}", m["terracotta"], m["leaf"], (x, 0.8), 1.8, 18, 60 + i)
    doc.add("dais", box((13.9, 0, 1.4), (16, 0.3, 6.6)), m["oak"])
    doc.add("lectern", block((0.5, 1.15, 0.4), (14.6, 0.3, 2.4)), m["walnut"])
    doc.camera("entrance", (0.6, 1.7, 4.0), (15, 1.5, 4.0))
    doc.camera("aisle", (14.5, 2.0, 7.4), (4.0, 1.0, 2.0))


def stage_open_front(doc):
    """A box without a front, as for a puppet play, and stairs; nothing around it."""
    m = Palette(doc)
    shell(doc, oblong(5.0, 3.6), 3.0, m["oak"], [m["red"], None, m["green"], m["white"]],
          m["white"])
    f.stairs(doc, "stairs", m["pine"], (4.35, 3.2), 8, 0.18, 0.27, 1.0)
    doc.add("landing", box((3.7, 1.4, 0.0), (5.0, 1.44, 1.05)), m["pine"])
    f.railing(doc, "railing", m["black"], (3.82, 0.18, 3.1), (3.82, 1.44, 1.05), 8, 0.85)
    doc.add("landing posts", merged([block((0.08, 1.4, 0.08), (x, 0, z))
                                     for x in (3.76, 4.94) for z in (0.06, 0.98)]), m["walnut"])
    f.sofa(doc, "sofa", m["blue"], m["cream"], (1.9, 0.6), 2.2)
    f.round_table(doc, "table", m["walnut"], (1.9, 1.9), 0.4, 0.5)
    f.stool(doc, "stool", m["oak"], (0.8, 2.2))
    f.lamp_stand(doc, "lamp", m["brass"], (0.5, 0.5), 1.5)
    doc.add("lamp shade", f.shade(0.22, 0.16, 0.26, (0.5, 1.4, 0.5)), m["cream"])
    doc.add("lamp bulb", sphere(0.06, (0.5, 1.52, 0.5), 16), lamp(doc, "bulb", (60, 48, 30)))
    doc.add("ceiling lamp", panel(1.8, 1.2, 2.8, 1.8, 2.99), lamp(doc, "ceiling lamp", (7, 7, 7),
                                                                  False))
    doc.camera("front", (0.5, 1.7, 3.5), (3.2, 1.0, 0.4), 1.1)
    doc.camera("landing", (4.5, 2.6, 0.6), (1.2, 0.6, 2.2))


def cellar_dark(doc):
    """Albedo of 0.05 to 0.1, a vault, barrels, one bare bulb."""
    m = Palette(doc, stone=(0.08, 0.075, 0.07), soil=(0.05, 0.045, 0.04), stave=(0.1, 0.06, 0.03),
                hoop=(0.06, 0.06, 0.06))
    w, d, spring = 4.0, 6.0, 1.2
    arch = [(w / 2 - w / 2 * math.cos(math.pi * k / 20), spring + 1.3 * math.sin(math.pi * k / 20))
            for k in range(21)]
    doc.add("floor", polygon(oblong(w, d), 0.0), m["soil"])
    doc.add("vault", Mesh().grid([[(x, y, z) for x, y in arch] for z in (0, d / 2, d)]), m["stone"])
    doc.add("walls", sheet((0, 0), (0, d), spring) + sheet((w, d), (w, 0), spring), m["stone"])
    end = [(0, 0, 0), (w, 0, 0)] + [(x, y, 0) for x, y in arch[::-1]]
    far = [(x, y, d) for x, y, _ in end][::-1]
    doc.add("ends", Mesh().face(end) + Mesh().face(far), m["stone"])
    barrel = lathe([(0, 0), (0.26, 0), (0.33, 0.25), (0.35, 0.42), (0.33, 0.6), (0.26, 0.84),
                    (0, 0.84)], 24)
    hoops = merged([lathe([(r, y), (r + 0.012, y + 0.02), (r, y + 0.05)], 24)
                    for r, y in ((0.29, 0.08), (0.337, 0.25), (0.337, 0.56), (0.29, 0.72))])
    for i, z in enumerate((0.7, 1.6, 2.5, 3.4)):
        doc.add(f"barrel {i}", barrel.tipped(-90), m["stave"], (0.25, 0.5, z))
        doc.add(f"hoops {i}", hoops.tipped(-90), m["hoop"], (0.25, 0.5, z))
    doc.add("rails", box((0.35, 0, 0.2), (0.45, 0.2, 4.0)) + box((0.85, 0, 0.2), (0.95, 0.2, 4.0)),
            m["stave"])
    for i, (x, z) in enumerate(((3.3, 1.0), (3.2, 2.0))):
        doc.add(f"standing barrel {i}", barrel, m["stave"], (x, 0, z))
    f.shelf(doc, "wine rack", m["stave"], [m["hoop"], m["stone"]], (3.75, 4.3), (2.2, 1.6, 0.35), 4,
            -90, 70)
    f.stool(doc, "stool", m["stave"], (2.2, 4.8))
    f.crates(doc, "crate", [m["stave"]], (1.8, 0.5, 2.4, 0.9), 3, (0.3, 0.45), 71)
    f.pendant_cord(doc, "cord", m["hoop"], (2.2, 2.8), 2.0, 2.5)
    doc.add("bulb", sphere(0.05, (2.2, 1.95, 2.8), 18), lamp(doc, "bulb", (220, 170, 100)))
    doc.camera("stair", (2.1, 1.6, 5.8), (1.9, 0.8, 0.8))
    doc.camera("barrels", (3.4, 1.3, 0.4), (0.8, 0.6, 4.2))


def loft_white(doc):
    """An L-shaped loft of albedo 0.9 to 0.95."""
    m = Palette(doc, snow=(0.95, 0.95, 0.95), paint=(0.9, 0.9, 0.9), chalk=(0.92, 0.9, 0.86))
    plan = [(0, 0), (0, 9.0), (4.0, 9.0), (4.0, 5.0), (9.0, 5.0), (9.0, 0)]
    shell(doc, plan, 3.2, m["chalk"], m["snow"], m["paint"], winding="mixed")
    for i, (x, z) in enumerate(((4.6, 2.2), (2.75, 6.8))):
        doc.add(f"beam {i}", box((0, 2.9, z - 0.12), ((9.0, 4.0)[i], 3.2, z + 0.12)), m["paint"])
        doc.add(f"post {i}", cylinder(0.1, 2.9, (x, 0, z), 20), m["paint"])
    f.sofa(doc, "sofa", m["chalk"], m["snow"], (2.0, 1.0), 2.2)
    f.table(doc, "table", m["paint"], (6.6, 2.6), (2.2, 0.74, 0.95))
    for i, x in enumerate((5.9, 6.6, 7.3)):
        f.chair(doc, f"chair {i}", m["snow"], (x, 1.85), 4 * i)
        f.chair(doc, f"other chair {i}", m["snow"], (x, 3.35), 180 - 5 * i)
    f.bed(doc, "bed", m["paint"], m["snow"], m["chalk"], (1.3, 7.2), (1.6, 2.0), 90)
    f.cupboard(doc, "wardrobe", m["snow"], m["chalk"], (3.65, 7.6), (1.8, 2.2, 0.6), 3, -90)
    f.shelf(doc, "shelf", m["paint"], [m["snow"], m["chalk"]], (8.8, 2.6), (2.4, 2.0, 0.3), 5, -90,
            80)
    doc.add("screen wall", box((0.0, 0, 4.9), (2.2, 2.2, 5.0)), m["snow"])
    for i, (x, z) in enumerate(((6.2, 2.6), (7.0, 2.6))):
        hood = lathe([(0.2, 0), (0.14, 0.12), (0.03, 0.2)], 24, (x, 1.7, z))
        doc.add(f"hood {i}", hood, m["paint"])
        doc.add(f"bulb {i}", sphere(0.05, (x, 1.76, z), 16), lamp(doc, f"bulb {i}", (40, 37, 30)))
        f.pendant_cord(doc, f"cord {i}", m["chalk"], (x, z), 1.9, 3.2)
    doc.camera("kitchen end", (8.6, 1.65, 4.6), (2.0, 1.0, 1.2))
    doc.camera("bed end", (2.9, 1.6, 8.7), (1.2, 0.8, 5.6))


def furnace_white(doc):
    """Closed; every surface emits 1 and reflects 0.5, so radiance is 2 everywhere."""
    glow = doc.material("furnace", (0.5, 0.5, 0.5), emission=(1, 1, 1))
    doc.add("room", box((0, 0, 0), (3.0, 2.4, 3.6)).flipped(), glow)
    doc.add("block", block((0.7, 0.9, 0.7)).turned(20).moved(0.9, 0, 1.0), glow)
    doc.add("ball", sphere(0.4, (2.1, 0.4, 1.4), 32), glow)
    doc.add("shelf", box((0.2, 1.4, 0.0), (2.0, 1.44, 0.3)), glow)
    f.table(doc, "table", glow, (1.9, 2.4), (1.2, 0.74, 0.7), 10)
    doc.camera("corner", (0.3, 1.6, 3.3), (1.9, 0.7, 0.8))


def stairwell_two_floors(doc):
    """Five metres high, two flights, a skylight over the void."""
    m = Palette(doc)
    plan = oblong(3.2, 5.6)
    shell(doc, plan, 5.6, m["concrete"], [m["white"], m["cream"], m["white"], m["terracotta"]],
          None)
    doc.add("upper floor", merged([box((0, 2.7, 3.3), (3.2, 2.9, 5.6))]), m["oak"])
    doc.add("roof", merged([box((0, 5.6, 0), (3.2, 5.7, 0.8)), box((0, 5.6, 2.4), (3.2, 5.7, 5.6)),
                            box((0, 5.6, 0.8), (0.7, 5.7, 2.4)),
                            box((2.5, 5.6, 0.8), (3.2, 5.7, 2.4))]), m["white"])
    curb = merged([box((0.65, 5.7, 0.75), (2.55, 6.1, 0.8)),
                   box((0.65, 5.7, 2.4), (2.55, 6.1, 2.45)),
                   box((0.65, 5.7, 0.8), (0.7, 6.1, 2.4)), box((2.5, 5.7, 0.8), (2.55, 6.1, 2.4))])
    doc.add("curb", curb, m["white"])
    doc.add("skylight", panel(0.65, 0.75, 2.55, 2.45, 6.1), lamp(doc, "skylight", (6, 7, 9), False))
    f.stairs(doc, "first flight", m["pine"], (2.55, 3.6), 8, 0.18, 0.28, 1.1)
    doc.add("landing", box((0, 1.4, 0), (3.2, 1.46, 1.36)), m["pine"])
    f.stairs(doc, "second flight", m["pine"], (0.65, 1.36), 8, 0.18, 0.26, 1.1, 180, 1.46)
    f.railing(doc, "railing", m["black"], (1.98, 0.1, 3.6), (1.98, 1.45, 1.4), 10)
    f.railing(doc, "upper railing", m["black"], (1.22, 1.5, 1.4), (1.22, 2.9, 3.3), 9)
    f.railing(doc, "gallery railing", m["black"], (1.22, 2.9, 3.34), (3.15, 2.9, 3.34), 9)
    f.plant(doc, "plant", m["white"], m["leaf"], (0.5, 0.6), 1.0, seed=91)
    f.cupboard(doc, "chest", m["walnut"], m["brass"], (0.3, 2.8), (1.0, 0.8, 0.45), 3, 90)
    f.picture_frame(doc, "picture", m["black"], doc.material(
        "canvas", (1, 1, 1), doc.picture(32, 32, landscape())), (3.195, 4.6), 1.2, (0.9, 0.7), -90)
    f.crates(doc, "box", [m["cream"]], (2.2, 4.6, 2.8, 5.2), 3, (0.3, 0.5), 92)
    f.cupboard(doc, "upper chest", m["oak"], m["black"], (2.2, 5.3), (1.2, 0.9, 0.4), 3, 180, 2.9)
    f.chair(doc, "upper chair", m["walnut"], (0.6, 5.0), 120, 2.9)
    f.plant(doc, "upper plant", m["terracotta"], m["leaf"], (2.9, 3.8), 0.8, 12, 93, 2.9)
    doc.camera("below", (0.5, 1.6, 5.3), (2.0, 1.8, 0.8), 1.1)
    doc.camera("above", (2.9, 4.5, 5.2), (1.0, 2.0, 0.8), 1.1)


def chapel_apse(doc):
    """A nave with a round apse, extruded piers, candles and a high window slit."""
    m = Palette(doc)
    nave, radius = 9.0, 3.0
    arc = [(3 + radius * math.cos(a), -radius * math.sin(a))
           for a in (math.pi * k / 16 for k in range(17))]
    plan = [(0, 0), (0, nave), (6, nave), (6, 0)] + arc[1:-1]
    slit = {1: [(2.7, 3.3, 2.4, 4.4)]}
    shell(doc, plan, 5.0, m["concrete"], m["linen"], m["cream"], slit, reveal=0.4)
    doc.add("slit", Mesh().face([(2.7, 2.4, 9.4), (3.3, 2.4, 9.4), (3.3, 4.4, 9.4),
                                 (2.7, 4.4, 9.4)][::-1]), lamp(doc, "slit", (9, 10, 12), False))
    star = [(0.24 * (1, 0.72)[k % 2] * math.cos(-math.pi * k / 8),
             0.24 * (1, 0.72)[k % 2] * math.sin(-math.pi * k / 8)) for k in range(16)]
    for i, z in enumerate((1.0, 3.6, 6.2)):
        for x in (0.6, 5.4):
            doc.add(f"pier {i} {x:g}", extruded(star, 5.0), m["grey"], (x, 0, z))
    for i, z in enumerate((2.6, 3.7, 4.8, 5.9, 7.0)):
        for x in (1.9, 4.1):
            pew = merged([rounded((1.7, 0.05, 0.36), 0.015, (0, 0.42, 0), 1),
                          block((1.7, 0.5, 0.04), (0, 0.42, 0.2)),
                          block((0.05, 0.9, 0.44), (-0.85, 0, 0)),
                          block((0.05, 0.9, 0.44), (0.85, 0, 0))])
            doc.add(f"pew {i} {x:g}", pew, m["walnut"], (x, 0, z))
    doc.add("step", extruded([(0.2, 0.0), (5.8, 0.0), *[(3 + 2.8 * (x - 3) / radius,
                                                        2.8 * z / radius) for x, z in arc]
                              [1:-1]], 0.15), m["terracotta"])
    doc.add("altar", rounded((1.8, 0.95, 0.8), 0.03, (3.0, 0.15, -1.2), 2), m["linen"])
    flame = lamp(doc, "flame", (260, 170, 70))
    for i, x in enumerate((2.3, 3.0, 3.7)):
        doc.add(f"candle {i}", cylinder(0.03, 0.3, (x, 1.1, -1.2), 12), m["linen"])
        doc.add(f"flame {i}", sphere(0.022, (x, 1.44, -1.2), 10).mapped(
            lambda px, py, pz: (px, 1.44 + 1.8 * (py - 1.44), pz)), flame)
    doc.camera("nave", (3.0, 1.65, 8.7), (3.0, 1.5, -1.0))
    doc.camera("apse", (4.9, 1.7, -0.9), (1.8, 1.6, 6.0))
