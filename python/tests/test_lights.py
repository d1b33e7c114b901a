"""Lamps by name, dimmed and added: light is linear, which is the witness."""
import threading

import numpy as np
import pytest

import lte

TWO_LAMPS = """
mtllib room.mtl
v -2 0 -2
v 2 0 -2
v 2 0 2
v -2 0 2
v -2 3 -2
v -2 3 2
usemtl grey
o floor
f 4 3 2 1
f 1 5 6 4
v -1.5 2 -0.5
v -0.5 2 -0.5
v -0.5 2 0.5
v -1.5 2 0.5
v 0.5 2 -0.5
v 1.5 2 -0.5
v 1.5 2 0.5
v 0.5 2 0.5
usemtl lamp
o left
f 7 8 9 10
o right
f 11 12 13 14
"""


@pytest.fixture(scope="module")
def lamps_file(room_file):
    """A floor and a wall under two lamps that share a material."""
    (room_file.parent / "lamps.obj").write_text(TWO_LAMPS)
    return room_file.parent / "lamps.obj"


@pytest.fixture
def scene(lamps_file):
    return lte.load(lamps_file)


@pytest.fixture(scope="module")
def places(lamps_file):
    return lte.load(lamps_file).sample(30, seed=2)


def dimmed(file, *gains):
    scene = lte.load(file)
    for lamp, gain in zip(scene.lights, gains, strict=True):
        lamp.gain = gain
    return scene


def test_lamps_have_names_numbers_and_gains(scene):
    first, second = scene.lights
    assert [first.gain, second.gain] == [1, 1] and len(scene.lights) == 2
    assert scene.lights[first.name].name == first.name and first.name in scene.lights
    assert scene.lights[-1].name == second.name and len(scene.lights[:1]) == 1
    scene.lights[second.name].gain = 0.5
    assert second.gain == 0.5 and first.gain == 1 and "gain 0.5" in repr(scene.lights)


@pytest.mark.parametrize("ask", [
    lambda scene, places: lte.trace.irradiance(scene, *places, rays=64).total,
    lambda scene, places: lte.irradiance(scene, *places, spp=64).total,
    lambda scene, places: lte.Model.load().encode(scene, scene_points=1024).irradiance(
        *places, direct=True),
    lambda scene, places: lte.render(scene, size=(24, 16), quality="draft", camera="auto",
                                     denoise=False).color,
    lambda scene, places: lte.bake(scene, texels_per_metre=3, quality="draft").irradiance])
def test_half_the_light_is_half_of_all_answers(lamps_file, places, ask):
    """Halves are exact in floating point; of the network's curves, nearly."""
    whole, half = (ask(dimmed(lamps_file, gain, gain), places) for gain in (1, 0.5))
    assert whole.max() > 0
    np.testing.assert_allclose(half, whole / 2, rtol=1e-4, atol=1e-4 * whole.max())


def test_pictures_of_lamps_add_up(lamps_file):
    """One lamp at half its light, and the other: the sum of pictures of each alone."""
    def picture(*gains):
        return lte.render(dimmed(lamps_file, *gains), size=(24, 16), integrator="path", spp=512,
                          camera="auto").color.astype(np.float64)

    both, left, right = picture(0.5, 1), picture(0.5, 0), picture(0, 1)
    assert min(left.mean(), right.mean()) > 0.1 * both.mean()
    assert both.mean() == pytest.approx((left + right).mean(), rel=0.01)
    assert abs(both - left - right).mean() < 0.05 * both.mean()


def test_gains_are_the_weights_of_light_by_lamp(lamps_file, places):
    gains = np.array([0.25, 3])
    alone = lte.trace.irradiance(lte.load(lamps_file), *places, rays=4096, by_light=True).total
    found = lte.trace.irradiance(dimmed(lamps_file, *gains), *places, rays=4096, seed=1)
    error = abs(np.tensordot(gains, alone, 1) - found.total)
    assert (error < 6 * found.stderr + 0.02 * found.total.mean()).all()
    one = lte.trace.irradiance(dimmed(lamps_file, 0, 2), *places, rays=64, by_light=True)
    assert not one.total[0].any() and one.total[1].any()


def test_what_is_dimmed_is_what_a_darker_file_has(lamps_file, places, tmp_path):
    """Of a lamp that shares its mesh, too; and the saved scene has its light."""
    dimmed(lamps_file, 0.5, 0.5).save(tmp_path / "half.glb")
    want = lte.trace.irradiance(dimmed(lamps_file, 0.5, 0.5), *places, rays=64).total
    found = lte.trace.irradiance(lte.load(tmp_path / "half.glb"), *places, rays=4096)
    assert found.total.mean() == pytest.approx(want.mean(), rel=0.03)
    dimmed(lamps_file, 0, 1).save(tmp_path / "one.glb")
    assert len(lte.load(tmp_path / "one.glb").lights) == 1


