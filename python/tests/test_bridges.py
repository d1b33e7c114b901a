"""Scenes of other programs, held against what those compute or against the same scene as a file."""
import pathlib
import sys

import numpy as np
import pytest

import lte

VALIDATION = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "validation"


def white(value):
    return {"type": "rgb", "value": value}


def box(mi, **parts):
    """A room of 4 x 3 x 4 m, open at the front, and what stands in it."""
    turn, move = mi.ScalarTransform4f.rotate, mi.ScalarTransform4f.translate

    def wall(place, *color):
        return {"type": "rectangle", "to_world": place,
                "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse",
                                                      "reflectance": white(color)}}}

    large = mi.ScalarTransform4f.scale(2)
    return {"type": "scene",
            "floor": wall(turn([1, 0, 0], -90) @ large, 0.6, 0.6, 0.5),
            "ceiling": wall(move([0, 3, 0]) @ turn([1, 0, 0], 90) @ large, 0.7, 0.7, 0.7),
            "back": wall(move([0, 1.5, -2]) @ large, 0.6, 0.6, 0.6),
            "left": wall(move([-2, 1.5, 0]) @ turn([0, 1, 0], 90) @ large, 0.6, 0.2, 0.1),
            "right": wall(move([2, 1.5, 0]) @ turn([0, 1, 0], -90) @ large, 0.1, 0.5, 0.2),
            **parts}


def lamps(mi, kind):
    look, move = mi.ScalarTransform4f.look_at, mi.ScalarTransform4f.translate
    small = mi.ScalarTransform4f.scale(0.4)
    down = move([0, 2.9, 0]) @ mi.ScalarTransform4f.rotate([1, 0, 0], 90) @ small
    area = {"type": "area", "radiance": white([8, 7, 5])}
    sky = np.random.default_rng(1).random((8, 16, 3)).astype(np.float32) ** 4
    return {
        "area": {"lamp": {"type": "rectangle", "to_world": down, "emitter": area},
                 "disk": {"type": "disk", "to_world": move([1, 1, 0]) @ down, "emitter": area}},
        "sphere": {"lamp": {"type": "sphere", "center": [0.5, 2, 0], "radius": 0.3,
                            "emitter": area}},
        "point": {"lamp": {"type": "point", "position": [0.5, 2, 0.3],
                           "intensity": white([3, 2, 1])}},
        # A cone without a soft edge, which is the same in both.
        "spot": {"lamp": {"type": "spot", "to_world": look([0.3, 2.8, 0.2], [-0.4, 0, -0.3],
                                                           [1, 0, 0]),
                          "cutoff_angle": 35, "beam_width": 34.95, "intensity": white([9, 8, 7])}},
        "directional": {"lamp": {"type": "directional", "direction": [0.2, -0.5, -1],
                                 "irradiance": white([2, 3, 4])}},
        "constant": {"sky": {"type": "constant", "radiance": white([1, 2, 3])}},
        "envmap": {"sky": {"type": "envmap", "bitmap": mi.Bitmap(sky), "scale": 2.0,
                           "to_world": mi.ScalarTransform4f.rotate([1 / 3, 2 / 3, 2 / 3], 50)}},
    }[kind]


def things(mi):
    move, large = mi.ScalarTransform4f.translate, mi.ScalarTransform4f.scale
    texels = np.random.default_rng(2).random((4, 4, 3)).astype(np.float32)
    picture = {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": True,
               "filter_type": "nearest", "to_uv": large([2, 2, 1])}
    return {"cube": {"type": "cube", "to_world": move([-1, 0.5, -0.5]) @ large(0.5),
                     "bsdf": {"type": "diffuse", "reflectance": picture}},
            "ball": {"type": "sphere", "center": [1, 0.6, -1], "radius": 0.6,
                     "bsdf": {"type": "diffuse", "reflectance": white([0.8, 0.7, 0.2])}}}


