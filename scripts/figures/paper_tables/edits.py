"""The row of edits: what a change of a room does to its light, by network, gather and paths."""
import itertools
import json
import math
import random
import struct

from sample_file import read_floats

from .words import digits

ROOM = "assets/scenes/living_room.glb"
CHANGES = ("lamp moved 1 m", "sofa moved 0.6 m", "floor green", "walls red")
# Meshes and metres of a change; points on what moves, or where it comes to, do not count.
PIECES = {CHANGES[0]: (range(45, 48), (1.0, 0, 0)), CHANGES[1]: (range(16, 20), (0, 0, -0.6))}
MARGIN = 0.01  # metres around it


def read_rows(path, name):
    """Of a tensor [n, 3]."""
    [(numbers, _)] = read_floats(path, name)
    return list(zip(*[iter(numbers)] * 3))


def gltf_of(data):
    """The JSON of a .glb, and where it ends."""
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), 20 + size


def boxes_of_moved(gltf, change):
    """World bounds of the pieces that a change moves, where they were and where they come to."""
    meshes, offset = PIECES.get(change, ((), (0, 0, 0)))
    boxes = []
    for node in gltf["nodes"]:
        if node.get("mesh") not in meshes:
            continue
        primitive = gltf["meshes"][node["mesh"]]["primitives"][0]
        bounds = gltf["accessors"][primitive["attributes"]["POSITION"]]
        m = node["matrix"]
        corners = [[sum(m[4 * axis + c] * p[axis] for axis in range(3)) + m[12 + c]
                    for c in range(3)]
                   for p in itertools.product(*zip(bounds["min"], bounds["max"]))]
        for step in ((0, 0, 0), offset):
            boxes.append([(min(p[c] for p in corners) + step[c] - MARGIN,
                           max(p[c] for p in corners) + step[c] + MARGIN) for c in range(3)])
    return boxes


def changed_room(source, target, change):
    """Writes the room with one of CHANGES."""
    data = source.read_bytes()
    gltf, end = gltf_of(data)
    colors = {CHANGES[2]: ("floor boards", [0.25, 0.9, 0.25, 1]),
              CHANGES[3]: ("wall", [0.9, 0.08, 0.08, 1])}
    if change in PIECES:
        meshes, offset = PIECES[change]
        for node in gltf["nodes"]:
            if node.get("mesh") in meshes:
                node["matrix"][12:15] = [a + b for a, b in zip(node["matrix"][12:15], offset)]
    for material in gltf["materials"]:
        if change in colors and material["name"] == colors[change][0]:
            material["pbrMetallicRoughness"]["baseColorFactor"] = colors[change][1]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    rest = data[end:]
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    target.write_bytes(head + text + rest)


def indirect_of(path):
    """Indirect irradiance at the points of a file of lte_probe."""
    lines = path.read_text().splitlines()
    head = lines[0].split(",")
    columns = [(head.index(f"total_{c}"), head.index(f"direct_{c}")) for c in "rgb"]
    values = [[float(word) for word in line.split(",")] for line in lines[1:]]
    return [[value[total] - value[direct] for total, direct in columns] for value in values]


def difference(first, second):
    return [[b - a for a, b in zip(p, q)] for p, q in zip(first, second)]


def norm(values):
    return math.sqrt(sum(x * x for value in values for x in value))


def measure(run, sample):
    sample = run.root / sample
    position, normal = read_rows(sample, "query_position"), read_rows(sample, "query_normal")
    picks = random.Random(1).sample(range(len(position)), run.size(2000, 300))
    points = run.root / run.folder("points.csv")
    points.write_text("px,py,pz,nx,ny,nz\n" + "".join(
        ",".join(repr(x) for x in position[i] + normal[i]) + "\n" for i in picks))
    light = {}
    for change in ("none", *CHANGES):
        scene = run.root / run.folder(change.replace(" ", "-") + ".glb")
        changed_room(run.root / ROOM, scene, change)
        for method, spp in (("path", run.size(4096, 1024)), ("network", 256), ("gather", 256)):
            label = f"{scene.stem}-{method}"
            out = run.root / run.folder(label + ".csv")
            words = ["--checkpoint", "assets/models/lte.safetensors"] \
                if method == "network" else []
            run.tool(label, "lte_probe", scene.relative_to(run.root), "--points",
                     points.relative_to(run.root), "--out", out.relative_to(run.root),
                     "--integrator", method, "--spp", spp, *words)
            light[change, method] = indirect_of(out)
    gltf = gltf_of((run.root / ROOM).read_bytes())[0]
    rows = []
    for change in CHANGES:
        boxes = boxes_of_moved(gltf, change)
        counts = [k for k, i in enumerate(picks)
                  if not any(all(low <= x <= high for x, (low, high) in zip(position[i], box))
                             for box in boxes)]

        def of(scene, method):
            return [light[scene, method][k] for k in counts]
        truth = difference(of("none", "path"), of(change, "path"))
        for method in ("network", "gather"):
            ours = difference(of("none", method), of(change, method))
            after = difference(of(change, "path"), of(change, method))
            rows.append({"change": change, "method": method, "points": len(counts),
                         "size": norm(truth) / norm(of("none", "path")),
                         "error_of_change": norm(difference(truth, ours)) / norm(truth),
                         "error_after": norm(after) / norm(of(change, "path"))})
    return rows


def line(rows):
    by = {row["change"]: row for row in rows if row["method"] == "network"}
    return "error of the change, and of the light after it: " + "; ".join(
        f"{change} {digits(by[change]['error_of_change'], 2)}, "
        f"{digits(by[change]['error_after'], 2)}" for change in CHANGES)
