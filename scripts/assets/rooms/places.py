"""Corridors and rooms of one purpose. A function a scene; its first line says what it tries."""
from . import furniture as f
from .homes import oblong
from .shapes import (block, box, cylinder, lathe, merged, polygon, rod, rounded, sheet, sphere,
                     torus)
from .shell import Palette, checker, lamp, landscape, panel, rings, shell, skirting, stripes


def corridor_round_corner(doc):
    """An L-shaped corridor wound outwards; the lamp is round the corner."""
    m = Palette(doc)
    carpet = doc.material("carpet", (1, 1, 1), doc.picture(32, 32, rings([(0.3, 0.08, 0.07),
                                                                          (0.45, 0.32, 0.15)])))
    plan = [(0, 0), (0, 6.4), (1.5, 6.4), (1.5, 1.6), (5.6, 1.6), (5.6, 0)]
    doors = {0: [(1.2, 2.1, 0, 2.05), (4.0, 4.9, 0, 2.05)], 5: [(1.0, 1.9, 0, 2.05)]}
    shell(doc, plan, 2.5, carpet, m["cream"], m["white"], doors, "out")
    skirting(doc, plan, m["walnut"], doors)
    f.door_leaf(doc, "door a", m["oak"], m["brass"], (-0.08, 2.11), 0.92, 2.06, 90)
    f.door_leaf(doc, "door b", m["oak"], m["brass"], (-0.08, 4.91), 0.92, 2.06, 90)
    f.door_leaf(doc, "door c", m["oak"], m["brass"], (3.69, -0.08), 0.92, 2.06, 0)
    f.cupboard(doc, "console", m["walnut"], m["brass"], (1.28, 3.4), (1.0, 0.8, 0.35), 2, -90)
    doc.add("vase", lathe([(0, 0), (0.06, 0), (0.1, 0.12), (0.05, 0.26), (0.07, 0.32)], 20,
                          (1.28, 0.8, 3.2)), m["blue"])
    f.picture_frame(doc, "picture", m["black"], m["green"], (1.495, 3.4), 1.35, (0.7, 0.5), -90)
    f.plant(doc, "plant", m["terracotta"], m["leaf"], (0.4, 0.4), 1.0, seed=9)
    bench = merged([rounded((1.2, 0.06, 0.34), 0.02, (0, 0.42, 0), 2),
                    *[block((0.05, 0.42, 0.3), (x, 0, 0)) for x in (-0.5, 0.5)]])
    doc.add("bench", bench.moved(2.6, 0, 1.38), m["pine"])
    coats = [rounded((0.36, 0.85, 0.14), 0.06, (2.2 + 0.42 * i, 0.85, 0.1)) for i in range(3)]
    doc.add("coats", merged(coats), m["plum"])
    doc.add("coat rack", box((1.9, 1.72, 0), (3.4, 1.8, 0.03)), m["oak"])
    lamp_body = panel(4.3, 0.5, 5.0, 1.1, 2.44)
    doc.add("lamp", lamp_body, lamp(doc, "lamp", (17, 15, 11)))
    doc.camera("far end", (0.75, 1.55, 6.2), (0.7, 1.2, 1.0))
    doc.camera("lit arm", (0.4, 1.5, 1.2), (5.4, 1.1, 0.8))


def door_ajar_next_room(doc):
    """A door ajar, the light next door."""
    m = Palette(doc)
    plan = oblong(4.0, 3.4)
    shell(doc, plan, 2.5, m["oak"], [m["blue"], m["white"], m["white"], None], m["white"],
          winding="mixed")
    gap = [(2.4, 3.3, 0, 2.05)]
    doc.add("wall to next door", sheet((4.0, 0), (0, 0), 2.5, [(0.7, 1.6, 0, 2.05)], 0.12),
            m["cream"])
    other = [(0, -3.0), (0, -0.12), (4.0, -0.12), (4.0, -3.0)]
    doc.add("next floor", polygon(other, 0.0), m["pine"])
    doc.add("sill", panel(2.4, -0.12, 3.3, 0, 0.0).flipped(), m["walnut"])
    doc.add("next ceiling", polygon(other, 2.5).flipped(), m["white"])
    doc.add("next walls", sheet((0, -3.0), (0, -0.12), 2.5) + sheet((4, -0.12), (4, -3.0), 2.5) +
            sheet((4, -3.0), (0, -3.0), 2.5), m["yellow"])
    doc.add("next partition", sheet((0, -0.12), (4, -0.12), 2.5, gap), m["white"])
    f.door_leaf(doc, "door", m["white"], m["brass"], (3.28, -0.02), 0.87, 2.03, 212)
    doc.add("next lamp", panel(1.3, -1.9, 2.5, -1.3, 2.4), lamp(doc, "next lamp", (18, 17, 15)))
    f.table(doc, "next table", m["oak"], (1.6, -1.6), (1.6, 0.74, 0.8))
    f.chair(doc, "next chair", m["red"], (1.6, -2.2), 0)
    f.sofa(doc, "sofa", m["grey"], m["terracotta"], (0.55, 1.8), 1.9, 90)
    f.cupboard(doc, "chest", m["walnut"], m["brass"], (1.2, 0.3), (1.0, 0.8, 0.5), 3)
    f.picture_frame(doc, "picture", m["oak"], m["linen"], (1.2, 0.005), 1.25, (0.8, 0.6))
    f.table(doc, "low table", m["pine"], (1.8, 1.9), (0.6, 0.42, 1.0))
    f.plant(doc, "plant", m["white"], m["leaf"], (3.6, 3.0), 1.2, seed=14)
    doc.camera("sofa", (0.9, 1.3, 3.0), (2.6, 0.9, 0.0))
    doc.camera("by the door", (3.5, 1.6, 0.5), (0.8, 0.7, 2.6))


