"""Rooms to live in. A function a scene; its first line says what it tries."""
import random

from . import furniture as f
from .shapes import (Mesh, block, box, cylinder, lathe, merged, rod, rounded, sheet, sphere,
                     torus, wave_sheet)
from .shell import Palette, checker, lamp, landscape, panel, rings, shell, skirting, stripes


def oblong(w, d):
    """Edges 0 to 3 are those at x = 0, z = d, x = w and z = 0."""
    return [(0, 0), (0, d), (w, d), (w, 0)]


def attic_globe(doc):
    """Sloped ceilings; a globe that stands near the floor."""
    m = Palette(doc)
    boards = doc.material("boards", (1, 1, 1), doc.picture(32, 32, stripes((0.5, 0.34, 0.2))))
    w, d, knee, ridge = 5.2, 4.4, 0.9, 2.9
    floor = box((0, -0.02, 0), (w, 0, d))
    floor.uvs = [(x, z) for x, _, z in floor.points]
    doc.add("floor", floor, boards)
    doc.add("knee walls", sheet((0, 0), (0, d), knee) + sheet((w, d), (w, 0), knee), m["cream"])
    gable = [(0, 0, 0), (w, 0, 0), (w, knee, 0), (w / 2, ridge, 0), (0, knee, 0)]
    doc.add("gable", Mesh().face(gable), m["blue"])
    doc.add("other gable", Mesh().face([(x, y, d) for x, y, _ in gable][::-1]), m["white"])
    slope = [(0, knee, 0), (0, knee, d), (w / 2, ridge, d), (w / 2, ridge, 0)]
    doc.add("slope", Mesh().face(slope[::-1]), m["white"])
    doc.add("other slope", Mesh().face([(w - x, y, z) for x, y, z in slope]), m["white"])
    for i, z in enumerate((1.1, 2.2, 3.3)):
        beam = merged([rod((x, knee, z), (w / 2, ridge - 0.05, z), 0.07, 4) for x in (0, w)])
        doc.add(f"rafters {i}", beam + box((1.25, 1.85, z - 0.05), (w - 1.25, 2.0, z + 0.05)),
                m["walnut"])
    f.bed(doc, "bed", m["pine"], m["linen"], m["terracotta"], (1.2, 1.3), (1.2, 2.0))
    f.cupboard(doc, "chest", m["oak"], m["brass"], (4.65, 1.2), (1.0, 0.75, 0.45), 3, -90)
    f.crates(doc, "box", [m["cream"], m["pine"]], (3.6, 3.0, 4.6, 4.0), 5, (0.25, 0.45))
    f.plant(doc, "plant", m["terracotta"], m["leaf"], (2.6, 0.5), 1.0)
    doc.add("rug", cylinder(0.9, 0.012, (2.9, 0, 2.3), 40), m["red"])
    doc.add("globe foot", cylinder(0.1, 0.06, (2.5, 0, 1.4)), m["black"])
    doc.add("globe", sphere(0.17, (2.5, 0.23, 1.4), 28), lamp(doc, "globe", (14, 11, 7)))
    doc.camera("door", (2.9, 1.5, 4.2), (2.2, 0.9, 0.8))
    doc.camera("bed", (0.5, 1.1, 0.5), (4.4, 0.7, 3.2))