@pytest.fixture(scope="module")
def mi():
    mi = pytest.importorskip("mitsuba")
    try:
        mi.set_variant("llvm_ad_rgb")
        mi.load_dict({"type": "scene"})
    except (ImportError, RuntimeError) as problem:
        pytest.skip(f"Mitsuba has no LLVM: {problem}")
    sys.path.insert(0, str(VALIDATION))
    return mi


def compare(mi, parts, samples=2048):
    """Residuals of irradiance at 200 points, in standard errors of both sides, and the bias."""
    from validate_against_mitsuba import mitsuba_irradiance
    scene = mi.load_dict(parts)
    ours = lte.from_mitsuba(scene)
    at, side = ours.sample(200, seed=5)
    at = at + 1e-4 * side
    _, theirs = mitsuba_irradiance(mi, scene, at, side, 5, samples, 3)
    found = lte.trace.irradiance(ours, at, side, rays=samples, depth=5, seed=9)
    error = np.sqrt(found.stderr ** 2 + theirs.variance())
    residual = (found.total - theirs.mean()).mean(1) / np.maximum(error.mean(1), 1e-6)
    total = theirs.mean().sum()
    return residual, (found.total.sum() - total) / total, np.sqrt(
        (error.sum(1) ** 2).sum()) / total


@pytest.mark.parametrize("kind", ["area", "sphere", "point", "spot", "directional", "constant",
                                  "envmap"])
def test_mitsuba_has_the_same_light(mi, kind):
    residual, bias, error = compare(mi, box(mi, **things(mi), **lamps(mi, kind)))
    assert abs(bias) < max(3 * error, 0.004)
    assert (np.abs(residual) < 3).mean() > 0.97


def ours(kind, tmp_path):
    """Scenes of lte's own."""
    if kind == "sky":
        return lte.load(lte.living_room, environment="2,1,0.5")
    if kind == "picture of a sky":
        import mitsuba as mi
        sky = np.random.default_rng(1).random((16, 32, 3)).astype(np.float32) ** 4
        mi.Bitmap(sky).write(str(tmp_path / "sky.exr"))
        return lte.load(lte.living_room, environment=tmp_path / "sky.exr", environment_turn=50)
    return lte.load(lte.living_room) if kind == "living room" else lte.generate_scene(kind, seed=4)


@pytest.mark.parametrize("kind", ["living room", "boxes", "homes", "wild", "sky",
                                  "picture of a sky"])
def test_scenes_of_ours_have_the_same_light_in_mitsuba(mi, tmp_path, kind):
    from validate_against_mitsuba import mitsuba_irradiance
    scene, samples = ours(kind, tmp_path), 1024
    at, side = scene.sample(200, seed=5)
    found = lte.trace.irradiance(scene, at, side, rays=samples, depth=5, seed=9)
    _, theirs = mitsuba_irradiance(mi, mi.load_dict(lte.to_mitsuba(scene)), at + 1e-4 * side, side,
                                   5, samples, 3)
    error = np.sqrt(found.stderr ** 2 + theirs.variance())
    lit = error.mean(1) > 1e-6
    residual = (found.total - theirs.mean()).mean(1)[lit] / error.mean(1)[lit]
    total = theirs.mean().sum()
    bias, of_bias = (found.total.sum() - total) / total, np.sqrt((error.sum(1) ** 2).sum()) / total
    assert (np.abs(residual) < 3).mean() > 0.97
    assert abs(bias) < max(3 * of_bias, 0.004)


def test_mitsuba_gives_back_what_it_got(mi, tmp_path):
    """Lamps, sky, textures, cameras and vertices, there and back."""
    before = lte.from_mitsuba({**box(mi, **things(mi)), **lamps(mi, "spot"), **lamps(mi, "envmap"),
                               "eye": {"type": "perspective", "fov": 50}})
    after = lte.from_mitsuba(lte.to_mitsuba(before))
    assert after.triangles == before.triangles and len(after.cameras) == len(before.cameras)
    assert len(after.lights) == len(before.lights)
    at, side = before.sample(100, seed=2)
    a, b = (lte.trace.irradiance(scene, at, side, rays=1024) for scene in (before, after))
    error = np.hypot(a.stderr, b.stderr)
    assert (np.abs(a.total - b.total) < 4 * error + 0.01 * a.total.mean()).mean() > 0.97


