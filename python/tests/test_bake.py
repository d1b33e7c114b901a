"""Light maps, against lte_bake's files and against what is known of them."""
import json

import numpy as np
import pytest

import lte

pytestmark = pytest.mark.skipif(not hasattr(lte._lte, "bake"), reason="built without xatlas")
FILES = {"lightmap.exr", "lightmap.json", "scene.glb", "scene_unlit.glb"}


def test_a_light_map_is_the_file_of_lte_bake(room, room_file, tmp_path, tool):
    tool("lte_bake", room_file, "--texels-per-metre", 4, "--quality", "draft", "--by-light",
         "--seed", 7, "--out", tmp_path / "tool")
    baked = lte.bake(room, texels_per_metre=4, quality="draft", by_light=True, seed=7)
    baked.save(tmp_path / "python")
    assert {path.name for path in (tmp_path / "python").iterdir()} == FILES
    for name in FILES - {"lightmap.json"}:  # which has the seconds that it took
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "tool" / name).read_bytes()


def test_progress_is_shown_when_asked_for(room, capfd):
    quiet = lte.bake(room, texels_per_metre=2, quality="draft")
    assert not capfd.readouterr().err
    shown = lte.bake(room, texels_per_metre=2, quality="draft", progress=True)
    assert "baking" in capfd.readouterr().err
    np.testing.assert_array_equal(shown.irradiance, quiet.irradiance)
    lte.bake(room, texels_per_metre=2, quality="draft")
    assert not capfd.readouterr().err


def test_layers_add_up_to_light(room):
    baked = lte.bake(room, texels_per_metre=4, quality="draft", by_light=True)
    assert list(baked.layers) == [lamp.name for lamp in room.lights]
    np.testing.assert_allclose(sum(baked.layers.values()), baked.irradiance, rtol=1e-6)
    height, width = baked.mask.shape
    assert baked.irradiance.shape == (height, width, 3) and baked.mask.dtype == np.uint8
    lit, outside = baked.mask == baked.LIT, baked.mask == baked.OUTSIDE
    assert lit.any() and (baked.irradiance[lit] >= 0).all() and not baked.irradiance[outside].any()
    assert 0 < baked.expected_error < 1 and baked.texels_per_metre == pytest.approx(4, rel=0.3)


def test_a_white_furnace_is_even(tmp_path):
    """Inside of a box that shines and reflects, light is a geometric series everywhere."""
    (tmp_path / "box.mtl").write_text("newmtl m\nKd 0.5 0.5 0.5\nKe 1 1 1\n")
    corners = [f"v {x} {y} {z}" for x in (0, 3) for y in (0, 2) for z in (0, 4)]
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    (tmp_path / "box.obj").write_text("\n".join(
        ["mtllib box.mtl", *corners, "usemtl m", *(f"f {face}" for face in faces)]))
    baked = lte.bake(lte.load(tmp_path / "box.obj"), texels_per_metre=3, depth=3)
    known = np.pi * (1 + 0.5 + 0.25)
    lit = baked.irradiance[baked.mask == baked.LIT]
    assert np.median(abs(lit - known)) < 0.02 * known and abs(lit.mean() / known - 1) < 0.01


def test_a_bake_goes_on_since_another(room, tmp_path):
    first = lte.bake(room, texels_per_metre=4, quality="draft", keep_samples=True)
    first.save(tmp_path)
    again = lte.bake(room, quality="draft", since=tmp_path)
    assert (again.irradiance == first.irradiance).all() and (again.mask == first.mask).all()
    with pytest.raises(lte.Error, match="was baked with quality draft, not preview"):
        lte.bake(room, since=tmp_path)
    with pytest.raises(lte.Error, match="since"):
        lte.bake(room, since=tmp_path, size=64)


def test_probes_and_engines_are_saved(room, tmp_path):
    baked = lte.bake(room, texels_per_metre=2, quality="draft", probes="2x2x2")
    baked.save(tmp_path / "godot", format="godot")
    baked.save(tmp_path / "bevy", format="bevy")
    assert {"probes.json", "lightmap.exr"} <= {p.name for p in (tmp_path / "godot").iterdir()}
    assert "lightmap.ktx2" in {p.name for p in (tmp_path / "bevy").iterdir()}


def test_vertex_colors_are_the_file_of_lte_bake(room, room_file, tmp_path, tool):
    tool("lte_bake", room_file, "--texels-per-metre", 8, "--quality", "draft", "--format",
         "vertex-colors", "--set", "bend=0.3", "--out", tmp_path / "tool")
    baked = lte.bake(room, texels_per_metre=8, quality="draft")
    baked.save(tmp_path / "python", format="vertex-colors", bend=0.3)
    made = (tmp_path / "python" / "scene.glb").read_bytes()
    assert made == (tmp_path / "tool" / "scene.glb").read_bytes()
    baked.save(tmp_path / "few", format="vertex-colors", bend=0.3, max_triangles=1)
    few = lte.load(tmp_path / "few" / "scene.glb").triangles
    assert few == room.triangles < lte.load(tmp_path / "python" / "scene.glb").triangles


def test_vertex_colors_have_light_groups(room_file, tmp_path, tool):
    tool("lte_bake", room_file, "--add-light", "auto", "--texels-per-metre", 4, "--quality",
         "draft", "--by-light", "--format", "vertex-colors", "--out", tmp_path / "tool")
    room = lte.load(room_file, add_light="auto")
    baked = lte.bake(room, texels_per_metre=4, quality="draft", by_light=True)
    baked.save(tmp_path / "python", format="vertex-colors")
    made = (tmp_path / "python" / "scene.glb").read_bytes()
    assert made == (tmp_path / "tool" / "scene.glb").read_bytes()
    groups = json.loads((tmp_path / "python" / "vertex_light.json").read_text())["groups"]
    assert [group["name"] for group in groups] == list(baked.layers) and len(groups) > 1
    assert all(f'"{group["attribute"]}":'.encode() in made for group in groups)


@pytest.mark.parametrize("options, words", [
    ({"size": 8}, "size: expected 16 to"), ({"texels_per_metre": 0}, "texels_per_metre: expected"),
    ({"texels_per_metre": 1e5}, "texels"), ({"quality": "best"}, "quality: expected draft"),
    ({"include": "half"}, "include: expected full | indirect"), ({"probes": "2x2"}, "probes"),
    ({"integrator": "light"}, "integrator: expected gather | network | path"),
    ({"keep_uvs": True}, "TEXCOORD_1")])
def test_wrong_options_are_named(room, options, words):
    with pytest.raises((ValueError, lte.Error)) as caught:
        lte.bake(room, **options)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_wrong_places_are_named(room, tmp_path):
    baked = lte.bake(room, texels_per_metre=2, quality="draft")
    (tmp_path / "file").write_text("")
    with pytest.raises(lte.Error, match="file"):
        baked.save(tmp_path / "file")
    with pytest.raises(ValueError, match="format: expected gltf"):
        baked.save(tmp_path / "a", format="fbx")
    with pytest.raises(lte.Error, match="three"):
        baked.save(tmp_path / "a", format="three")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
