"""Scenes and pictures."""
import numpy as np
import pytest

import lte


def test_a_scene_says_what_it_is(room):
    assert room.name == "room"
    assert room.triangles == 6
    assert len(room.lights) == 1
    np.testing.assert_array_equal(room.bounds[0], [-2, 0, -2])
    np.testing.assert_array_equal(room.bounds[1], [2, 3, 2])
    assert "6 triangles" in repr(room)


def test_the_package_has_a_scene():
    scene = lte.load(lte.living_room)
    assert scene.name == "living_room" and scene.lights and not scene.ignored


def test_samples_lie_on_surfaces(room):
    points, normals = room.sample(1000, seed=1)
    floor, wall = abs(points[:, 1]) < 1e-5, abs(points[:, 0] + 2) < 1e-5
    lamp = (abs(points[:, 1] - 2) < 1e-5) & (abs(points[:, [0, 2]]) <= 0.5).all(axis=1)
    assert (floor | wall | lamp).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-5)
    assert abs(floor.sum() - 1000 * 16 / 29) < 5 and abs(lamp.sum() - 1000 / 29) < 5
    assert not np.array_equal(points, room.sample(1000, seed=2)[0])


def test_a_picture_has_owned_linear_layers(room):
    picture = lte.render(room, size=(32, 24), quality="draft", camera="auto")
    assert picture.color.shape == (24, 32, 3) and picture.color.dtype == np.float32
    assert picture.layers["depth"].shape == (24, 32)
    assert np.asarray(picture).sum() > 0
    layers, kept = picture.layers, picture.color.copy()
    full = layers["emission"] + layers["albedo"] / np.pi * (layers["direct"] + layers["indirect"])
    np.testing.assert_allclose(picture.color, full, rtol=1e-4, atol=1e-5)
    picture.color[:] = 0
    assert picture._made.color().sum() == pytest.approx(kept.sum())


def test_a_picture_outlives_its_scene(room_file):
    picture = lte.render(lte.load(room_file), size=(8, 8), quality="draft", camera="auto")
    layers = picture.layers
    kept = layers["albedo"].copy()
    del picture
    np.testing.assert_array_equal(layers["albedo"], kept)


def test_a_camera_may_be_given(room):
    down = lte.Camera((0, 1.5, 0), (0, 0, 0), vfov=60)
    picture = lte.render(room, size=(8, 8), quality="draft", camera=down)
    assert picture.camera["vfov"] == 60 and picture.camera["up"] == [0, 0, -1]
    np.testing.assert_allclose(picture.layers["depth"], 1.5, rtol=1e-5)


def test_passes_go_on_for_a_time(room):
    picture = lte.render(room, size=(16, 16), camera="auto", time=0.3)
    assert picture.passes > 1


@pytest.mark.parametrize("output", ["depth", "normal", "direct", "irradiance"])
def test_outputs_are_those_of_lte_render(room, output):
    picture = lte.render(room, size=(8, 6), quality="draft", camera="auto", output=output)
    assert picture.color.shape == ((6, 8) if output == "depth" else (6, 8, 3))


@pytest.mark.parametrize("integrator, quality, spp", [("gather", "preview", None),
                                                      ("gather", "final", None),
                                                      ("path", "draft", 4)])
def test_a_picture_is_the_file_of_lte_render(room, room_file, tmp_path, tool, integrator, quality,
                                             spp):
    words = ["--spp", spp] if spp else ["--quality", quality]
    for ending in ("exr", "png"):
        tool("lte_render", room_file, "--size", "40x24", "--camera", "auto", "--integrator",
             integrator, *words, "--set", "denoise=off", "--out", tmp_path / f"tool.{ending}")
    picture = lte.render(room, size=(40, 24), camera="auto", integrator=integrator,
                         quality=quality, spp=spp, denoise=False)
    for ending in ("exr", "png"):
        picture.save(tmp_path / f"python.{ending}")
        assert (tmp_path / f"python.{ending}").read_bytes() == (
            tmp_path / f"tool.{ending}").read_bytes()


def test_the_exposure_is_a_factor_of_the_png(room, tmp_path):
    picture = lte.render(room, size=(16, 16), quality="draft", camera="auto")
    assert picture.exposure(ev=1) == pytest.approx(2 * picture.exposure())
    picture.save(tmp_path / "a.png", ev=1)
    picture.save(tmp_path / "b.png", exposure=2 * picture.exposure())
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