def flat_hanging_panel(doc):
    """Two rooms; a two-sided panel hangs in the other one."""
    m = Palette(doc)
    parquet = doc.material("parquet", (1, 1, 1), doc.picture(32, 32, stripes((0.42, 0.27, 0.15))))
    plan = oblong(8.0, 4.2)
    shell(doc, plan, 2.6, parquet, [m["cream"], m["white"], m["turquoise"], m["white"]], m["white"],
          winding="mixed")
    gap = (1.5, 2.5, 0.0, 2.1)
    doc.add("partition", sheet((4.1, 4.2), (4.1, 0), 2.6, [gap], 0.1), m["white"])
    doc.add("partition back", sheet((4.2, 0), (4.2, 4.2), 2.6, [(1.7, 2.7, 0, 2.1)]), m["white"])
    f.sofa(doc, "sofa", m["green"], m["yellow"], (2.0, 3.6), 2.1, 180)
    f.table(doc, "low table", m["walnut"], (2.0, 2.3), (1.1, 0.42, 0.6))
    f.shelf(doc, "bookcase", m["oak"], [m["red"], m["blue"], m["cream"]], (0.8, 0.17), seed=4)
    f.plant(doc, "plant", m["white"], m["leaf"], (0.4, 3.8), 1.1, seed=6)
    f.picture_frame(doc, "picture", m["black"], m["terracotta"], (2.6, 0.005), 1.3, (0.9, 0.7))
    f.table(doc, "table", m["oak"], (6.2, 2.0), (1.5, 0.74, 0.85))
    for i, (x, z, turn) in enumerate(((5.8, 1.4, 0), (6.6, 1.4, 0), (5.8, 2.6, 180),
                                      (6.6, 2.65, 170))):
        f.chair(doc, f"chair {i}", m["pine"], (x, z), turn)
    f.cupboard(doc, "sideboard", m["walnut"], m["brass"], (6.0, 0.28), (1.6, 0.8, 0.45), 2)
    doc.add("bowl", lathe([(0.05, 0.74), (0.16, 0.82), (0.15, 0.82), (0.04, 0.75)], 20,
                          (6.2, 0, 2.0)), m["blue"])
    doc.add("panel", panel(5.7, 1.7, 6.7, 2.3, 1.9), lamp(doc, "panel", (16, 15, 13)))
    doc.add("panel cords", rod((5.75, 1.9, 2.0), (5.75, 2.6, 2.0), 0.005, 4) +
            rod((6.65, 1.9, 2.0), (6.65, 2.6, 2.0), 0.005, 4), m["black"])
    doc.camera("first room", (0.5, 1.5, 0.9), (3.8, 1.0, 2.6))
    doc.camera("second room", (7.6, 1.6, 3.8), (5.0, 0.9, 1.2))


def study_shelves(doc):
    """Shelves with clutter; a desk lamp with a hood that is cut open."""
    m = Palette(doc)
    plan = oblong(3.6, 3.2)
    shell(doc, plan, 2.5, m["oak"], [m["cream"], m["white"], m["green"], m["cream"]], m["white"])
    skirting(doc, plan, m["white"])
    colors = [m["red"], m["blue"], m["yellow"], m["cream"], m["plum"], m["black"]]
    for i, x in enumerate((0.65, 1.8, 2.95)):
        f.shelf(doc, f"shelf {i}", m["pine"], colors, (x, 0.17), (1.1, 2.2, 0.3), 6, seed=20 + i)
    f.shelf(doc, "wall shelf", m["walnut"], colors[:3], (3.44, 1.9), (1.2, 1.2, 0.28), 3, -90, 31)
    f.table(doc, "desk", m["walnut"], (0.5, 2.1), (1.5, 0.74, 0.7), 90)
    f.chair(doc, "chair", m["black"], (1.15, 2.2), -80)
    rng = random.Random(8)
    papers = [block((0.21, 0.002, 0.3)).turned(rng.uniform(0, 90)).moved(
        0.35 + 0.3 * rng.random(), 0.742 + 0.003 * i, 1.7 + 0.8 * rng.random()) for i in range(9)]
    doc.add("papers", merged(papers), m["linen"])
    mug = [(0, 0), (0.04, 0), (0.042, 0.09), (0.037, 0.09), (0.035, 0.01), (0, 0.01)]
    doc.add("mug", lathe(mug, 18, (0.7, 0.74, 2.6)), m["red"])
    f.lamp_stand(doc, "desk lamp", m["steel"], (0.35, 1.5), 0.42, 0.74)
    hood = lathe([(0.13, 0), (0.11, 0.08), (0.03, 0.13)], 24, (0.45, 1.12, 1.6))
    doc.add("hood", hood, m["green"])
    doc.add("bulb", sphere(0.045, (0.45, 1.15, 1.6), 16), lamp(doc, "bulb", (160, 130, 85)))
    f.crates(doc, "box", [m["cream"], m["terracotta"]], (2.4, 2.3, 3.2, 2.8), 4, (0.2, 0.4), 12)
    doc.camera("window side", (3.2, 1.55, 3.0), (1.2, 0.95, 0.9))
    doc.camera("desk", (1.9, 1.4, 0.8), (0.3, 0.8, 2.4))


