"""The network: models, embeddings, and light by them, against the tools and against paths."""
import csv
import os
import subprocess
import sys
import threading

import numpy as np
import pytest

import lte

NETWORK = lte.living_room.parents[1] / "models" / "lte.safetensors"
UP = np.float32([[0, 1, 0]])


@pytest.fixture(scope="module")
def model():
    return lte.Model.load()


@pytest.fixture(scope="module")
def embedding(model, room):
    return model.encode(room)


def test_a_model_says_what_it_is(model, embedding, room):
    assert model.name == "lte" and "lte" in repr(model)
    assert 3e6 < model.parameters < 4e6
    assert embedding.scene is room and embedding.scene_points >= 1024
    assert model.encode(room, scene_points=500).scene_points == 500


def test_shipped_models_have_names(model, monkeypatch, tmp_path):
    assert lte.Model.load("lte").parameters == model.parameters
    monkeypatch.setenv("LTE_ASSETS", str(tmp_path))
    with pytest.raises(lte.Error) as caught:
        lte.Model.load("lte-radiance")
    said = str(caught.value)
    assert "lte-radiance: no model of that name in" in said and "\n" not in said
    assert "Debian package lte-models" in said and "lte-radiance.safetensors" in said
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "lte-radiance.safetensors").symlink_to(NETWORK)
    assert lte.Model.load("lte-radiance").parameters == model.parameters


def test_direct_light_is_added(embedding, room, points):
    indirect = embedding.irradiance(*points)
    direct = embedding.irradiance(*points, direct=True) - indirect
    known = lte.trace.irradiance(room, *points, rays=4096, depth=1)
    assert known.direct.max() > 0.1
    assert (abs(direct - known.direct) < 6 * known.stderr + 0.1 * known.direct.max()).all()
    assert abs(direct.mean() / known.direct.mean() - 1) < 0.02


def test_errors_are_as_large_as_expected(model):
    """Two thirds of the points of a room lie within what is expected, nearly all within twice."""
    scene = lte.generate_scene("boxes", seed=4)
    points = scene.sample(600, seed=1)
    light, expected = model.encode(scene).irradiance(*points, error=True)
    assert light.shape == (600, 3) and expected.shape == (600,) and (expected >= 0).all()
    traced = lte.trace.irradiance(scene, *points, rays=4096)
    off = np.sqrt(((light - traced.indirect) ** 2).mean(1))
    noise = np.sqrt((traced.stderr ** 2).mean(1))
    assert (off < expected + noise).mean() > 0.6 and (off < 2 * expected + noise).mean() > 0.9
    dark = ~traced.total.any(1)  # inside of furniture
    assert 10 < dark.sum() and (off[dark] < 1.001 * expected[dark] + 1e-6).mean() > 0.9
    # It tells where: half of the points with the smaller ones have less of the error.
    least = expected < np.median(expected)
    assert off[least].mean() < off[~least].mean()


def test_an_answer_with_its_error_is_the_answer(embedding, points):
    plain = embedding.irradiance(*points)
    light, expected = embedding.irradiance(*points, error=True)
    np.testing.assert_allclose(light, plain, rtol=1e-4, atol=1e-5)  # at points put onto surfaces
    again = embedding.irradiance(*points, error=True)
    np.testing.assert_array_equal(again[1], expected)
    none = np.zeros((0, 3), np.float32)
    light, expected = embedding.irradiance(none, none, error=True, direct=True)
    assert light.shape == (0, 3) and expected.shape == (0,)


def test_a_picture_is_the_file_of_lte_render(model, room, room_file, tmp_path, tool):
    tool("lte_render", room_file, "--size", "40x24", "--camera", "auto", "--integrator", "network",
         "--checkpoint", NETWORK, "--quality", "preview", "--set", "denoise=off", "--out",
         tmp_path / "tool.exr")
    options = {"size": (40, 24), "camera": "auto", "integrator": "network", "quality": "preview",
               "denoise": False}
    for given in (model, None):  # the second answers from the scene's cache
        lte.render(room, model=given, **options).save(tmp_path / "python.exr")
        assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "tool.exr").read_bytes()
    gathered = lte.render(room, **{**options, "integrator": "gather"})
    again = lte.render(room, **options)
    assert not np.array_equal(gathered.color, again.color)
    again.save(tmp_path / "python.exr")
    assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "tool.exr").read_bytes()


