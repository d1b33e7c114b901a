"""The page beside the rooms: what each file holds, its seed and versions, from its own header."""
import json
import struct

HEAD = """# Rooms of Infinigen

Written by `scripts/assets/infinigen/make_rooms.py`, which reads each row from the header of its
file. Infinigen Indoors is the generator of the paper's own training data; its code is under the
BSD 3-clause license (Princeton University), and the rooms hold only what it generated.

Against Infinigen's own rooms: modifiers and instances are applied and meshes decimated; materials
are matt, with the base color baked; panes and covers of lamps are left out, and a lamp is a sphere
of its radius and power. By day lamps are out, and panes shine inwards as an overcast sky does
through frosted glass. Rooms next door are there as far as light from the furnished room reaches
them.

| file | room | seed | made by | triangles | lamps | panes | MB |
|---|---|---|---|---|---|---|---|
"""


def header(path):
    """The JSON chunk of a .glb."""
    with path.open("rb") as file:
        size = struct.unpack("<4sII I4s", file.read(20))[3]
        return json.loads(file.read(size))


def write(folder):
    rows = []
    for path in sorted(folder.glob("infinigen_*.glb")):
        extras = header(path)["asset"]["extras"]
        rows.append(f"| {path.name} | {extras['room']} | {extras['seed']} | {extras['source']} | "
                    f"{extras['triangles']} | {extras['lamps']} | "
                    f"{extras.get('panes', 0)} | "
                    f"{path.stat().st_size / 1e6:.1f} |\n")
    if rows:
        (folder / "infinigen.md").write_text(HEAD + "".join(rows))