def test_all_kinds_of_lamps_are_dimmed(room_file):
    scene = lte.load(room_file, environment="1,1,1", add_light="0,1,0,10")
    above = [[0, 5, 0]], [[0, 1, 0]]  # sees the sky alone
    assert len(scene.lights) == 3
    scene.lights["environment"].gain = 0.25
    sky = lte.trace.irradiance(scene, *above, rays=256, by_light=True).total
    assert sky.max() == pytest.approx(np.pi / 4, rel=1e-3)
    scene.lights[0].gain = scene.lights["environment"].gain = 0
    point = [[0, 0, 0]], [[0, 1, 0]]
    (name,) = (lamp.name for lamp in scene.lights[1:] if lamp.name != "environment")
    bulb = lte.trace.irradiance(scene, *point, rays=64, depth=1).total
    np.testing.assert_allclose(bulb, 10 / (4 * np.pi), rtol=1e-4)
    scene.lights[name].gain = 3
    np.testing.assert_allclose(lte.trace.irradiance(scene, *point, rays=64, depth=1).total,
                               30 / (4 * np.pi), rtol=1e-4)


def test_an_embedding_keeps_the_light_of_its_time(scene, places):
    model = lte.Model.load()
    before = model.encode(scene, scene_points=1024)
    want = before.irradiance(*places, direct=True)
    for lamp in scene.lights:
        lamp.gain = 0.5
    np.testing.assert_array_equal(before.irradiance(*places, direct=True), want)
    after = model.encode(scene, scene_points=1024).irradiance(*places, direct=True)
    np.testing.assert_allclose(after, want / 2, rtol=1e-4, atol=1e-4 * want.max())


def test_panels_are_those_of_add_light(room_file, places):
    scene = lte.load(room_file)
    scene.lights[0].gain = 2
    added = scene.lights.add_panel(auto=True)
    tools = lte.load(room_file, add_light="auto")
    assert [lamp.name for lamp in scene.lights] == [lamp.name for lamp in tools.lights]
    assert len(added) == len(scene.lights) - 1 >= 1 and scene.lights[0].gain == 2
    assert added[0].gain == 1 and added[0] in scene.lights
    scene.lights[0].gain = 1
    np.testing.assert_array_equal(lte.trace.irradiance(scene, *places, rays=64).total,
                                  lte.trace.irradiance(tools, *places, rays=64).total)


@pytest.mark.parametrize("call, error, words", [
    (lambda lights: setattr(lights[0], "gain", -1), ValueError, "gain: expected 0 to"),
    (lambda lights: setattr(lights[0], "gain", float("nan")), ValueError, "gain: expected 0 to"),
    (lambda lights: setattr(lights[0], "gain", "half"), TypeError, "gain: expected a number"),
    (lambda lights: lights["nobody"], KeyError, "there is no light 'nobody', but"),
    (lambda lights: lights[9], IndexError, "range"), (lambda lights: lights[1.5], TypeError, ""),
    (lambda lights: lights.add_panel(auto=False), ValueError, "auto: expected True")])
def test_wrong_lamps_are_named(scene, call, error, words):
    with pytest.raises(error) as caught:
        call(scene.lights)
    assert words in str(caught.value) and "\n" not in str(caught.value)
    assert [lamp.gain for lamp in scene.lights] == [1, 1]


def test_lamps_of_one_name_are_taken_by_number(tmp_path):
    scene = lte.generate_scene("boxes", seed=4)
    scene._names[:] = ["lamp"] * len(scene._names)
    with pytest.raises(KeyError, match="lights are named 'lamp': take one by its number"):
        scene.lights["lamp"]


def test_threads_that_dim_and_ask_see_whole_states(scene, places):
    """Each answer is that of some pair of gains, whoever changes them meanwhile."""
    gains, found = (1, 0.5, 2), []
    lights = list(scene.lights)
    known = lte.trace.irradiance(scene, *places, rays=16, by_light=True).total.sum((1, 2))

    def dim():
        for _ in range(20):
            for gain in gains:
                lights[0].gain = gain

    def ask():
        for _ in range(20):
            light = lte.trace.irradiance(scene, *places, rays=16, by_light=True).total.sum((1, 2))
            found.append(light / known)

    workers = [threading.Thread(target=work) for work in (dim, ask, ask, ask)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(found) == 60
    for first, second in found:  # sampling follows the lamps' power
        assert min(abs(first / gain - 1) for gain in gains) < 0.1 and abs(second - 1) < 0.1


def test_gains_leave_no_memory(scene, places, resident_mb):
    def turn(times):
        for i in range(times):
            scene.lights[0].gain = 0.5 + i % 7
            lte.trace.irradiance(scene, *places, rays=2, depth=1)

    turn(300)
    before = resident_mb()
    turn(600)
    assert resident_mb() - before < 2
