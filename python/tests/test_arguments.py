"""Wrong arguments, files and places: each is one sentence that names what is wrong."""
import os

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra import numpy as arrays

import lte


def sentence(caught) -> str:
    text = str(caught.value)
    assert text and "\n" not in text
    return text


def test_arrays_of_any_layout_give_the_same_answer(room, points):
    at, side = points
    want = lte.trace.irradiance(room, at, side, rays=16).total
    both = np.hstack(points)
    reversed_rows = np.ascontiguousarray(at[::-1]), np.ascontiguousarray(side[::-1])
    read_only = at.copy()
    read_only.flags.writeable = False
    for position, normal in ((both[:, :3], both[:, 3:]),
                             (at.astype(np.float64), side.astype(np.float64)),
                             (np.asfortranarray(at), np.asfortranarray(side)),
                             (reversed_rows[0][::-1], reversed_rows[1][::-1]),
                             (at.astype(">f4"), side.astype(">f8")),
                             (at.tolist(), 3 * side), (read_only, side)):
        found = lte.trace.irradiance(room, position, normal, rays=16).total
        np.testing.assert_array_equal(found, want)


def packed(at):
    """Rows that no multiple of four bytes lies between."""
    rows = np.zeros(len(at), np.dtype([("at", "<f4", 3), ("tag", "u1")]))
    rows["at"] = at
    return rows["at"]


@pytest.mark.parametrize("rows, in_place", [
    (lambda at: at, True), (lambda at: np.hstack([at, at])[:, 3:], True),
    (lambda at: at[::-1], True),
    (lambda at: np.repeat(at, 2, 0)[::2], True), (lambda at: at[:1], True), (packed, False),
    (lambda at: np.asfortranarray(at), False), (lambda at: at[:, ::-1][:, ::-1], True),
    (lambda at: np.flip(np.flip(at, 1).copy(), 1), False)])
def test_float32_rows_are_read_in_place(room, points, rows, in_place):
    from lte._arrays import surface
    at, side = points[0].copy(), points[1]
    given = rows(at)
    assert np.shares_memory(surface(given, side[:len(given)])[0], given) == in_place
    for ask in (lte.trace.irradiance, lte.irradiance):
        found = ask(room, given, side[:len(given)]).total
        np.testing.assert_array_equal(found, ask(room, given.copy(), side[:len(given)]).total)


class OfDlpack:
    """What another library's array on the CPU looks like: no NumPy, but DLPack."""
    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


class OnGpu(OfDlpack):
    def __dlpack__(self, **options):
        raise BufferError("cannot export from\na device")


def test_dlpack_is_read(room, points):
    from lte._arrays import surface
    want = lte.trace.irradiance(room, *points, rays=16).total
    foreign = [OfDlpack(array) for array in points]
    np.testing.assert_array_equal(lte.trace.irradiance(room, *foreign, rays=16).total, want)
    assert np.shares_memory(surface(*foreign)[0], points[0])
    with pytest.raises(TypeError) as caught:
        lte.trace.irradiance(room, OnGpu(points[0]), points[1])
    assert "points: expected an array on the CPU" in sentence(caught)


def test_tensors_of_pytorch_are_read_in_place(room, points):
    torch = pytest.importorskip("torch")
    from lte._arrays import surface
    rows = torch.cat([torch.from_numpy(array) for array in points], 1)
    at, side = rows[:, :3], rows[:, 3:]
    assert all(np.shares_memory(array, rows.numpy()) for array in surface(at, side))
    np.testing.assert_array_equal(lte.trace.irradiance(room, at, side).total,
                                  lte.trace.irradiance(room, *points).total)
    with pytest.raises(TypeError, match="points: .*gradient"):
        lte.trace.irradiance(room, at.clone().requires_grad_(), side)


def test_no_points_have_no_light(room):
    none = np.zeros((0, 3), np.float32)
    assert lte.irradiance(room, none, none).total.shape == (0, 3)
    assert lte.irradiance(room, none, none, integrator="path").expected_error.shape == (0,)
    assert lte.trace.irradiance(room, [], [], by_light=True).total.shape == (1, 0, 3)


def test_a_dark_scene_is_black(tmp_path):
    (tmp_path / "dark.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n")
    dark = lte.load(tmp_path / "dark.obj")
    point = [[0.2, 0, 0.2]], [[0, 1, 0]]
    assert not lte.irradiance(dark, *point).total.any() and not dark.lights
    assert lte.irradiance(dark, *point).expected_error.shape == (1,)
    assert lte.trace.irradiance(dark, *point, by_light=True).total.shape == (0, 1, 3)
    assert not lte.render(dark, size=(8, 8), camera="auto").color.any()