def cube_inside_out(doc):
    """A plain cube whose fronts are outside; a one-sided panel, a box, a table."""
    m = Palette(doc, wall=(0.7, 0.7, 0.7))
    doc.add("cube", box((-2, 0, -2), (2, 2.6, 2)), m["wall"])
    doc.add("panel", panel(-0.6, -0.6, 0.6, 0.6, 2.55),
            lamp(doc, "panel", (9, 9, 8.5), double_sided=False))
    doc.add("box", block((0.8, 0.8, 0.8)).turned(25).moved(-1.0, 0, -1.0), m["terracotta"])
    f.table(doc, "table", m["oak"], (0.8, -0.6), (1.2, 0.75, 0.7), -12)
    doc.add("ball", sphere(0.16, (0.7, 0.91, -0.55)), m["blue"])
    doc.camera("corner", (1.8, 1.5, 1.8), (-0.4, 0.8, -0.8))
    doc.camera("low", (-1.7, 0.6, 1.5), (0.8, 1.0, -1.2))


def bedroom_curtains(doc):
    """Curtains, an opaque lamp shade, a point light in it, a screen of light behind the cloth."""
    m = Palette(doc)
    plan = oblong(4.2, 3.8)
    rug = doc.material("rug", (1, 1, 1), doc.picture(32, 32, rings([(0.5, 0.2, 0.15),
                                                                    (0.7, 0.62, 0.5)])))
    window = {0: [(1.1, 2.7, 0.9, 2.1)]}
    shell(doc, plan, 2.5, m["pine"], [m["white"], m["pink"], m["white"], m["cream"]], m["white"],
          window, "mixed", 0.25)
    pane = Mesh().face([(-0.25, 2.1, 1.1), (-0.25, 2.1, 2.7), (-0.25, 0.9, 2.7), (-0.25, 0.9, 1.1)])
    doc.add("window pane", pane, lamp(doc, "dusk", (0.9, 1.2, 2.0), double_sided=False))
    for i, z in enumerate((0.95, 2.75)):
        cloth = wave_sheet(0.75, 2.2, 5, 0.05).turned(90).moved(0.12, 0.02, z)
        doc.add(f"curtain {i}", cloth, m["plum"])
    doc.add("curtain rail", rod((0.12, 2.25, 0.5), (0.12, 2.25, 3.2), 0.015), m["brass"])
    f.bed(doc, "bed", m["walnut"], m["linen"], m["blue"], (2.4, 1.15), (1.6, 2.0))
    for i, x in enumerate((1.2, 3.6)):
        f.cupboard(doc, f"night table {i}", m["walnut"], m["brass"], (x, 0.3), (0.45, 0.5, 0.4), 2)
    f.lamp_stand(doc, "lamp", m["brass"], (3.6, 0.3), 0.22, 0.5)
    doc.add("lamp shade", f.shade(0.17, 0.11, 0.2, (3.6, 0.74, 0.3)), m["cream"])
    doc.light("bulb", "point", (3.6, 0.84, 0.3), (5.0, 3.9, 2.4))
    f.cupboard(doc, "wardrobe", m["white"], m["brass"], (3.85, 2.7), (1.6, 2.1, 0.6), 2, -90)
    doc.add("rug", block((1.6, 0.012, 1.1), (2.2, 0, 2.9)), rug)
    doc.add("slippers", rounded((0.1, 0.07, 0.26), 0.03, (1.3, 0, 2.5)) +
            rounded((0.1, 0.07, 0.26), 0.03, (1.45, 0, 2.6)), m["red"])
    doc.camera("door", (3.3, 1.5, 3.6), (1.8, 0.8, 0.6))
    doc.camera("window", (0.5, 1.4, 2.0), (3.6, 0.9, 0.8))


