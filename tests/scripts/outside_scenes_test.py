#!/usr/bin/env python3
"""scripts/assets/make_outside_rooms.py and get_outside_scenes.py: the rooms' meshes against closed
forms, and small scenes of other renderers whose right answer is known."""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
ASSETS = ROOT / "scripts" / "assets"
sys.dont_write_bytecode = True
sys.path.insert(0, str(ASSETS))
from public import convert  # noqa: E402
from public.sources import SOURCES  # noqa: E402
from rooms import glb, shapes  # noqa: E402
from rooms.shell import shell  # noqa: E402


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def corners(mesh):
    return [[mesh.points[c] for c in triangle] for triangle in mesh.triangles]


def normals(mesh):
    """Twice the area vector of each triangle."""
    return [cross([q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)])
            for a, b, c in corners(mesh)]


def volume(mesh):
    """Positive where fronts are outside."""
    return sum(sum(p * n for p, n in zip(a, cross(b, c))) for a, b, c in corners(mesh)) / 6


def contents(data):
    """A .glb of ours: the document, and (points, triangles) of each node in the world, unturned."""
    length = struct.unpack_from("<I", data, 12)[0]
    document, blob = json.loads(data[20:20 + length]), data[28 + length:]

    def values(number):
        accessor = document["accessors"][number]
        code = {5126: "f", 5123: "H", 5125: "I"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        start = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        flat = struct.unpack_from(f"<{accessor['count'] * width}{code}", blob, start)
        return list(zip(*[iter(flat)] * width)) if width > 1 else flat

    found = {}
    for node in document["nodes"]:
        if "mesh" in node:
            primitive = document["meshes"][node["mesh"]]["primitives"][0]
            mesh = shapes.Mesh()
            mesh.points = values(primitive["attributes"]["POSITION"])
            mesh.triangles = list(zip(*[iter(values(primitive["indices"]))] * 3))
            found[node["name"]] = (mesh, document["materials"][primitive["material"]])
    return document, found


def run(script, *arguments):
    return subprocess.run([sys.executable, "-B", ASSETS / script, *map(str, arguments)],
                          capture_output=True, text=True, check=False)


class Shapes(unittest.TestCase):
    def test_bodies_face_outwards_and_have_their_volume(self):
        for mesh, wanted, share in ((shapes.box((0, 0, 0), (1, 2, 3)), 6, 1e-9),
                                    (shapes.sphere(1, segments=96), 4.18879, 0.003),
                                    (shapes.cylinder(1, 2, segments=96), 6.28319, 0.001),
                                    (shapes.rounded((1, 2, 3), 0.2, steps=8), 5.806, 0.002),
                                    (shapes.extruded([(0, 0), (0, 1), (1, 1)], 6), 3, 1e-9)):
            self.assertAlmostEqual(volume(mesh), wanted, delta=share * wanted)

    def test_an_l_shaped_room_faces_inwards_and_is_closed(self):
        plan = [(0, 0), (0, 4), (2, 4), (2, 1), (5, 1), (5, 0)]
        doc = glb.Document("room")
        white = doc.material("white", (0.5, 0.5, 0.5))
        shell(doc, plan, 2.5, white, white, white)
        whole = shapes.merged([mesh for mesh, _ in contents(doc.bytes())[1].values()])
        self.assertAlmostEqual(volume(whole), -(8 + 3) * 2.5, places=4)
        sums = [sum(n[k] for n in normals(whole)) for k in range(3)]
        self.assertLess(max(map(abs, sums)), 1e-4)

    def test_an_opening_leaves_its_area_out(self):
        wall = shapes.sheet((0, 0), (4, 0), 2.5, [(1, 2, 0, 2), (2.5, 3.5, 1, 2)])
        self.assertAlmostEqual(sum(-n[2] / 2 for n in normals(wall)), 10 - 2 - 1)


class Rooms(unittest.TestCase):
    def test_check_tells_a_changed_file(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run("make_outside_rooms.py", "cube_inside_out", "--out",
                                 folder).returncode, 0)
            file = pathlib.Path(folder) / "cube_inside_out.glb"
            check = ("make_outside_rooms.py", "cube_inside_out", "--check", "--out", folder)
            self.assertEqual(run(*check).returncode, 0)
            data = bytearray(file.read_bytes())
            data[-1] ^= 1
            file.write_bytes(data)
            done = run(*check)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))
            self.assertIn("cube_inside_out.glb", done.stderr)

    def test_a_name_that_is_none_is_one_line(self):
        done = run("make_outside_rooms.py", "nowhere")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))
        self.assertIn("nowhere", done.stderr)


