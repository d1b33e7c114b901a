#!/usr/bin/env python3
"""lte_bake --since: what has not changed is the same bytes, a moved block is baked anew, and what
does not go has one line, exit code 1, and costs no file.

usage: tests/bake/check_since.py LTE_BAKE SCENE.glb     the Cornell box
"""
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile


def moved(source, node, by):
    """The bytes of a .glb with a node elsewhere."""
    data = source.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20:20 + length])
    found = next(one for one in document["nodes"] if one.get("name") == node)
    found["translation"] = by
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    tail = data[20 + length:]
    return data[:8] + struct.pack("<II", 20 + len(text) + len(tail), len(text)) + data[16:20] \
        + text + tail


def main():
    tool, source = sys.argv[1], pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene, old, out = folder / "box.glb", folder / "old", folder / "out"
        shutil.copy(source, scene)

        def expect(condition, what):
            if not condition:
                sys.exit(f"check_since: {what}")

        def bake(*flags, into=out):
            return subprocess.run([tool, str(scene), "--out", str(into), *flags],
                                  capture_output=True, text=True, timeout=300)

        def good(*flags, into=out):
            run = bake(*flags, into=into)
            expect(run.returncode == 0, run.stderr)
            return json.loads((into / "lightmap.json").read_text())

        def refused(word, *flags):
            before = {path.name: path.read_bytes() for path in out.iterdir()}
            run = bake(*flags)
            lines = [line for line in run.stderr.splitlines() if "error" in line or word in line]
            expect(run.returncode == 1 and len(lines) == 1 and word in lines[0],
                   f"expected 1 line with '{word}', got rc {run.returncode}: {run.stderr}")
            expect({path.name: path.read_bytes() for path in out.iterdir()} == before,
                   f"'{word}' cost an earlier bake")

        draft = ("--quality", "draft")
        since = ("--since", str(old), *draft)
        first = good(*draft, "--texels-per-metre", "64", "--keep-samples", into=old)
        picture = (old / "lightmap.exr").read_bytes()
        rectangles = first["rectangles"]

        same = good(*since)
        expect((out / "lightmap.exr").read_bytes() == picture,
               "a scene that has not changed has another picture")
        expect(same["kept_texels"] > 0, "no texel is kept of a scene that has not changed")

        scene.write_bytes(moved(source, "short block", [-0.1, 0, 0]))
        again = good(*since)
        expect(again["rectangles"] == rectangles, "a rectangle has moved")
        expect(0 < again["kept_texels"] < same["kept_texels"],
               f"{again['kept_texels']} of {same['kept_texels']} texels are kept")
        expect((out / "lightmap.exr").read_bytes() != picture, "a moved block changes nothing")

        # From one folder into the same, there and back.
        good("--since", str(out), *draft)
        scene.write_bytes(source.read_bytes())
        back = good("--since", str(out), *draft)
        expect(back["rectangles"] == rectangles, "a rectangle has moved on the way back")

        refused("was baked with quality draft, not preview", "--since", str(old))
        refused("was baked with seed 0, not 5", *since, "--seed", "5")
        refused("was baked with environment", *since, "--environment", "1,1,1")
        refused("--size: --since keeps the atlas", *since, "--size", "512")
        refused("without --by-light", *since, "--by-light")
        refused("change goes with --since", *draft, "--set", "change=0.1")
        damaged = folder / "damaged"
        shutil.copytree(old, damaged)
        data = bytearray((damaged / "since.safetensors").read_bytes())
        data[-100] ^= 1
        (damaged / "since.safetensors").write_bytes(data)
        refused("since.safetensors", *draft, "--since", str(damaged))
        (damaged / "since.safetensors").unlink()
        refused("has no since.safetensors", *draft, "--since", str(damaged))
        print("check_since: what has not changed stays")


main()
