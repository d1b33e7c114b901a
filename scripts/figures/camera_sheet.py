#!/usr/bin/env python3
"""Makes the picture of docs/cameras.md: what the automatic camera shows of scenes of every kind.

usage: scripts/figures/camera_sheet.py OUT.jpg [FILE.ply ...] [--bin build/bin] [--keep FOLDER]
           [--only TEXT]

Homes and boxes come from lte_datagen, the rest is written here as OBJ or lies in assets/scenes.
More files are taken for objects whose z points up; those of the committed picture are airplane.ply,
ant.ply and nut.ply of PyPI's pyvista (in its wheel, under pyvista/examples). Needs PyPI's Pillow.
"""
import argparse
import io
import math
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets/scenes"
MAKE_SKY = pathlib.Path(__file__).resolve().parents[1] / "assets/make_sky.py"
CONFIGS = pathlib.Path(__file__).resolve().parents[2] / "configs/data"
SIZE = (192, 144)
COLUMNS = 6
MATERIALS = {
    "white": (0.75, 0.75, 0.75), "red": (0.6, 0.15, 0.12), "green": (0.2, 0.45, 0.2),
    "blue": (0.15, 0.25, 0.55), "wood": (0.45, 0.28, 0.14), "grey": (0.35, 0.35, 0.35)
}
FACES = {  # corners of a box's sides, counter-clockwise from outside
    "-x": (0, 4, 6, 2), "+x": (1, 3, 7, 5), "-y": (0, 1, 5, 4), "+y": (2, 6, 7, 3),
    "-z": (0, 2, 3, 1), "+z": (4, 5, 7, 6)
}


class Obj:
    """A Wavefront OBJ in the making; `transform` is applied to each vertex."""

    def __init__(self, transform=lambda p: p):
        self.transform = transform
        self.lines = ["mtllib scene.mtl"]
        self.vertices = 0
        self.objects = 0

    def faces(self, material, points, faces):
        self.objects += 1
        self.lines += [f"o object{self.objects}", f"usemtl {material}"]
        for point in points:
            self.lines.append("v %.6g %.6g %.6g" % tuple(self.transform(point)))
        for face in faces:
            self.lines.append("f " + " ".join(str(self.vertices + i + 1) for i in face))
        self.vertices += len(points)

    def box(self, low, high, material="white", inward=False, without=()):
        points = [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]
        faces = [face for name, face in FACES.items() if name not in without]
        self.faces(material, points, [face[::-1] if inward else face for face in faces])

    def quad(self, points, material="white"):
        self.faces(material, points, [(0, 1, 2, 3)])

    def revolve(self, centre, outline, material="white", around=24):
        """A solid of revolution about +Y from (radius, height) pairs, bottom to top."""
        points, faces = [], []
        for radius, height in outline:
            for i in range(around):
                angle = 2 * math.pi * i / around
                points.append((centre[0] + radius * math.cos(angle), centre[1] + height,
                               centre[2] - radius * math.sin(angle)))
        for row in range(len(outline) - 1):
            for i in range(around):
                a, b = row * around + i, row * around + (i + 1) % around
                faces.append((a, b, b + around, a + around))
        self.faces(material, points, faces)

    def lamp(self, centre, side):
        """Emits downwards."""
        x, y, z = centre
        h = side / 2
        self.quad([(x - h, y, z - h), (x + h, y, z - h), (x + h, y, z + h), (x - h, y, z + h)],
                  "lamp")

    def write(self, path, watts=10):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(self.lines) + "\n")
        mtl = [f"newmtl {name}\nKd {r} {g} {b}" for name, (r, g, b) in MATERIALS.items()]
        mtl.append(f"newmtl lamp\nKd 0 0 0\nKe {watts} {watts} {watts}")
        (path.parent / "scene.mtl").write_text("\n".join(mtl) + "\n")


def sphere(radius, steps=12):
    angles = [math.pi * i / steps for i in range(steps + 1)]
    return [(radius * math.sin(a), radius - radius * math.cos(a)) for a in angles]


def furniture(obj, at=(0, 0)):
    x, z = at
    for dx, dz in ((0, 0), (1.1, 0), (0, 0.6), (1.1, 0.6)):
        obj.box((x + dx, 0, z + dz), (x + dx + 0.08, 0.7, z + dz + 0.08), "wood")
    obj.box((x - 0.05, 0.7, z - 0.05), (x + 1.25, 0.76, z + 0.75), "wood")
    obj.box((x + 1.6, 0, z), (x + 2.4, 0.4, z + 0.8), "blue")
    obj.box((x + 1.6, 0.4, z), (x + 2.4, 0.9, z + 0.15), "blue")
    obj.revolve((x + 0.5, 0.76, z + 0.3), sphere(0.12), "red")