SQUARE = b"v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3 4\n"  # faces up
NORI = b"""<scene><camera type="perspective"><float name="fov" value="90"/>
<transform name="toWorld"><lookat origin="0, 1, 3" target="0, 1, 0" up="0, 1, 0"/></transform>
<integer name="width" value="200"/><integer name="height" value="100"/></camera>
<mesh type="obj"><string name="filename" value="square.obj"/>
<bsdf type="diffuse"><color name="albedo" value="0.2 0.4 0.6"/></bsdf></mesh>
<mesh type="obj"><string name="filename" value="square.obj"/>
<transform name="toWorld"><scale value="0.5,-1,0.5"/><translate value="0,2,0"/></transform>
<emitter type="area"><color name="radiance" value="40 30 20"/></emitter></mesh></scene>"""


class Converted(unittest.TestCase):
    def test_nori_keeps_which_side_shines_through_a_mirror(self):
        read = {"scenes/a.xml": NORI, "scenes/square.obj": SQUARE}.__getitem__
        document, found = contents(convert.from_xml("a", "scenes/a.xml", read, 2.0).bytes())
        (floor, matt), (light, glow) = found["shape 0"], found["shape 1"]
        self.assertEqual(matt["pbrMetallicRoughness"]["baseColorFactor"][:3], [0.2, 0.4, 0.6])
        self.assertEqual({p[1] for p in light.points}, {4.0})
        self.assertTrue(all(n[1] > 0 for n in normals(floor)))
        self.assertTrue(all(n[1] < 0 for n in normals(light)))  # as mirrored in y
        self.assertAlmostEqual(sum(-n[1] / 2 for n in normals(light)), 4.0)
        self.assertNotIn("doubleSided", glow)
        strength = glow["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
        self.assertEqual([round(e * strength, 3) for e in glow["emissiveFactor"]], [40, 30, 20])
        self.assertAlmostEqual(document["cameras"][0]["perspective"]["yfov"], 2 * 0.463648, 5)

    def test_renderformer_turns_z_up_and_scales(self):
        place = {"translation": [0, 0, 1], "rotation": [0, 0, 0], "scale": [1, 1, 1]}
        look = {"diffuse": [0.3, 0.3, 0.3], "specular": [0.2, 0, 0], "emissive": [0, 0, 0]}
        scene = {"objects": {"a": {"mesh_path": "square.obj", "transform": place,
                                   "material": look}},
                 "cameras": [{"position": [0, -2, 1], "look_at": [0, 0, 1], "fov": 40}]}
        read = {"e/s.json": json.dumps(scene).encode(), "e/square.obj": SQUARE}.__getitem__
        document, found = contents(convert.from_renderformer("s", "e/s.json", read, 4.0).bytes())
        mesh, material = found["a"]
        self.assertEqual({p[2] for p in mesh.points}, {0.0})  # its y
        self.assertEqual({p[1] for p in mesh.points}, {0.0, 8.0})
        self.assertEqual(material["pbrMetallicRoughness"]["baseColorFactor"][:3], [0.5, 0.3, 0.3])
        camera = next(node for node in document["nodes"] if "camera" in node)
        self.assertEqual(camera["translation"], [0, 4, 8])

    def test_missing_repositories_are_a_line_each(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run("get_outside_scenes.py", folder, "--out", folder + "/out")
            self.assertEqual(done.returncode, 1)
            self.assertEqual(done.stderr.count("\n"), len(SOURCES))
            self.assertIn("bevyengine+bevy: no such folder", done.stderr)
            self.assertFalse(pathlib.Path(folder, "out").exists())
        done = run("get_outside_scenes.py", "/nowhere")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))


if __name__ == "__main__":
    unittest.main()