def test_metal_of_mitsuba_is_near(mi):
    """Masking and Fresnel differ in their formulas."""
    metal = {"type": "roughconductor", "distribution": "ggx", "material": "Al", "alpha": 0.3}
    ball = {"type": "sphere", "center": [0.6, 0.7, -0.8], "radius": 0.7, "bsdf": metal}
    _, bias, error = compare(mi, box(mi, ball=ball, **lamps(mi, "area")))
    assert abs(bias) < 3 * error + 0.01


def test_mitsuba_has_the_same_view(mi):
    look = mi.ScalarTransform4f.look_at([0.3, 1.6, 5], [0, 1.4, 0], [0, 1, 0])
    camera = {"type": "perspective", "fov": 45, "to_world": look, "film": {
        "type": "hdrfilm", "width": 48, "height": 32, "rfilter": {"type": "box"}}}
    scene = mi.load_dict(box(mi, eye=camera, **things(mi), **lamps(mi, "area")))
    ours = lte.from_mitsuba(scene)
    assert ours.cameras == ["eye"]
    picture = lte.render(ours, size=(48, 32), integrator="path", spp=256, denoise=False)
    theirs = np.array(mi.render(scene, integrator=mi.load_dict(
        {"type": "path", "max_depth": 6, "rr_depth": 99}), spp=256))[..., :3]
    assert np.abs(picture.color - theirs).mean() < 0.08 * theirs.mean()


def test_what_lte_lacks_is_named(mi):
    with pytest.raises(ValueError, match="lte has no Instance"):
        lte.from_mitsuba({"type": "scene", "group": {"type": "shapegroup", "a": {"type": "cube"}},
                          "copy": {"type": "instance", "g": {"type": "ref", "id": "group"}}})
    with pytest.warns(UserWarning, match="RoughPlastic: its diffuse part"):
        lte.from_mitsuba({"type": "scene", "a": {"type": "cube", "bsdf": {"type": "roughplastic"}}})


def test_xml_of_mitsuba_is_read(mi, tmp_path):
    (tmp_path / "a.xml").write_text("""<scene version="3.0.0"><shape type="sphere" id="bulb">
      <emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape></scene>""")
    assert lte.from_mitsuba(tmp_path / "a.xml").lights[0].name == "bulb"


def test_trimesh_is_the_same_as_its_file(room, room_file, points):
    trimesh = pytest.importorskip("trimesh")
    floor = trimesh.Trimesh([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]],
                            [[0, 2, 1], [0, 3, 2]])
    floor.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[255, 255, 255, 255]))
    lamp = trimesh.Trimesh([[-1, 2, -1], [1, 2, -1], [1, 2, 1], [-1, 2, 1]],
                           [[0, 1, 2], [0, 2, 3]])
    lamp.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(
        emissiveFactor=[1, 1, 1], baseColorFactor=[0, 0, 0, 255]))
    scene = trimesh.Scene([floor])
    scene.add_geometry(lamp, transform=trimesh.transformations.translation_matrix([0, 0.5, 0]))
    ours = lte.load(scene)
    assert ours.triangles == 4 and len(ours.lights) == 1
    np.testing.assert_allclose(ours.bounds, [[-2, 0, -2], [2, 2.5, 2]])
    # What a square of radiance 1 and half side a gives at the distance h below its middle.
    a, h = 1, 2.5
    corner = a / np.hypot(a, h) * np.arctan(a / np.hypot(a, h))
    light = lte.trace.irradiance(ours, [[0, 0, 0]], [[0, 1, 0]], rays=4096, depth=1)
    np.testing.assert_allclose(light.direct, 4 * corner, rtol=0.01)
    # A mesh without a material is matt grey, not metal: light comes back from below.
    assert lte.load(trimesh.creation.box(), add_light="auto").triangles == 12


