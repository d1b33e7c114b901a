"""Light at points, against lte_probe and against what is known of it."""
import csv

import numpy as np
import pytest

import lte


@pytest.mark.parametrize("integrator", ["gather", "path"])
def test_light_at_points_is_that_of_lte_probe(room, room_file, points, tmp_path, tool, integrator):
    with open(tmp_path / "points.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow("px py pz nx ny nz".split())
        rows.writerows([f"{v:.9g}" for v in row] for row in np.hstack(points))
    tool("lte_probe", room_file, "--points", tmp_path / "points.csv", "--out", tmp_path / "out.csv",
         "--integrator", integrator, "--spp", 64)
    with open(tmp_path / "out.csv", newline="") as file:
        table = list(csv.DictReader(file))
    light = lte.irradiance(room, *points, integrator=integrator, spp=64)
    for name, found in (("total", light.total), ("direct", light.direct),
                        ("stderr", light.stderr)):
        of_tool = np.array([[row[f"{name}_{c}"] for c in "rgb"] for row in table], np.float32)
        np.testing.assert_array_equal(found, of_tool)
    of_tool = np.array([row["expected_error"] for row in table], np.float32)
    np.testing.assert_allclose(light.expected_error, of_tool, rtol=1e-6)


def test_a_lamp_above_a_point_is_its_form_factor(room):
    light = lte.trace.irradiance(room, [[0, 0, 0]], [[0, 1, 0]], rays=4096, depth=1)
    # A unit square of radiance 5, 4, 3 that faces the point from 2 m: four corners of form factors.
    corner = 0.5 / np.hypot(0.5, 2)
    factor = 4 / (2 * np.pi) * 2 * corner * np.arctan(corner)
    np.testing.assert_allclose(light.total[0], np.pi * factor * np.array([5, 4, 3]), rtol=0.005)
    assert (light.indirect == 0).all()


@pytest.mark.parametrize("albedo", [0.2, 0.8])
def test_a_white_furnace_is_a_geometric_series(tmp_path, albedo):
    (tmp_path / "box.mtl").write_text(f"newmtl m\nKd {albedo} {albedo} {albedo}\nKe 1 1 1\n")
    corners = [f"v {x} {y} {z}" for x in (0, 3) for y in (0, 2) for z in (0, 4)]
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    (tmp_path / "box.obj").write_text("\n".join(
        ["mtllib box.mtl", *corners, "usemtl m", *(f"f {face}" for face in faces)]))
    box = lte.load(tmp_path / "box.obj")
    inside = [[1.5, 1, 2], [0.3, 0.4, 3.7]]
    for depth in (1, 2, 5):
        known = np.pi * sum(albedo**k for k in range(depth))
        traced = lte.trace.irradiance(box, inside, [[0, 1, 0], [0, 0, -1]], rays=4096, depth=depth)
        np.testing.assert_allclose(traced.total, known, rtol=0.01)
        gathered = lte.irradiance(box, inside, [[0, 1, 0], [0, 0, -1]], spp=1024, depth=depth)
        np.testing.assert_allclose(gathered.total, known, rtol=0.02)


def test_gathered_light_agrees_with_paths(room):
    points = room.sample(60, seed=3)
    gathered = lte.irradiance(room, *points)
    traced = lte.trace.irradiance(room, *points, rays=4096)
    assert np.median(abs(gathered.total - traced.total) / (traced.total + 1e-3)) < 0.03
    assert (gathered.expected_error >= 0).all() and traced.expected_error is None
    np.testing.assert_array_equal(gathered.total, gathered.direct + gathered.indirect)


def test_light_by_lamp_adds_up():
    home = lte.generate_scene("boxes", seed=4)
    points = home.sample(20)
    whole = lte.trace.irradiance(home, *points, rays=64)
    lamps = lte.trace.irradiance(home, *points, rays=64, by_light=True)
    assert lamps.total.shape == (len(home.lights), 20, 3) and len(home.lights) > 1
    np.testing.assert_allclose(lamps.total.sum(0), whole.total, rtol=1e-5)
    np.testing.assert_array_equal(lamps.stderr, whole.stderr)


def test_lamps_of_a_sky_are_named(room_file):
    scene = lte.load(room_file, environment="1,1,1", add_light="0,1,0,10")
    assert len(scene.lights) == 3
    up = lte.trace.irradiance(scene, [[0, 5, 0]], [[0, 1, 0]], rays=256, by_light=True).total
    assert sorted(up.sum(axis=(1, 2)) > 0) == [False, False, True]
    assert up.max() == pytest.approx(np.pi, rel=1e-3)


def test_the_seed_alone_changes_the_answer(room, points):
    first = lte.trace.irradiance(room, *points, rays=64, seed=1).total
    before = lte.threads()
    lte.set_threads(3)
    try:
        again = lte.trace.irradiance(room, *points, rays=64, seed=1).total
        np.testing.assert_array_equal(again, first)
    finally:
        lte.set_threads(before)
    assert not np.array_equal(lte.trace.irradiance(room, *points, rays=64, seed=2).total, first)


def mitsubas_room(mi):
    """The room of conftest.py, of rectangles. The upper side of the lamp is one of its own."""
    at = mi.ScalarTransform4f

    def rectangle(place, **what):
        return {"type": "rectangle", "to_world": place, **what}

    grey, black = ({"bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {
        "type": "rgb", "value": value}}}} for value in (0.5, 0.0))
    lamp = {**black, "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [5, 4, 3]}}}
    up, down, half = (at().rotate([1, 0, 0], -90), at().rotate([1, 0, 0], 90),
                      at().scale([0.5, 0.5, 1]))
    return mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 5, "rr_depth": 100},
        "floor": rectangle(up @ at().scale([2, 2, 1]), **grey),
        "wall": rectangle(at().translate([-2, 1.5, 0]) @ at().rotate([0, 1, 0], 90)
                          @ at().scale([2, 1.5, 1]), **grey),
        "below": rectangle(at().translate([0, 2, 0]) @ down @ half, **lamp),
        "above": rectangle(at().translate([0, 2.0001, 0]) @ up @ half, **lamp)})


def test_mitsuba_sees_the_same_light(room, points):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    scene = mitsubas_room(mi)
    integrator, rays = scene.integrator(), 1 << 13
    at, side = (array[points[0][:, 1] < 1.9][:6] for array in points)
    found = lte.trace.irradiance(room, at, side, rays=1 << 14)
    for i in range(len(at)):
        sampler = mi.load_dict({"type": "independent", "sample_count": rays})
        sampler.seed(i)
        frame = mi.Frame3f(mi.Vector3f(*map(float, side[i])))
        origin = mi.Point3f(*map(float, at[i] + 1e-4 * side[i]))
        light = []
        for _ in range(rays):
            way = frame.to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d()))
            seen = integrator.sample(scene, sampler, mi.RayDifferential3f(mi.Ray3f(origin, way)))[0]
            light.append([np.pi * seen[0], np.pi * seen[1], np.pi * seen[2]])
        error = np.hypot(np.std(light, axis=0) / np.sqrt(rays), found.stderr[i])
        assert (abs(np.mean(light, axis=0) - found.total[i]) < 4 * error + 1e-4).all()
