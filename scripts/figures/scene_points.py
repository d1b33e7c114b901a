"""What scripts share that ask lte_probe for light at points of many scenes."""
import csv
import sys

SUFFIXES = {".glb", ".gltf", ".pbrt", ".obj", ".ply"}
COLUMNS = ("px", "py", "pz", "nx", "ny", "nz")


def scene_files(paths):
    """The files that are named, and those of the folders."""
    out = []
    for path in paths:
        inside = sorted(file for file in path.rglob("*") if file.suffix in SUFFIXES)
        out += inside if path.is_dir() else [path]
    return out


def bake_command(args, scene, sample, rays):
    """Draws args.points points where light reaches, and traces so many paths from each."""
    return [args.bin / "lte_datagen", "bake", scene, "--out", sample, "--prune", "--scene-points",
            "64", "--views", "0", "--quiet", "--queries", str(args.points), "--rays", str(rays)]


def write_points(table, position, normal):
    """A table as --points reads it, of values [3 N]."""
    with open(table, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(COLUMNS)
        rows.writerows([*position[i:i + 3], *normal[i:i + 3]] for i in range(0, len(position), 3))


def read_table(path):
    """Its rows, numbers by column."""
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def check(command, done):
    """Ends the program with one line where a command has failed."""
    if done.returncode != 0:
        name = sys.argv[0].rpartition("/")[2]
        sys.exit(f"{name}: {' '.join(map(str, command))}: {done.stderr.strip()}")