def dining_paper_shade(doc):
    """A paper shade that glows on both sides around a bulb."""
    m = Palette(doc)
    tiles = doc.material("tiles", (1, 1, 1),
                         doc.picture(16, 16, checker((0.65, 0.62, 0.55), (0.12, 0.1, 0.09))))
    plan = oblong(4.8, 4.0)
    doors = {1: [(1.8, 2.7, 0.0, 2.05)]}
    shell(doc, plan, 2.7, tiles, [m["yellow"], m["cream"], m["cream"], m["white"]], m["white"],
          doors)
    f.door_leaf(doc, "door", m["white"], m["brass"], (1.79, 4.08), 0.92, 2.06)
    f.round_table(doc, "table", m["oak"], (2.3, 1.9), 0.65)
    for i, turn in enumerate((20, 95, 170, 240, 300)):
        at = Mesh().face([(0, 0, -0.85)] * 3).turned(turn).points[0]
        f.chair(doc, f"chair {i}", m["walnut"], (2.3 + at[0], 1.9 + at[2]), turn)
    profile = [(0.06, 0.0), (0.2, 0.05), (0.27, 0.16), (0.27, 0.24), (0.2, 0.35), (0.06, 0.4)]
    doc.add("paper shade", lathe(profile, 28, (2.3, 1.45, 1.9)), lamp(doc, "paper", (5, 4.2, 2.8)))
    doc.add("bulb", sphere(0.04, (2.3, 1.66, 1.9), 14), lamp(doc, "bulb", (90, 75, 48)))
    f.pendant_cord(doc, "cord", m["black"], (2.3, 1.9), 1.85, 2.7)
    dish = [(0, 0.72), (0.07, 0.72), (0.13, 0.745), (0.12, 0.75), (0.06, 0.728), (0, 0.728)]
    for i, (x, z) in enumerate(((0.0, -0.4), (0.4, 0.0), (0.0, 0.4), (-0.4, 0.05))):
        doc.add(f"plate {i}", lathe(dish, 20, (2.3 + x, 0, 1.9 + z)), m["linen"])
    doc.add("bottle", lathe([(0, 0), (0.038, 0), (0.038, 0.19), (0.014, 0.25), (0.014, 0.31),
                             (0, 0.31)], 18, (2.4, 0.72, 1.95)), m["green"])
    f.cupboard(doc, "dresser", m["pine"], m["black"], (4.45, 2.0), (1.6, 0.9, 0.5), 3, -90)
    f.shelf(doc, "plate rack", m["pine"], [m["linen"], m["blue"]], (4.6, 2.0), (1.5, 2.3, 0.22), 6,
            -90, 44)
    f.picture_frame(doc, "picture", m["walnut"], doc.material(
        "canvas", (1, 1, 1), doc.picture(32, 32, landscape())), (2.2, 0.005), 1.2, (1.1, 0.8))
    doc.camera("corner", (0.35, 1.6, 3.7), (2.9, 0.85, 1.2))
    doc.camera("seat", (4.3, 1.25, 0.5), (1.6, 0.9, 2.6))


