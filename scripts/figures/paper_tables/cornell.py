"""The row of the Cornell box by triangles: pictures by our network, and what a network that reads
triangles takes for the same."""
import json
import struct

from .words import digits

BOX = "assets/scenes/cornell_box.glb"
DIVISIONS = (1, 4, 8, 16, 32, 56)  # of each edge: 32 to 100,352 triangles
MOST_TOKENS = 2048  # triangles of RenderFormer's shape: its time grows with their square


def accessor(gltf, data, index):
    """Rows of floats or indices."""
    entry = gltf["accessors"][index]
    view = gltf["bufferViews"][entry["bufferView"]]
    kind = {5126: "f", 5125: "I"}[entry["componentType"]]
    width = {"VEC3": 3, "SCALAR": 1}[entry["type"]]
    begin = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
    values = struct.unpack_from(f"<{entry['count'] * width}{kind}", data, begin)
    return [values[i:i + width] for i in range(0, len(values), width)]


def divided(corners, n):
    """n² triangles that fill a triangle, as positions and indices, wound the same way."""
    a, b, c = corners
    grid, positions = {}, []
    for i in range(n + 1):
        for j in range(n + 1 - i):
            grid[i, j] = len(positions)
            u, v = i / n, j / n
            positions.append(tuple((1 - u - v) * x + u * y + v * z for x, y, z in zip(a, b, c)))
    triangles = []
    for i in range(n):
        for j in range(n - i):
            triangles.append((grid[i, j], grid[i + 1, j], grid[i, j + 1]))
            if i + j < n - 1:
                triangles.append((grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]))
    return positions, triangles


def tessellated(source, target, n):
    """Writes the scene with every triangle cut into n²; returns how many it has."""
    data = source.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    gltf, buffer = json.loads(data[20:20 + size]), data[28 + size:]
    accessors, views, out, count = [], [], b"", 0
    for mesh in gltf["meshes"]:
        for primitive in mesh["primitives"]:
            points = accessor(gltf, buffer, primitive["attributes"]["POSITION"])
            corners = [i for (i,) in accessor(gltf, buffer, primitive["indices"])]
            positions, indices = [], []
            for k in range(0, len(corners), 3):
                more, triangles = divided([points[i] for i in corners[k:k + 3]], n)
                indices += [i + len(positions) for triangle in triangles for i in triangle]
                positions += more
            count += len(indices) // 3
            for values, kind, component, shape in (
                    ([x for p in positions for x in p], "f", 5126, "VEC3"),
                    (indices, "I", 5125, "SCALAR")):
                packed = struct.pack(f"<{len(values)}{kind}", *values)
                views.append({"buffer": 0, "byteOffset": len(out), "byteLength": len(packed)})
                accessors.append({"bufferView": len(views) - 1, "componentType": component,
                                  "count": len(positions) if shape == "VEC3" else len(indices),
                                  "type": shape})
                out += packed
            accessors[-2] |= {"min": [min(p[c] for p in positions) for c in range(3)],
                              "max": [max(p[c] for p in positions) for c in range(3)]}
            primitive["attributes"] = {"POSITION": len(accessors) - 2}
            primitive["indices"] = len(accessors) - 1
    gltf |= {"accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(out)}]}
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    target.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(out), len(text),
                                   0x4E4F534A) + text + struct.pack("<II", len(out), 0x004E4942)
                       + out)
    return count


def picture(run, label, scene, *words):
    path = run.folder(label + ".exr")
    (run.root / path).unlink(missing_ok=True)
    return path, run.tool(label, "lte_render", scene, "--out", path, "--size",
                          run.size("256x256", "96x96"), "--threads", 1, *words)


def cornell(run):
    reference, _ = picture(run, "reference", BOX, "--integrator", "path", "--spp",
                           run.size(4096, 512))
    rows = []
    for n in run.size(DIVISIONS, (1, 8, 56)):
        scene = run.folder(f"cornell-{n}.glb")
        count = tessellated(run.root / BOX, run.root / scene, n)
        label = f"network-{count}"
        path, found = picture(run, label, scene, "--integrator", "network", "--checkpoint",
                              "assets/models/lte.safetensors")
        score = run.tool(f"score-{count}", "lte_eval", "pictures", path, "--reference", reference)
        row = {"triangles": count, "relmse": score[0]["relmse"],
               "flip": score[0]["flip"], "cpu": run.cpu_seconds(label),
               "peak_rss_mb": found["peak_rss_mb"]}
        if count <= MOST_TOKENS:
            theirs = run.tool(f"renderformer-{count}", "experiment_paper", "memory", "--network",
                              "renderformer", "--primitives", count, "--side",
                              run.size(256, 96), "--forward-only", "--threads", 1)
            row |= {"rf_cpu": theirs["cpu_seconds"], "rf_mb": theirs["peak_rss_mb"]}
        rows.append(row)
    return rows


def line(rows):
    ours = "; ".join(f"{row['triangles']:,} {digits(row['relmse'], 2)}, {digits(row['cpu'], 2)}, "
                     f"{row['peak_rss_mb']:.0f}" for row in rows)
    theirs = "; ".join(f"{row['triangles']:,} {digits(row['rf_cpu'], 2)}, {row['rf_mb']:.0f}"
                       for row in rows if "rf_cpu" in row)
    return (f"network, by triangles: relative MSE, CPU s, MB {ours}. RenderFormer's shape, without "
            f"weights: CPU s, MB {theirs}")