USD = """#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = 0.01
)
def Xform "room" {
    def Mesh "floor" {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-200, -200, 0), (200, -200, 0), (200, 200, 0), (-200, 200, 0)]
        color3f[] primvars:displayColor = [(0.5, 0.5, 0.5)]
    }
    def RectLight "lamp" {
        float inputs:intensity = 3
        float inputs:exposure = 1
        color3f inputs:color = (1, 0.5, 0.25)
        float inputs:width = 200
        float inputs:height = 200
        double3 xformOp:translate = (0, 0, 250)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Camera "eye" {
        double3 xformOp:translate = (0, -500, 100)
        float3 xformOp:rotateXYZ = (90, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    }
    def PointInstancer "balls" {
        rel prototypes = </room/balls/ball>
        int[] protoIndices = [0, 0]
        point3f[] positions = [(100, 0, 20), (-100, 0, 20)]
        def Sphere "ball" {
            double radius = 20
        }
    }
}
"""


@pytest.fixture
def stage(tmp_path):
    pytest.importorskip("pxr")
    (tmp_path / "room.usda").write_text(USD)
    return tmp_path / "room.usda"


def test_usd_is_read_in_metres_with_y_up(stage):
    ours = lte.from_usd(stage)
    np.testing.assert_allclose(ours.bounds, [[-2, 0, -2], [2, 2.5, 2]], atol=1e-3)
    assert ours.lights[0].name == "/room/lamp" and ours.cameras == ["eye"]
    a, h = 1, 2.5
    corner = a / np.hypot(a, h) * np.arctan(a / np.hypot(a, h))
    light = lte.trace.irradiance(ours, [[0, 0, 0]], [[0, 1, 0]], rays=4096, depth=1)
    np.testing.assert_allclose(light.direct[0], 24 * corner * np.array([1, 0.5, 0.25]), rtol=0.01)
    picture = lte.render(ours, size=(32, 24), integrator="path", spp=16, denoise=False)
    seen = picture.layers["depth"] > 0
    assert 0.02 < seen.mean() < 0.5 and picture.color.any()


def test_a_damaged_stage_is_named(stage):
    stage.write_text(stage.read_text()[:-9])
    for path in (stage, stage.with_name("missing.usda")):
        with pytest.raises(lte.Error, match=path.name) as caught:
            lte.from_usd(path)
        assert "\n" not in str(caught.value)


def test_materials_and_suns_of_usd(stage):
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade
    made = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(made, 1)
    UsdGeom.SetStageUpAxis(made, "Y")
    cube = UsdGeom.Cube.Define(made, "/cube")
    material = UsdShade.Material.Define(made, "/material")
    shader = UsdShade.Shader.Define(made, "/material/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.2, 0.4, 0.6))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(cube.GetPrim()).Bind(material)
    sun = UsdLux.DistantLight.Define(made, "/sun")
    sun.CreateNormalizeAttr(True)
    sun.CreateIntensityAttr(5)
    UsdGeom.XformCommonAPI(sun).SetRotate((-90, 0, 0))
    ours = lte.from_usd(made)
    light = lte.trace.irradiance(ours, [[0, 1, 0]], [[0, 1, 0]], rays=16)
    np.testing.assert_allclose(light.direct, 5, rtol=1e-4)
    picture = lte.render(ours, size=(32, 32), camera=lte.Camera((0, 5, 0), (0, 0, 0)),
                         integrator="path", spp=4, denoise=False)
    np.testing.assert_allclose(picture.layers["albedo"][16, 16], [0.2, 0.4, 0.6], rtol=1e-3)
    np.testing.assert_allclose(picture.color[16, 16], np.array([0.2, 0.4, 0.6]) * 5 / np.pi,
                               rtol=1e-3)
