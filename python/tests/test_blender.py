"""Scenes of Blender, held against Cycles' pictures and against lamps' power."""
import pathlib
import sys

import numpy as np
import pytest

import lte

ADDON = pathlib.Path(__file__).resolve().parents[2] / "integrations" / "blender"


@pytest.fixture
def bpy():
    bpy = pytest.importorskip("bpy")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("dark")
    bpy.context.scene.world.color = (0, 0, 0)
    return bpy


def plane(bpy, size=8, color=(0.6, 0.6, 0.6)):
    bpy.ops.mesh.primitive_plane_add(size=size)
    material = bpy.data.materials.new("matt")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    out = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    shader = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*color, 1)
    material.node_tree.links.new(shader.outputs[0], out.inputs["Surface"])
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def lamp(bpy, kind, energy, place=(0, 0, 2), **settings):
    data = bpy.data.lights.new(kind, kind)
    data.energy, data.color = energy, (1, 0.5, 0.25)
    for name, value in settings.items():
        setattr(data, name, value)
    made = bpy.data.objects.new(kind, data)
    made.location = place
    bpy.context.collection.objects.link(made)


def camera(bpy):
    data = bpy.data.cameras.new("eye")
    data.angle = 0.3
    eye = bpy.data.objects.new("eye", data)
    eye.location = (0, -3, 1.2)
    eye.rotation_euler = (1.19, 0, 0)
    bpy.context.collection.objects.link(eye)
    bpy.context.scene.camera = eye


def cycles(bpy, tmp_path, samples=256):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 24, 16
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = str(tmp_path / "cycles.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    return np.array(image.pixels).reshape(16, 24, 4)[::-1, :, :3]


@pytest.mark.parametrize("kind, energy, settings", [
    ("AREA", 40, {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.5}),
    ("AREA", 40, {"shape": "DISK", "size": 0.8}),
    ("POINT", 60, {"shadow_soft_size": 0.1}), ("SPOT", 60, {"spot_blend": 0, "spot_size": 1.2}),
    ("SUN", 3, {})])
def test_lamps_are_as_bright_as_in_cycles(bpy, tmp_path, kind, energy, settings):
    plane(bpy)
    lamp(bpy, kind, energy, **settings)
    camera(bpy)
    theirs = cycles(bpy, tmp_path)
    ours = lte.render(lte.from_blender(), size=(24, 16), integrator="path", spp=256, denoise=False)
    assert theirs.mean() > 0.01
    np.testing.assert_allclose(ours.color.mean((0, 1)), theirs.mean((0, 1)), rtol=0.02)
    assert np.abs(ours.color - theirs).mean() < 0.05 * theirs.mean()


def test_worlds_are_environments(bpy):
    plane(bpy)
    bpy.context.scene.world.color = (1, 2, 3)
    light = lte.trace.irradiance(lte.from_blender(), [[0, 0.1, 0]], [[0, 1, 0]], rays=64)
    np.testing.assert_allclose(light.total[0], np.pi * np.array([1, 2, 3]), rtol=1e-3)


def test_modifiers_and_instances_are_real(bpy):
    thing = plane(bpy, 1)
    array = thing.modifiers.new("array", "ARRAY")
    array.count = 3
    group = bpy.data.collections.new("group")
    group.objects.link(thing)
    for place in ((0, 0, 1), (0, 0, 2)):
        empty = bpy.data.objects.new("copy", None)
        empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", group, place
        bpy.context.collection.objects.link(empty)
    ours = lte.from_blender()
    assert ours.triangles == 3 * 2 * 3
    np.testing.assert_allclose(ours.bounds, [[-0.5, 0, -0.5], [2.5, 2, 0.5]], atol=1e-6)


def test_the_panel_shows_a_picture(bpy):
    sys.path.insert(0, str(ADDON))
    import lte_panel
    plane(bpy)
    lamp(bpy, "AREA", 40)
    camera(bpy)
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 32, 24
    bpy.context.scene.render.resolution_percentage = 50
    lte_panel.register()
    try:
        bpy.context.scene.lte.quality = "draft"
        assert bpy.ops.lte.render() == {"FINISHED"}
    finally:
        lte_panel.unregister()
    image = bpy.data.images["lte"]
    picture = lte.render(lte.from_blender(), size=(16, 12), quality="draft", camera="eye")
    shown = np.array(image.pixels).reshape(12, 16, 4)[::-1, :, :3]
    np.testing.assert_allclose(shown, picture.color, rtol=1e-5)
