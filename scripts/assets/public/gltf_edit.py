"""A .glb of others with another scale, and with the lamps and the camera that its project has
elsewhere."""
import json
import math
import struct

from rooms.glb import LIGHTS, looking


def parts(data):
    """JSON and binary chunk."""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[20 + length:]


def edited(data, source):
    document, rest = parts(data)
    scene = document["scenes"][document.get("scene", 0)]
    nodes = document["nodes"]
    if source.scale != 1:
        nodes.append({"name": "metres", "scale": [source.scale] * 3, "children": scene["nodes"]})
        scene["nodes"] = [len(nodes) - 1]

    def add(node):
        nodes.append(node)
        scene["nodes"].append(len(nodes) - 1)

    if source.camera:
        eye, target, degrees = source.camera
        document.setdefault("cameras", []).insert(0, {
            "name": "camera", "type": "perspective",
            "perspective": {"yfov": round(math.radians(degrees), 6), "znear": 0.01}
        })
        for node in nodes:
            if "camera" in node:
                node["camera"] += 1
        add({"name": "camera", "camera": 0, "translation": list(eye),
             "rotation": looking(eye, target)})
    for i, (place, intensity) in enumerate(source.lights):
        lights = document.setdefault("extensions", {}).setdefault(LIGHTS, {"lights": []})["lights"]
        strongest = max(intensity)
        lights.append({"name": f"light {i}", "type": "point", "intensity": strongest,
                       "color": [round(v / strongest, 6) for v in intensity]})
        add({"name": f"light {i}", "translation": list(place),
             "extensions": {LIGHTS: {"light": len(lights) - 1}}})
    if source.lights and LIGHTS not in document.setdefault("extensionsUsed", []):
        document["extensionsUsed"].append(LIGHTS)
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) +
            struct.pack("<I4s", len(text), b"JSON") + text + rest)
