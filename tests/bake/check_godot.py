#!/usr/bin/env python3
"""Holds what lte_bake writes for Godot 4 to names and types of Godot's classes.

usage: check_godot.py FOLDER

From Godot's repository: doc/classes/LightmapGIData.xml, LightmapGI.xml and
ResourceImporterLayeredTexture.xml, scene/3d/lightmap_gi.cpp (properties that are not in the
documentation, and the keys that its own baker writes).
"""
import json
import pathlib
import re
import struct
import sys

# Stored properties of LightmapGIData.
PROPERTIES = {"lightmap_textures": "Array[TextureLayered]", "uses_spherical_harmonics": "bool",
              "user_data": "Array", "probe_data": "Dictionary", "_uses_packed_directional": "bool"}
# add_user(path, uv_scale, slice_index, sub_instance), which user_data repeats.
USER = ("NodePath", "Rect2", "int", "int")
PROBE_DATA = {"baked_exposure": "float", "bounds": "AABB", "bsp": "PackedInt32Array",
              "interior": "bool", "lightprobe_hash": "int", "points": "PackedVector3Array",
              "sh": "PackedColorArray", "tetrahedra": "PackedInt32Array"}
# Methods and properties of LightmapGIData, with the number of arguments.
MEMBERS = {"add_user": 4, "clear_users": 0, "get_user_count": 0, "get_user_path": 1,
           "is_using_spherical_harmonics": 0, "set_uses_spherical_harmonics": 1,
           "lightmap_textures": None, "shadowmask_textures": None}
IMPORT = {"compress/mode": int, "compress/channel_pack": int, "mipmaps/generate": bool,
          "slices/horizontal": int, "slices/vertical": int}


def split(text):
    """The items of a list, by the commas outside of brackets and quotes."""
    items, depth, quoted, item = [], 0, False, ""
    for c in text:
        quoted ^= c == '"'
        depth += 0 if quoted else (c in "([{") - (c in ")]}")
        if c == "," and depth == 0 and not quoted:
            items.append(item.strip())
            item = ""
        else:
            item += c
    return items + [item.strip()] if item.strip() else items


def type_of(value):
    """The type of a value in Godot's text format."""
    if value in ("true", "false"):
        return "bool"
    if re.fullmatch(r"-?\d+", value):
        return "int"
    if re.fullmatch(r"-?\d+\.\d*(e-?\d+)?", value):
        return "float"
    if value.startswith("["):
        return "Array"
    if value.startswith("{"):
        return "Dictionary"
    return re.match(r"(\w+(\[\w+\])?)\(", value)[1]


def check_rect(value):
    x, y, width, height = map(float, split(value[len("Rect2("):-1]))
    assert 0 <= x and 0 <= y and x + width <= 1 and y + height <= 1, value


def check_data(folder, nodes):
    head, *sections = re.split(r"^(?=\[)", (folder / "lightmap.tres").read_text(), flags=re.M)[1:]
    assert re.fullmatch(r'\[gd_resource type="LightmapGIData" load_steps=2 format=3\]\s*', head)
    external, resource = sections
    found = re.fullmatch(r'\[ext_resource type="(\w+)" path="([^"]+)" id="(\w+)"\]\s*', external)
    assert found[1] == "CompressedTexture2DArray" and (folder / found[2]).exists(), external
    text = resource.split("]", 1)[1].strip()
    assert resource.startswith("[resource]\n")
    values = dict(re.findall(r"^(\w+) = (.*?)(?=\n\w+ = |\Z)", text, flags=re.M | re.S))
    assert {name: type_of(value) for name, value in values.items()} == PROPERTIES, values.keys()
    assert f'ExtResource("{found[3]}")' in values["lightmap_textures"]
    users = split(values["user_data"][1:-1])
    assert len(users) == len(USER) * len(nodes), len(users)
    for i in range(0, len(users), 4):
        assert tuple(type_of(value) for value in users[i:i + 4]) == USER, users[i:i + 4]
        path = re.fullmatch(r'NodePath\("\.\./Scene/([^"/]+)"\)', users[i])[1]
        assert path in nodes, path
        check_rect(users[i + 1])
        assert users[i + 2] == "0" and users[i + 3] == "-1"  # the only slice; not of a multimesh
    probes = {key.strip('"'): type_of(value.strip()) for key, value in
              (item.split(":", 1) for item in split(values["probe_data"].strip()[1:-1]))}
    assert probes == PROBE_DATA, probes


def check_script(folder, nodes):
    text = (folder / "lightmap.gd").read_text()
    assert text.count("extends Node3D") == 1 and "\n    " not in text, "tabs indent"
    listed = json.loads(re.search(r"const NODES: Array\[String\] = (\[.*\])", text)[1])
    assert sorted(listed) == sorted(nodes)
    assert "LightmapGIData.new()" in text and "LightmapGI.new()" in text
    for name, call in re.findall(r"\bdata\.(\w+)(\(.*\))?", text):
        expected = MEMBERS[name]
        assert expected is None or len(split(call[1:-1])) == expected, (name, call)
    assert "light_map.light_data = data" in text


def check_import(folder):
    sections, values = {}, None
    for line in (folder / "lightmap.exr.import").read_text().splitlines():
        if line.startswith("["):
            values = sections.setdefault(line[1:-1], {})
        elif line:
            key, value = line.split("=", 1)
            values[key] = json.loads(value)
    assert sections["remap"] == {"importer": "2d_array_texture", "type": "CompressedTexture2DArray"}
    params = sections["params"]
    assert {key: type(value) for key, value in params.items()} == IMPORT, params
    assert params["slices/horizontal"] == params["slices/vertical"] == 1
    assert not params["mipmaps/generate"]


def node_names(path):
    data = path.read_bytes()
    (size, ) = struct.unpack_from("<I", data, 12)
    return {node["name"] for node in json.loads(data[20:20 + size])["nodes"] if "mesh" in node}


out = pathlib.Path(sys.argv[1])
names = node_names(out / "scene.glb")
assert names
check_data(out, names)
check_script(out, names)
check_import(out)
print(f"check_godot: {len(names)} users")