@pytest.mark.parametrize("values, error, words", [
    (np.zeros((5, 2), np.float32), ValueError, "points: expected [N, 3], got [5, 2]"),
    (np.zeros(3), ValueError, "points: expected [N, 3], got [3]"),
    (np.float32(1), ValueError, "points: expected [N, 3], got []"),
    (np.zeros((2, 3), np.int64), TypeError, "points: expected float32 or float64, got int64"),
    (np.zeros((2, 3), np.float16), TypeError, "points: expected float32 or float64, got float16"),
    (np.zeros((2, 3), complex), TypeError, "points: expected float32 or float64, got complex128"),
    (np.full((2, 3), np.nan), ValueError, "points: row 0 is not finite"),
    (np.array([[0, 0, 0], [0, 1e60, 0]]), ValueError, "points: row 1 is not finite"),
    (np.array([[0, 0, 0], [0, 1e20, 0]]), ValueError, "points: row 1 is too far from the origin"),
    (np.array([["a", "b", "c"]]), TypeError, "points: expected float32 or float64, got <U1"),
    ([["a", "b", "c"]], TypeError, "points: expected [N, 3] numbers, got <U1"),
    ([[True, False, True]], TypeError, "points: expected [N, 3] numbers, got bool"),
    ([[0, 1, 2], [0, 1]], ValueError, "points: expected [N, 3] numbers, got rows of different"),
    ("points", TypeError, "points: expected float32 or float64, got <U6"),
    (None, TypeError, "points: expected float32 or float64, got object"),
])
def test_wrong_points_are_named(room, values, error, words):
    for ask in (lte.trace.irradiance, lte.irradiance):
        with pytest.raises(error) as caught:
            ask(room, values, np.ones((2, 3)))
        assert words in sentence(caught)


def test_normals_are_held_against_points(room):
    with pytest.raises(ValueError, match="as many as points, 2, got 1"):
        lte.trace.irradiance(room, np.zeros((2, 3)), np.ones((1, 3)))
    with pytest.raises(ValueError, match="normals: row 1 has no length"):
        lte.trace.irradiance(room, np.zeros((2, 3)), np.array([[0.0, 1, 0], [0, 0, 0]]))


ANY_ARRAY = arrays.arrays(
    dtype=st.one_of(arrays.floating_dtypes(), arrays.integer_dtypes(),
                    arrays.complex_number_dtypes(), arrays.boolean_dtypes(),
                    arrays.datetime64_dtypes(), arrays.unicode_string_dtypes(max_len=3)),
    shape=st.one_of(arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
                    st.tuples(st.integers(0, 4), st.just(3))))


@pytest.fixture(scope="module")
def embedding(room):
    return lte.Model.load().encode(room)


@settings(max_examples=int(os.environ.get("LTE_EXAMPLES", 200)), deadline=None)
@given(ANY_ARRAY, ANY_ARRAY)
def test_any_array_is_an_answer_or_one_sentence(room, embedding, points, normals):
    up = np.ones((len(np.atleast_1d(points)), 3))
    for at, side, color in ((points, normals, None), (points, up, None), (up, up, normals)):
        for ask in (lambda: lte.trace.irradiance(room, at, side, rays=2, depth=2).total,
                    lambda: embedding.irradiance(at, side, albedo=color),
                    lambda: embedding.irradiance(at, side, albedo=color, direct=True)):
            try:
                light = ask()
            except (TypeError, ValueError, lte.Error) as error:
                assert str(error) and "\n" not in str(error)
            else:
                assert light.shape == at.shape and np.isfinite(light).all()


@settings(max_examples=int(os.environ.get("LTE_EXAMPLES", 200)), deadline=None)
@given(st.dictionaries(
    st.sampled_from(["rays", "depth", "seed", "by_light"]),
    st.one_of(st.integers(-5, 9), st.floats(), st.none(), st.text(max_size=3), st.booleans(),
              st.integers(), st.lists(st.integers(), max_size=2))))
def test_any_option_is_an_answer_or_one_sentence(room, options):
    options = {"rays": 2, "depth": 1, **options}
    if all(isinstance(options[name], int) and options[name] > 9 for name in ("rays", "depth")):
        return  # long, and right
    try:
        lte.trace.irradiance(room, [[0, 0, 0]], [[0, 1, 0]], **options)
    except (TypeError, ValueError, lte.Error) as error:
        assert str(error) and "\n" not in str(error)


# A name of a file stands in the sentence as it is, so none here has lines.
NAMES = st.text(st.characters(exclude_categories=("Cc", "Cs")), max_size=9)
ANYTHING = st.one_of(st.integers(-5, 9), st.floats(), st.none(), NAMES, NAMES.map(os.fsencode),
                     st.booleans(), st.integers(), st.lists(st.integers(), max_size=2),
                     st.sampled_from(["auto", "lamp", "lte-radiance", "homes", b"", object()]))


@settings(max_examples=int(os.environ.get("LTE_EXAMPLES", 200)), deadline=None)
@given(ANYTHING, ANYTHING)
def test_any_value_is_an_answer_or_one_sentence(room_file, one, other):
    scene = lte.load(room_file)
    for call in (lambda: scene.lights[one], lambda: setattr(scene.lights[0], "gain", one),
                 lambda: one in scene.lights, lambda: scene.lights.add_panel(auto=one),
                 lambda: lte.homes(seed=one, count=other), lambda: lte.Model.load(one),
                 lambda: lte.info(one if one is not None else other),
                 lambda: lte.trace.irradiance(one, [], []),
                 lambda: lte.bake(scene, size=other, quality=one),
                 lambda: next(lte.homes(config=one))):
        try:
            call()
        except (TypeError, ValueError, LookupError, lte.Error) as error:
            assert str(error) and "\n" not in str(error)
    assert 0 <= scene.lights[0].gain <= 1e6