def kitchen_turned(doc):
    """A room at 30 degrees to the axes; strips under wall cupboards."""
    m = Palette(doc)
    tiles = doc.material("tiles", (1, 1, 1),
                         doc.picture(16, 16, checker((0.5, 0.2, 0.12), (0.7, 0.66, 0.6))))
    turn = lambda x, z: Mesh().face([(x, 0, z)] * 3).turned(30).points[0]
    flat = lambda x, z: (turn(x, z)[0], turn(x, z)[2])
    add = lambda name, mesh, material: doc.add(name, mesh.turned(30), material)
    plan = [flat(*p) for p in oblong(4.0, 3.0)]
    shell(doc, plan, 2.4, tiles, [m["white"], m["cream"], m["green"], m["white"]], m["white"])
    add("counter", merged([block((3.9, 0.06, 0.62), (2.0, 0.86, 0.31)),
                           block((3.9, 0.76, 0.56), (2.0, 0.1, 0.28)),
                           block((3.9, 0.1, 0.5), (2.0, 0, 0.25))]), m["oak"])
    for i in range(6):
        at = (0.36 + 0.655 * i, 0.585)
        add(f"front {i}", rounded((0.63, 0.7, 0.02), 0.006, (at[0], 0.13, 0.57), 1), m["white"])
        add(f"knob {i}", sphere(0.016, (at[0] + 0.22, 0.72, 0.6), 10), m["black"])
    add("wall cupboards", merged([block((1.28, 0.65, 0.32), (x, 1.45, 0.16))
                                  for x in (0.68, 3.3)]), m["green"])
    for i, x in enumerate((0.68, 3.3)):
        strip = Mesh().face([(x - 0.5, 1.44, 0.2), (x + 0.5, 1.44, 0.2), (x + 0.5, 1.44, 0.24),
                             (x - 0.5, 1.44, 0.24)])
        add(f"strip {i}", strip, lamp(doc, f"strip {i}", (45, 43, 38)))
    add("hood", merged([lathe([(0.36, 1.5), (0.14, 1.75), (0.14, 2.4)], 4).turned(45).scaled(
        1, 1, 0.7).moved(1.98, 0, 0.25)]), m["steel"])
    add("pot", lathe([(0, 0), (0.11, 0), (0.12, 0.15), (0.115, 0.15), (0.105, 0.01), (0, 0.01)], 20,
                     (1.8, 0.93, 0.3)), m["steel"])
    add("kettle", lathe([(0, 0), (0.09, 0), (0.1, 0.06), (0.05, 0.16), (0.015, 0.18), (0, 0.2)], 20,
                        (2.3, 0.93, 0.32)), m["red"])
    add("board", block((0.4, 0.02, 0.26)).turned(15).moved(0.8, 0.92, 0.35), m["pine"])
    f.table(doc, "table", m["pine"], flat(2.7, 2.1), (1.1, 0.74, 0.7), 30)
    for i, (x, z, way) in enumerate(((2.4, 1.5, 20), (3.0, 1.5, 35), (1.85, 2.2, 115))):
        f.chair(doc, f"chair {i}", m["blue"], flat(x, z), way)
    f.cupboard(doc, "fridge", m["linen"], m["steel"], flat(0.35, 2.55), (0.6, 1.7, 0.6), 2, 120)
    doc.camera("door", turn(3.7, 2.8)[:1] + (1.55,) + turn(3.7, 2.8)[2:], turn(1.2, 0.4)[:1] +
               (0.9,) + turn(1.2, 0.4)[2:])
    doc.camera("cook", turn(0.9, 1.2)[:1] + (1.6,) + turn(0.9, 1.2)[2:], turn(3.2, 2.4)[:1] +
               (0.7,) + turn(3.2, 2.4)[2:])


def bathroom_small(doc):
    """Two metres by two, tiled, a round lamp on the ceiling and a strip over the basin."""
    m = Palette(doc)
    tiles = doc.material("tiles", (1, 1, 1),
                         doc.picture(16, 16, checker((0.1, 0.42, 0.42), (0.72, 0.74, 0.72))))
    plan = oblong(2.0, 2.2)
    shell(doc, plan, 2.3, tiles, [m["turquoise"], m["white"], m["white"], m["turquoise"]],
          m["white"], {1: [(0.6, 1.35, 0.0, 2.0)]})
    f.door_leaf(doc, "door", m["white"], m["steel"], (0.59, 2.28), 0.77, 2.01)
    tub = lathe([(0.0, 0.1), (0.28, 0.1), (0.33, 0.55), (0.37, 0.57), (0.37, 0.55), (0.32, 0.02),
                 (0.0, 0.0)], 28).flipped()
    doc.add("tub", tub.scaled(1, 1, 2.1).moved(1.58, 0.0, 0.95), m["linen"])
    basin = lathe([(0, 0.02), (0.16, 0.06), (0.2, 0.16), (0.22, 0.16), (0.19, 0.03), (0.06, -0.04),
                   (0.06, -0.75), (0, -0.75)], 24)
    doc.add("basin", basin.moved(0.3, 0.76, 0.9), m["linen"])
    doc.add("tap", rod((0.06, 0.9, 0.9), (0.06, 1.02, 0.9), 0.012) +
            rod((0.06, 1.02, 0.9), (0.2, 1.0, 0.9), 0.012), m["steel"])
    doc.add("mirror cupboard", block((0.12, 0.6, 0.5), (0.06, 1.2, 0.9)), m["steel"])
    strip = Mesh().face([(0.14, 1.9, 0.65), (0.14, 1.9, 1.15), (0.14, 1.85, 1.15),
                         (0.14, 1.85, 0.65)])
    doc.add("strip", strip, lamp(doc, "strip", (22, 22, 22), double_sided=False))
    doc.add("seat", merged([lathe([(0, 0), (0.12, 0), (0.1, 0.2), (0.18, 0.36), (0.19, 0.4),
                                   (0, 0.41)], 22, (0.38, 0, 0.3)),
                            rounded((0.18, 0.38, 0.38), 0.04, (0.1, 0.4, 0.3))]), m["linen"])
    doc.add("towel", wave_sheet(0.5, 0.7, 2, 0.02, 16).moved(0.3, 0.9, 2.14), m["yellow"])
    doc.add("towel rail", rod((0.04, 1.6, 2.14), (0.56, 1.6, 2.14), 0.012), m["steel"])
    doc.add("mat", rounded((0.5, 0.02, 0.7), 0.008, (0.9, 0, 1.5), 1), m["blue"])
    disc = lathe([(0, 2.24), (0.15, 2.24), (0.15, 2.28)], 28, (1.0, 0, 1.1)).flipped()
    doc.add("ceiling lamp", disc, lamp(doc, "ceiling lamp", (10, 9.6, 8.8)))
    doc.camera("door", (1.75, 1.55, 2.1), (0.5, 0.8, 0.5), 1.2)
    doc.camera("tub", (0.5, 1.6, 0.2), (1.4, 0.5, 1.7), 1.2)