def test_light_at_points_is_that_of_lte_probe(room, room_file, points, tmp_path, tool):
    with open(tmp_path / "points.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow("px py pz nx ny nz".split())
        rows.writerows([f"{v:.9g}" for v in row] for row in np.hstack(points))
    tool("lte_probe", room_file, "--points", tmp_path / "points.csv", "--out", tmp_path / "out.csv",
         "--integrator", "network", "--checkpoint", NETWORK, "--spp", 64)
    with open(tmp_path / "out.csv", newline="") as file:
        table = list(csv.DictReader(file))
    light = lte.irradiance(room, *points, integrator="network", spp=64)
    of_tool = np.array([[row[f"total_{c}"] for c in "rgb"] for row in table], np.float32)
    np.testing.assert_array_equal(light.total, of_tool)
    assert (light.expected_error > 0).any()


@pytest.mark.skipif(not hasattr(lte._lte, "bake"), reason="built without xatlas")
def test_a_light_map_is_the_file_of_lte_bake(room, room_file, tmp_path, tool):
    tool("lte_bake", room_file, "--texels-per-metre", 3, "--quality", "draft", "--integrator",
         "network", "--checkpoint", NETWORK, "--out", tmp_path / "tool")
    baked = lte.bake(room, texels_per_metre=3, quality="draft", integrator="network")
    baked.save(tmp_path / "python")
    assert (tmp_path / "python" / "lightmap.exr").read_bytes() == (
        tmp_path / "tool" / "lightmap.exr").read_bytes()


def test_decoded_light_is_near_paths(model):
    scene = lte.load(lte.living_room)
    at, side = scene.sample(400, seed=1)
    traced = lte.trace.irradiance(scene, at, side, rays=512).indirect.mean(1)
    found = model.encode(scene).irradiance(at, side).mean(1)
    lit = traced > 0.01 * traced.mean()
    assert np.median(abs(found - traced)[lit] / traced[lit]) < 0.15


def test_one_point_or_many_at_once(embedding, points):
    whole = embedding.irradiance(*points)
    alone = np.concatenate([embedding.irradiance(at[None], side[None])
                            for at, side in zip(*points)])
    np.testing.assert_allclose(alone, whole, rtol=1e-5)
    assert whole.dtype == np.float32 and whole.flags.owndata is False and whole.flags.writeable
    none = np.zeros((0, 3), np.float32)
    assert embedding.irradiance(none, none).shape == (0, 3)


def test_albedo_is_the_surfaces(embedding, points):
    at, side = (array[points[0][:, 1] < 1.9] for array in points)  # not of the lamp, which is black
    found = embedding.irradiance(at, side)
    gray = np.full_like(at, .5)
    np.testing.assert_array_equal(found, embedding.irradiance(at, side, albedo=gray))
    assert not np.array_equal(found, embedding.irradiance(at, side, albedo=np.full(at.shape, 0.9)))


def test_arrays_of_any_layout_give_the_same_answer(embedding, points):
    at, side = points
    want = embedding.irradiance(at, side)
    both = np.hstack(points)
    read_only = at.copy()
    read_only.flags.writeable = False
    for position, normal in ((both[:, :3], both[:, 3:]), (at.astype(float), side.astype(">f8")),
                             (np.asfortranarray(at), side), (at[::-1].copy()[::-1], side),
                             (at.tolist(), 3 * side), (read_only, side)):
        np.testing.assert_allclose(embedding.irradiance(position, normal), want, rtol=1e-6)


def test_an_embedding_outlives_what_it_was_made_of(room_file, points):
    made = lte.Model.load().encode(lte.load(room_file))
    light = made.irradiance(*points)
    kept = light.copy()
    del made
    np.testing.assert_array_equal(light, kept)


def test_a_dark_scene_is_encoded(model, tmp_path):
    (tmp_path / "dark.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n")
    dark = lte.load(tmp_path / "dark.obj")
    point = [[0.2, 0, 0.2]], UP
    assert np.isfinite(model.encode(dark).irradiance(*point)).all()
    assert not lte.irradiance(dark, *point, integrator="network").total.any()
    assert not lte.render(dark, size=(8, 8), camera="auto", integrator="network").color.any()


def test_files_that_are_no_models_are_named(tmp_path):
    weights = NETWORK.read_bytes()
    (tmp_path / "empty.safetensors").write_bytes(b"")
    (tmp_path / "short.safetensors").write_bytes(weights[:200000])
    (tmp_path / "damaged.safetensors").write_bytes(weights[:-8] + bytes(8))
    (tmp_path / "noise.safetensors").write_bytes(bytes(range(256)) * 99)
    (tmp_path / "folder.safetensors").mkdir()
    (tmp_path / "scene.safetensors").write_bytes(lte.living_room.read_bytes())
    for name in ("missing", "empty", "short", "damaged", "noise", "folder", "scene"):
        with pytest.raises(lte.Error) as caught:
            lte.Model.load(tmp_path / f"{name}.safetensors")
        text = str(caught.value)
        assert f"{name}.safetensors" in text and "\n" not in text


@pytest.mark.parametrize("call, words", [
    (lambda room, made: lte.Model.load(3), "path: expected a name of a file, got int 3"),
    (lambda room, made: lte.Model.load(precision="fp8"), "precision: expected fp32 | bf16"),
    (lambda room, made: lte.Model.load().encode("room.glb"), "scene: expected lte.Scene, got str"),
    (lambda room, made: lte.Model.load().encode(room, scene_points=0), "scene_points: expected 1"),
    (lambda room, made: lte.Model.load().encode(room, seed=-1), "seed: expected 0 to"),
    (lambda room, made: lte.render(room, size=(8, 8), model=lte.Model.load()),
     'model goes with integrator="network"'),
    (lambda room, made: lte.render(room, size=(8, 8), integrator="network", model="lte"),
     "model: expected lte.Model, got str"),
    (lambda room, made: lte.irradiance(room, [], [], integrator="network", error=.1), "error goes"),
    (lambda room, made: made.irradiance(np.zeros((5, 2)), UP), "points: expected [N, 3], got"),
    (lambda room, made: made.irradiance([[0, float("nan"), 0]], UP), "points: row 0 is not finite"),
    (lambda room, made: made.irradiance(np.zeros((1, 3), int), UP), "points: expected float32 or"),
    (lambda room, made: made.irradiance(np.zeros((2, 3)), UP), "normals: expected as many as"),
    (lambda room, made: made.irradiance(UP, 0 * UP), "normals: row 0 has no length"),
    (lambda room, made: made.irradiance(UP, UP, albedo=np.ones((2, 3))),
     "albedo: expected as many"),
    (lambda room, made: made.irradiance(UP, UP, albedo=[[0, -1, 0]]), "albedo: expected 0 to 16"),
    (lambda room, made: made.irradiance(UP, UP, albedo=0.5), "albedo: expected [N, 3], got []")])
def test_wrong_calls_are_named(room, embedding, call, words):
    with pytest.raises((TypeError, ValueError, lte.Error)) as caught:
        call(room, embedding)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_threads_share_an_embedding(room, model, embedding, points):
    at, side = (np.tile(array, (20, 1)) for array in points)
    want = embedding.irradiance(at, side)
    options = {"size": (16, 16), "quality": "draft", "camera": "auto", "denoise": False,
               "integrator": "network"}
    picture = lte.render(room, **options).color
    found = []

    def ask():
        for _ in range(5):
            found.append(np.array_equal(embedding.irradiance(at, side), want))
            found.append(np.array_equal(lte.render(room, **options).color, picture))
        found.append(np.array_equal(model.encode(room).irradiance(at, side), want))

    workers = [threading.Thread(target=ask) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(found) == 44 and all(found)


def test_the_number_of_threads_changes_nothing(room, model, embedding, points):
    want = embedding.irradiance(*points)
    before = lte.threads()
    lte.set_threads(3)
    try:
        np.testing.assert_array_equal(model.encode(room).irradiance(*points), want)
    finally:
        lte.set_threads(before)


def test_a_forked_process_answers():
    """By an embedding of its parent, and by one of its own."""
    code = ("import os, sys, lte; s = lte.load(lte.living_room); p = s.sample(3000)\n"
            "m = lte.Model.load(); e = m.encode(s); want = e.irradiance(*p); pid = os.fork()\n"
            "if pid == 0:\n"
            "    same = (e.irradiance(*p) == want).all()\n"
            "    own = (m.encode(lte.load(lte.living_room)).irradiance(*p) == want).all()\n"
            "    os._exit(7 if same and own else 1)\n"
            "sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))")
    ended = subprocess.run([sys.executable, "-c", code], timeout=120)
    assert ended.returncode == 7


@pytest.mark.parametrize("call", [
    "embedding.irradiance(points, normals)", "model.encode(scene, scene_points=16000)",
    "lte.render(scene, size=(1280, 960), integrator='network', seed=next(seed))"])
def test_ctrl_c_ends_work(interrupted, call):
    interrupted(call, before="model = lte.Model.load(); embedding = model.encode(scene); "
                             "points, normals = scene.sample(200000)",
                after="embedding.irradiance(points[:9], normals[:9])", seconds=10)


def test_encodes_and_calls_leave_no_memory(room, model, resident_mb):
    """LTE_CALLS=100000 takes a minute."""
    calls = int(os.environ.get("LTE_CALLS", 2000))
    point = np.zeros((1, 3), np.float32)

    def ask(count):
        made = model.encode(room)
        for _ in range(count):
            made.irradiance(point, UP)
        for _ in range(count // 100):
            model.encode(room, scene_points=500)

    ask(max(calls // 2, 1000))
    before = resident_mb()
    ask(calls)
    assert resident_mb() - before < 2