def garage_tubes(doc):
    """Tubes, some whole, some cut open lengthwise as sheets."""
    m = Palette(doc)
    plan = oblong(7.0, 5.6)
    gate = {2: [(1.2, 4.2, 0.0, 2.3)]}
    shell(doc, plan, 3.0, m["concrete"], m["grey"], m["white"], gate)
    slats = [box((7.06, 0.0 + 0.23 * i, 1.4), (7.1, 0.22 + 0.23 * i, 4.4)) for i in range(10)]
    doc.add("gate", merged(slats), m["steel"])
    glow = lamp(doc, "tube", (20, 21, 22))
    for i, (x, z) in enumerate(((2.0, 1.4), (2.0, 4.0), (5.0, 2.8))):
        tube = cylinder(0.02, 1.4, segments=12).tipped(-90).moved(x - 0.7, 2.85, z)
        if i == 2:  # a gutter: half a turn of a lathe
            tube = lathe([(0.02, 0), (0.02, 1.4)], 8, turn=180).turned(90).tipped(-90).moved(
                x - 0.7, 2.85, z)
        doc.add(f"tube {i}", tube, glow)
        doc.add(f"tube body {i}", block((1.5, 0.05, 0.14), (x, 2.9, z)), m["linen"])
    doc.add("car", merged([rounded((4.0, 0.55, 1.7), 0.2, (4.6, 0.28, 2.8)),
                           rounded((2.2, 0.6, 1.5), 0.25, (4.3, 0.75, 2.8))]), m["red"])
    wheels = [cylinder(0.3, 0.2, segments=20).pitched(90).moved(x, 0.3, z)
              for x in (3.3, 5.9) for z in (1.95, 3.45)]
    doc.add("wheels", merged(wheels), m["black"])
    f.table(doc, "bench", m["pine"], (1.6, 0.45), (2.6, 0.9, 0.7))
    f.shelf(doc, "rack", m["steel"], [m["red"], m["yellow"], m["blue"], m["grey"]], (0.25, 3.2),
            (2.0, 2.0, 0.45), 4, 90, 50)
    tools = merged([rod((0.6 + 0.3 * i, 1.4, 0.03), (0.6 + 0.3 * i, 1.9, 0.03), 0.02, 6) +
                    block((0.14, 0.07, 0.05), (0.6 + 0.3 * i, 1.86, 0.03)) for i in range(7)])
    doc.add("tools", tools, m["black"])
    doc.add("ladder", merged([rod((0.3, 0.0, z), (0.06, 2.6, z), 0.025, 6) for z in (4.6, 5.0)] + [
        rod((0.3 - 0.24 * t, 2.6 * t, 4.6), (0.3 - 0.24 * t, 2.6 * t, 5.0), 0.018, 6)
        for t in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)]), m["pine"])
    f.crates(doc, "box", [m["cream"], m["oak"]], (1.2, 4.4, 2.6, 5.2), 6, (0.3, 0.5), 51)
    tyre = torus(0.24, 0.09)
    doc.add("tyres", merged([tyre.moved(6.3, 0.1 + 0.19 * i, 0.5) for i in range(4)]), m["black"])
    doc.camera("bench", (0.9, 1.7, 5.2), (4.4, 0.9, 1.6))
    doc.camera("gate", (6.6, 1.6, 0.9), (1.4, 0.9, 3.6))