@pytest.mark.parametrize("options, words", [
    ({"size": (0, 8)}, "size: width: expected 1 to 65536, got 0"), ({"size": 8}, "size: expected"),
    ({"size": (8.5, 8)}, "size: width: expected a whole number, got float 8.5"),
    ({"size": (65536, 65536)}, "a picture of 65536x65536 needs"),
    ({"spp": 4}, "spp goes with"), ({"integrator": "path", "spp": 0}, "spp: expected 1 to"),
    ({"time": 0}, "time: expected"), ({"time": float("nan")}, "time: expected"),
    ({"depth": 0}, "depth: expected 1 to 1000, got 0"), ({"seed": -1}, "seed: expected 0 to"),
    ({"quality": "finl"}, 'quality: expected draft | preview | final, got "finl"; did you mean'),
    ({"output": 3}, "output: expected full | gi"),
    ({"integrator": "magic"}, "integrator: expected gather | network | path, got 'magic'"),
    ({"camera": "nobody"}, 'camera "nobody"'), ({"camera": 7}, 'camera "7"'),
    ({"camera": lte.Camera((0, 1, 0), (0, 1, 0))}, 'camera: "target" must differ'),
    ({"camera": lte.Camera((0, 1, 0), (0, 1, float("nan")))}, 'camera: "target" must'),
    ({"camera": lte.Camera((0, 1, 0), (0, 0, 0), (0, 1, 0))}, 'camera: "up" must not be'),
    ({"camera": lte.Camera((0, 1, 0), (0, 0, 0), vfov=180)}, 'camera: "vfov" must be'),
    ({"camera": lte.Camera((0, 1), (0, 0, 0))}, "camera: origin: expected three numbers"),
    ({"camera": lte.Camera((0, 99, 0), (0, 100, 0))}, "camera")])
def test_wrong_options_are_named(room, options, words):
    with pytest.raises((TypeError, ValueError, lte.Error)) as caught:
        lte.render(room, **{"size": (8, 8), **options})
    assert words in sentence(caught)


@pytest.mark.parametrize("call, words", [
    (lambda room: lte.render("room.glb"), "scene: expected lte.Scene, got str"),
    (lambda room: lte.load(None), "path: expected a name of a file, got None"),
    (lambda room: lte.load("a\0.glb"), "path: has a null character"),
    (lambda room: lte.load("a\udcff.glb"), "path: expected UTF-8"),
    (lambda room: lte.load(lte.living_room, up="x"), "up: expected y | z, got 'x'"),
    (lambda room: lte.load(lte.living_room, environment="no.exr"), "no.exr"),
    (lambda room: lte.load(lte.living_room, add_light="much"), "much"),
    (lambda room: room.sample(0), "count: expected 1 to"),
    (lambda room: room.sample(2.0), "count: expected a whole number, got float 2.0"),
    (lambda room: lte.set_threads(1 << 20), "number of threads"),
    (lambda room: lte.irradiance(room, [], [], error=0.1), "error goes with"),
    (lambda room: lte.generate_scene("castles"), "generator: expected boxes | homes | wild"),
    (lambda room: lte.generate_dataset("no.yaml", "out"), "no.yaml")])
def test_wrong_calls_are_named(room, call, words):
    with pytest.raises((TypeError, ValueError, lte.Error)) as caught:
        call(room)
    assert words in sentence(caught)


def test_files_that_are_no_scenes_are_named(tmp_path):
    (tmp_path / "empty.glb").write_bytes(b"")
    (tmp_path / "damaged.glb").write_bytes(lte.living_room.read_bytes()[:5000])
    (tmp_path / "folder.glb").mkdir()
    for name in ("missing.glb", "empty.glb", "damaged.glb", "folder.glb", "scene.xyz"):
        with pytest.raises(lte.Error) as caught:
            lte.load(tmp_path / name)
        assert name in sentence(caught)


def test_places_that_cannot_be_written_are_named(room, tmp_path):
    picture = lte.render(room, size=(8, 8), quality="draft", camera="auto")
    for path, save in ((tmp_path / "no" / "a.png", picture.save),
                       (tmp_path / "a.bmp", picture.save), (tmp_path / "no" / "a.glb", room.save)):
        with pytest.raises(lte.Error) as caught:
            save(path)
        assert path.name in sentence(caught)
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match="tone: expected linear"):
        picture.save(tmp_path / "a.png", tone="loud")


def test_a_full_disk_is_named(room, tmp_path):
    import resource
    import signal
    picture = lte.render(room, size=(256, 256), quality="draft", camera="auto")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limit[1]))
    try:
        with pytest.raises(lte.Error) as caught:
            picture.save(tmp_path / "a.exr")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert "a.exr" in sentence(caught) and not list(tmp_path.iterdir())