def cornell(obj, without=("+z",)):
    obj.box((0, 0, 0), (5.5, 5.5, 5.5), "white", inward=True, without=without)
    obj.box((0.9, 0, 2.5), (2.5, 3.3, 4.1), "red")
    obj.box((3, 0, 3.4), (4.6, 1.65, 5), "green")
    obj.lamp((2.75, 5.45, 2.75), 1.6)


def room(obj, size=(6, 2.6, 5), without=()):
    obj.box((0, 0, 0), size, "white", inward=True, without=without)
    furniture(obj, (1, 1.2))
    obj.box((size[0] - 0.5, 0, 1), (size[0] - 0.02, 1.9, 2.4), "wood")
    if "+y" not in without:
        obj.lamp((size[0] / 2, size[1] - 0.02, size[2] / 2), 1.2)


def scaled(factor):
    return lambda p: tuple(factor * c for c in p)


def turned(degrees, factor=1):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return lambda p: (factor * (c * p[0] + s * p[2]), factor * p[1], factor * (c * p[2] - s * p[0]))


def written(folder):
    """(title, file) of the scenes that are made here."""
    scenes = []

    def add(title, obj):
        path = folder / title.replace(" ", "_").replace(",", "") / "scene.obj"
        obj.write(path)
        scenes.append((title, path))

    obj = Obj(turned(90, 100))
    cornell(obj)
    add("open box in cm, turned", obj)
    obj = Obj(scaled(0.1))
    cornell(obj, ("+z", "+y"))
    add("open box, no top", obj)
    obj = Obj()
    room(obj, (9, 2.5, 4), ("+z",))
    add("stage", obj)
    obj = Obj(scaled(1000))
    room(obj)
    add("room in mm", obj)
    obj = Obj(turned(30))
    room(obj, (7, 2.7, 5), ("+y",))
    add("room, no ceiling, turned", obj)
    obj = Obj()
    room(obj, (7, 2.7, 5), ("+y",))
    add("room, no ceiling", obj)
    obj = Obj()  # four rooms without a ceiling, doorways between them
    obj.box((0, 0, 0), (10, 2.6, 8), "white", inward=True, without=("+y",))
    obj.box((4.9, 0, 0), (5.1, 2.6, 3))
    obj.box((4.9, 0, 4), (5.1, 2.6, 8))
    obj.box((0, 0, 3.9), (3.5, 2.6, 4.1))
    obj.box((6.5, 0, 3.9), (10, 2.6, 4.1))
    furniture(obj, (0.6, 0.8))
    furniture(obj, (6.2, 5.2))
    add("four rooms, no ceilings", obj)
    obj = Obj()  # a furnished house in a walled garden with trees
    obj.box((0, 0, 0), (6, 2.6, 5), "white", inward=True, without=("+z",))
    obj.box((-0.2, 0, -0.2), (6.2, 2.9, 5.2), "red", without=("-y", "+z"))
    obj.quad([(0, 0, 5), (0, 2.6, 5), (4.5, 2.6, 5), (4.5, 0, 5)], "white")
    obj.quad([(4.5, 0, 5.2), (4.5, 2.9, 5.2), (-0.2, 2.9, 5.2), (-0.2, 0, 5.2)], "red")
    furniture(obj, (1, 1.2))
    obj.lamp((3, 2.58, 2.5), 1.2)
    obj.box((-14, -0.05, -12), (20, 2.2, 22), "green", inward=True, without=("+y",))
    for x, z in ((-6, -5), (12, 12), (-7, 14), (13, -4)):
        obj.box((x, 0, z), (x + 0.4, 2, z + 0.4), "wood")
        obj.revolve((x + 0.2, 1.5, z + 0.2), sphere(2.4), "green")
    add("house in a garden", obj)
    obj = Obj()
    obj.revolve((0, 0, 0), sphere(0.4), "red")
    add("sphere", obj)
    obj = Obj()
    obj.box((-0.15, 0, -0.15), (0.15, 0.1, 0.15), "grey")
    obj.box((-0.03, 0.1, -0.03), (0.03, 4, 0.03), "grey")
    obj.box((-0.03, 3.9, -0.03), (0.9, 4, 0.03), "grey")
    add("lamp post", obj)
    obj = Obj()
    for y in (0, 0.4, 0.8, 1.2, 1.6):
        obj.box((0, y, 0), (0.9, y + 0.02, 0.3), "wood")
    for x in (-0.02, 0.9):
        obj.box((x, 0, 0), (x + 0.02, 1.62, 0.3), "wood")
    obj.box((0, 0, -0.01), (0.9, 1.62, 0), "wood")
    for i in range(9):
        obj.box((0.05 + 0.06 * i, 0.42, 0.02), (0.1 + 0.06 * i, 0.65 + 0.01 * (i * 5 % 7), 0.2),
                ("red", "blue", "green")[i % 3])
    add("bookshelf", obj)
    obj = Obj(scaled(100))
    obj.revolve((0, 0, 0), [(0, 0), (0.3, 0), (0.42, 0.35), (0.2, 0.8), (0.26, 1), (0.24, 1),
                            (0.18, 0.8), (0.4, 0.35), (0.28, 0.02), (0, 0.02)], "blue", 32)
    add("vase in cm", obj)
    obj = Obj()
    obj.quad([(-8, 0, 8), (8, 0, 8), (8, 0, -8), (-8, 0, -8)], "grey")
    obj.quad([(-8, 0, -8), (8, 0, -8), (8, 9, -8), (-8, 9, -8)], "white")
    obj.revolve((0, 0, 0), [(0, 0), (0.5, 0), (0.1, 0.2), (0.1, 0.8), (0.4, 1.3), (0, 1.3)], "red")
    obj.lamp((0, 6, 2), 3)
    add("object, ground, backdrop", obj)
    obj = Obj()
    obj.box((0, 0, 0), (0.6, 0.4, 0.4), "wood", inward=True, without=("+y",))
    obj.box((-0.02, -0.02, -0.02), (0.62, 0.4, 0.42), "wood", without=("+y",))
    obj.revolve((0.2, 0, 0.2), sphere(0.1), "red")
    add("crate", obj)
    obj = Obj()
    obj.quad([(-60, 0, 60), (60, 0, 60), (60, 0, -60), (-60, 0, -60)], "green")
    for i in range(40):
        x, z = (i * 37 % 97) - 48, (i * 61 % 89) - 44
        obj.box((x, 0, z), (x + 6 + i % 4, 4 + i * 7 % 9, z + 5 + i % 3),
                ("white", "red", "grey")[i % 3])
    add("village", obj)
    return scenes