def nursery_coloured(doc):
    """Walls of four colors, toys, point lights without a body."""
    m = Palette(doc, orange=(0.75, 0.3, 0.04), lime=(0.4, 0.65, 0.08))
    plan = oblong(4.4, 3.6)
    rug = doc.material("rug", (1, 1, 1), doc.picture(32, 32, rings([
        (0.6, 0.05, 0.05), (0.75, 0.6, 0.05), (0.05, 0.2, 0.55), (0.7, 0.7, 0.7)])))
    shell(doc, plan, 2.5, m["pine"], [m["red"], m["yellow"], m["blue"], m["lime"]], m["white"])
    round_rug = cylinder(1.0, 0.012, (2.2, 0, 1.9), 40)
    round_rug.uvs = [((x - 1.2) / 2, (z - 0.9) / 2) for x, _, z in round_rug.points]
    doc.add("rug", round_rug, rug)
    f.bed(doc, "bed", m["white"], m["linen"], m["orange"], (3.6, 1.2), (0.9, 1.7))
    f.shelf(doc, "toy shelf", m["white"], [m["red"], m["lime"], m["blue"], m["orange"]],
            (1.4, 0.17), (1.6, 1.1, 0.3), 3, seed=95)
    f.table(doc, "small table", m["lime"], (0.6, 2.5), (0.8, 0.5, 0.6), 90)
    f.stool(doc, "stool", m["orange"], (1.15, 2.5), 0.3)
    rng = random.Random(96)
    names = ["red", "blue", "yellow", "lime", "orange"]
    for i in range(14):
        side = rng.uniform(0.06, 0.1)
        at = (1.5 + 1.4 * rng.random(), 1.3 + 1.3 * rng.random())
        f.put(doc, f"brick {i}", block((side, side, side)), m[rng.choice(names)], at,
              rng.uniform(0, 90))
    doc.add("ball", sphere(0.16, (2.7, 0.16, 2.5), 24), m["red"])
    doc.add("ring stack", merged([torus(0.12 - 0.02 * k, 0.035, (1.6, 0.05 + 0.06 * k, 1.6), 20)
                                  for k in range(4)]), m["yellow"])
    doc.add("tent", lathe([(0.55, 0), (0.02, 1.3)], 6, (0.65, 0, 0.75), 300), m["orange"])
    beads = merged([sphere(0.05, (3.9 - 0.07 * k, 1.9 - 0.03 * k * (6 - k), 3.5), 12)
                    for k in range(7)])
    doc.add("beads", beads, m["linen"])
    doc.light("ceiling light", "point", (2.2, 2.2, 1.8), (3.2, 3.0, 2.6))
    doc.light("night light", "point", (4.2, 0.9, 2.9), (0.3, 0.4, 0.8))
    doc.camera("door", (0.4, 1.4, 3.3), (3.0, 0.6, 0.8))
    doc.camera("bed", (4.1, 1.2, 0.5), (1.0, 0.5, 2.6))