def cinema_screen(doc):
    """A textured screen is the only light."""
    m = Palette(doc)
    plan = oblong(6.0, 8.0)
    carpet = doc.material("carpet", (1, 1, 1),
                          doc.picture(16, 16, checker((0.12, 0.03, 0.04), (0.2, 0.06, 0.05))))
    shell(doc, plan, 3.2, carpet, [m["plum"], m["plum"], m["plum"], m["black"]], m["grey"])
    screen = sheet((5.2, 0.06), (0.8, 0.06), 2.4, base=0.5)
    screen.uvs = [(u / 4.4, 1 - v / 2.4) for u, v in screen.uvs]
    glow = doc.material("screen", (0.1, 0.1, 0.1), emission=(7, 7, 7),
                        emission_texture=doc.picture(48, 27, landscape(48)))
    doc.add("screen", screen.flipped(), glow)
    doc.add("screen frame", merged([box((0.65, 0.38, 0.0), (5.35, 0.5, 0.1)),
                                    box((0.65, 2.9, 0.0), (5.35, 3.02, 0.1)),
                                    box((0.65, 0.5, 0.0), (0.8, 2.9, 0.1)),
                                    box((5.2, 0.5, 0.0), (5.35, 2.9, 0.1))]), m["black"])
    for i, row in enumerate((3.4, 5.1, 6.8)):
        rise = 0.2 * i
        if rise:
            doc.add(f"step {i}", box((0, 0, row - 0.85), (6, rise, row + 0.85 + 0.35)), carpet)
        for k in range(4):
            seat = merged([rounded((0.62, 0.2, 0.6), 0.06, (0, 0.3, 0)),
                           rounded((0.62, 0.75, 0.16), 0.06, (0, 0.35, 0.34)).pitched(-8),
                           rounded((0.12, 0.35, 0.6), 0.04, (-0.36, 0.3, 0)),
                           rounded((0.12, 0.35, 0.6), 0.04, (0.36, 0.3, 0)),
                           block((0.5, 0.3, 0.4))])
            doc.add(f"seat {i} {k}", seat, m["red"], (1.5 + k * 1.0, rise, row))
    for i, z in enumerate((2.5, 5.0)):
        for x in (0.06, 5.94):
            doc.add(f"baffle {i} {x}", rounded((0.08, 1.4, 1.2), 0.03, (x, 1.0, z), 1), m["cream"])
    doc.camera("last row", (3.0, 1.9, 7.7), (3.0, 1.3, 0.0))
    doc.camera("screen side", (5.4, 1.6, 0.7), (2.0, 0.7, 5.4))


def gallery_spots(doc):
    """A T-shaped gallery lit by spot lights alone."""
    m = Palette(doc, wall=(0.82, 0.82, 0.8))
    boards = doc.material("boards", (1, 1, 1), doc.picture(32, 32, stripes((0.55, 0.42, 0.28))))
    plan = [(0, 0), (0, 3.2), (3.4, 3.2), (3.4, 8.0), (6.6, 8.0), (6.6, 3.2), (10.0, 3.2),
            (10.0, 0)]
    shell(doc, plan, 3.4, boards, m["wall"], m["white"])
    canvases = [m["red"], doc.material("sunset", (1, 1, 1), doc.picture(32, 32, landscape())),
                m["blue"], doc.material("rings", (1, 1, 1), doc.picture(
                    32, 32, rings([(0.7, 0.5, 0.05), (0.05, 0.1, 0.35), (0.75, 0.7, 0.6)])))]
    for i, x in enumerate((1.6, 4.0, 6.2, 8.5)):
        f.picture_frame(doc, f"picture {i}", m["black"], canvases[i], (x, 0.006), 1.1, (1.3, 1.0))
        doc.light(f"spot {i}", "spot", (x, 3.2, 1.6), (28, 26, 22), (x, 1.5, 0.0), 0.25, 0.5)
        doc.add(f"spot body {i}", cylinder(0.05, 0.14, (x, 3.24, 1.62), 14), m["black"])
    things = (("ring", torus(0.28, 0.08, segments=32).pitched(90).moved(0, 0.4, 0), m["brass"]),
              ("figure", lathe([(0, 0), (0.16, 0), (0.2, 0.12), (0.09, 0.34), (0.15, 0.5),
                                (0.06, 0.66), (0.1, 0.76), (0, 0.86)], 28), m["terracotta"]),
              ("ball", sphere(0.26, (0, 0.26, 0)), m["white"]))
    for i, (name, mesh, material) in enumerate(things):
        x, z = ((2.2, 2.2), (5.0, 5.4), (7.8, 2.2))[i]
        doc.add(f"plinth {i}", block((0.55, 0.95, 0.55), (x, 0, z)), m["linen"])
        doc.add(name, mesh.moved(x, 0.95, z), material)
        doc.light(f"plinth spot {i}", "spot", (x + 0.5, 3.2, z + 0.9), (24, 24, 24), (x, 1.2, z),
                  0.15, 0.4)
    for i, x in enumerate((4.2, 5.8)):
        doc.add(f"bench {i}", rounded((0.5, 0.42, 1.6), 0.03, (x, 0, 6.9), 2), m["walnut"])
    doc.add("track", box((0.6, 3.36, 1.58), (9.4, 3.4, 1.64)), m["black"])
    doc.camera("stem", (5.0, 1.65, 7.7), (4.9, 1.3, 0.0))
    doc.camera("bar", (0.5, 1.65, 2.8), (8.0, 1.1, 0.8))