def generated(run, folder):
    """Homes and rooms of boxes, as data sets have them; their baking is made short."""
    quick = []
    for key in ("rays=1", "scene_points=64", "query_points=16", "views.count=0", "val_share=0",
                "test_share=0", "path_tracing_64=false"):
        quick += ["--set", key]
    scenes = []
    for kind, config, count in (("home", "homes", 5), ("boxes", "boxes", 2)):
        out = folder / kind
        if not out.exists():  # else of an earlier call with --keep
            run("lte_datagen", "generate", "--config", CONFIGS / f"{config}.yaml", "--out", out,
                "--scenes", count, "--glb", "--quiet", *quick)
        files = sorted((out / "scenes").glob("*.glb"))
        scenes += [(f"{kind} {i}", path) for i, path in enumerate(files)]
    return scenes


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    parser.add_argument("--keep", type=pathlib.Path,
                        help="folder for the scenes, used again; else a temporary one")
    parser.add_argument("--only", default="", help="scenes whose title has this text")
    arguments = parser.parse_args()

    def run(tool, *words):
        done = subprocess.run([str(arguments.bin / tool), *map(str, words)], capture_output=True,
                              text=True)
        if done.returncode:
            sys.exit(f"{tool} {' '.join(map(str, words))}: {done.stderr}")
        return done.stderr

    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        scenes = [("Cornell box, glTF", ASSETS / "cornell_box.glb"),
                  ("Cornell box, PBRT", ASSETS / "cornell_box.pbrt"),
                  ("living room", ASSETS / "living_room.glb")]
        if not arguments.only:
            scenes += generated(run, folder)
        scenes += written(folder)
        scenes += [(path.stem, path) for path in arguments.files]
        scenes = [scene for scene in scenes if arguments.only in scene[0]]
        sky = folder / "sky.pfm"
        subprocess.run([sys.executable, MAKE_SKY, sky], check=True)
        tiles = []
        for title, path in scenes:
            picture = folder / "picture.png"
            flags = [] if path.suffix != ".ply" else ["--up", "z"]
            lit = path.suffix in (".glb", ".pbrt") or "lamp\n" in path.read_text(errors="ignore")
            if not lit:
                flags += ["--environment", sky]
            said = run("lte_render", path, "--integrator", "path", "--spp", 20, "--camera", "auto",
                       "--size", f"{2 * SIZE[0]}x{2 * SIZE[1]}", "--out", picture, *flags)
            print(f"{title}:", " ".join(line for line in said.splitlines() if "camera:" in line))
            tile = Image.open(io.BytesIO(picture.read_bytes())).convert("RGB").resize(
                SIZE, Image.LANCZOS)
            box = (0, 0, 6 * len(title) + 6, 13)
            ImageDraw.Draw(tile).rectangle(box, fill=(0, 0, 0))
            ImageDraw.Draw(tile).text((3, 1), title, fill=(255, 255, 255))
            tiles.append(tile)
    rows = -(-len(tiles) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * SIZE[0], rows * SIZE[1]), (40, 40, 40))
    for i, tile in enumerate(tiles):
        sheet.paste(tile, (i % COLUMNS * SIZE[0], i // COLUMNS * SIZE[1]))
    sheet.save(arguments.out, quality=88)


if __name__ == "__main__":
    main()
