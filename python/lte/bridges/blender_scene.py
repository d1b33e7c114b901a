"""The scene that is open in Blender, with modifiers applied and instances made real."""

import pathlib
import tempfile
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lte.bridges import shapes
from lte.bridges.glb import Glb

#: Blender's Z is up, lte's Y.
TURN = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def load(depsgraph: Any = None, **options: Any) -> Any:
    import bpy
    graph = depsgraph or bpy.context.evaluated_depsgraph_get()
    scene, glb = graph.scene, Glb()
    turn = np.diag([*3 * [scene.unit_settings.scale_length or 1.0], 1.0]) @ TURN
    materials: dict[str, int] = {}
    for number, instance in enumerate(graph.object_instances):
        thing = instance.object
        if not instance.show_self or (thing.hide_render and not instance.is_instance):
            continue
        world = turn @ np.array(instance.matrix_world)
        name = f"{thing.name} {number}" if instance.is_instance else thing.name
        if thing.type == "LIGHT":
            _add_light(glb, thing.data, world, turn[0, 0], name)
        elif thing.type == "CAMERA":
            _add_camera(glb, scene, thing.data, world, name)
        elif thing.type in ("MESH", "CURVE", "SURFACE", "META", "FONT"):
            _add_mesh(glb, graph, thing, world, materials, name)
    sky = _sky(scene.world)
    if sky:
        options.setdefault("environment", sky)
    return glb.load("blender", **options)


def _add_mesh(glb: Glb, graph: Any, thing: Any, world: NDArray[np.float64],
              materials: dict[str, int], name: str) -> None:
    mesh = thing.to_mesh(depsgraph=graph)
    if mesh is None:
        return
    try:
        mesh.calc_loop_triangles()
        at = _get(mesh.vertices, "co", 3, np.float32)
        loops = _get(mesh.loop_triangles, "loops", 3, np.int32)
        of_loop = _get(mesh.loops, "vertex_index", 1, np.int32).reshape(-1)
        slot = _get(mesh.loop_triangles, "material_index", 1, np.int32).reshape(-1)
        uv = None
        if mesh.uv_layers.active:
            uv = _get(mesh.uv_layers.active.data, "uv", 2, np.float32)[loops.reshape(-1)]
            uv = uv * [1, -1] + [0, 1]
        corners = at[of_loop[loops.reshape(-1)]]
        for index in np.unique(slot):
            chosen = slot == index
            picked = np.repeat(chosen, 3)
            slots = thing.material_slots
            material = slots[min(int(index), len(slots) - 1)].material if slots else None
            key = material.name_full if material else ""
            if key not in materials:
                materials[key] = _material(glb, material)
            faces = np.arange(3 * int(chosen.sum())).reshape(-1, 3)
            placed = shapes.placed((corners[picked], faces, corners), world)
            glb.mesh(placed[0], placed[1], materials[key],
                     uv=None if uv is None else uv[picked], name=name)
    finally:
        thing.to_mesh_clear()


def _get(of: Any, name: str, width: int, kind: type) -> NDArray[Any]:
    values: NDArray[Any] = np.empty(len(of) * width, kind)
    of.foreach_get(name, values)
    return values.reshape(-1, width)


def _material(glb: Glb, material: Any) -> int:
    """By the shader at the output: Principled, Diffuse, Glossy, Emission. Light is two-sided."""
    if material is None:
        return glb.material(color=0.8)
    if not material.use_nodes:
        return glb.material(color=material.diffuse_color[:3], metallic=material.metallic,
                            roughness=material.roughness)
    shader = _shader(material.node_tree)
    kind = shader.type if shader else ""
    if kind == "BSDF_PRINCIPLED":
        color, picture = _color(glb, shader.inputs["Base Color"])
        glow, shine = _color(glb, shader.inputs["Emission Color"])
        return glb.material(
            color=color, picture=picture, metallic=_number(shader.inputs["Metallic"]),
            roughness=_number(shader.inputs["Roughness"]), glow=shine, double_sided=True,
            emission=glow * _number(shader.inputs["Emission Strength"]))
    if kind == "EMISSION":
        glow, shine = _color(glb, shader.inputs["Color"])
        return glb.material(color=0, glow=shine, double_sided=True,
                            emission=glow * _number(shader.inputs["Strength"]))
    if kind in ("BSDF_DIFFUSE", "BSDF_GLOSSY"):
        color, picture = _color(glb, shader.inputs["Color"])
        metal = kind == "BSDF_GLOSSY"
        return glb.material(color=color, picture=picture, metallic=metal,
                            roughness=_number(shader.inputs["Roughness"]) if metal else 1)
    warnings.warn(f"material {material.name}: {kind or 'no shader'} counts as grey", stacklevel=2)
    return glb.material(color=material.diffuse_color[:3])


def _shader(tree: Any) -> Any:
    for node in tree.nodes:
        if node.type == "OUTPUT_MATERIAL" and node.is_active_output:
            links = node.inputs["Surface"].links
            return links[0].from_node if links else None
    return None


def _number(socket: Any) -> float:
    return float(socket.default_value)


def _color(glb: Glb, socket: Any) -> tuple[NDArray[np.float64], int | None]:
    node = socket.links[0].from_node if socket.links else None
    if node is not None and node.type == "TEX_IMAGE" and node.image is not None:
        return np.ones(3), glb.picture(_png(node.image))
    if node is not None and node.type == "RGB":
        return np.array(node.outputs[0].default_value[:3]), None
    if node is not None:
        warnings.warn(f"{node.name}: its color is left out", stacklevel=2)
    return np.array(socket.default_value[:3]), None


def _png(image: Any) -> bytes:
    copy = image.copy()
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "picture.png"
            copy.file_format = "PNG"
            copy.save(filepath=str(path))
            return path.read_bytes()
    finally:
        import bpy
        bpy.data.images.remove(copy)


def _add_light(glb: Glb, light: Any, world: NDArray[np.float64], metre: float, name: str) -> None:
    """As Cycles has it: watts are of the lamp, whatever its size."""
    power = light.energy * np.array(light.color)
    at, to = world[:3, 3], -world[:3, 2]
    if light.type == "SUN":
        glb.light("directional", power, to=to, name=name)
    elif light.type == "AREA":
        square = light.shape in ("SQUARE", "DISK")
        size = [light.size, light.size if square else light.size_y]
        mesh = shapes.disk() if light.shape in ("DISK", "ELLIPSE") else shapes.rectangle()
        place = world @ np.diag([size[0] / 2, -size[1] / 2, -1, 1])
        lamp = shapes.placed(mesh, place)
        a, b, c = (lamp[0][lamp[1][:, i]] for i in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        shines = glb.material(color=0, emission=power / (np.pi * area))
        glb.mesh(lamp[0], lamp[1], shines, name=name)
    elif light.type == "POINT" and light.shadow_soft_size > 0:
        radius = light.shadow_soft_size * metre
        lamp = shapes.placed(shapes.sphere(), np.diag([radius, radius, radius, 1.0]))
        glow = power / (4 * np.pi ** 2 * radius ** 2)
        glb.mesh(lamp[0] + at, lamp[1], glb.material(color=0, emission=glow), name=name)
    elif light.type == "POINT":
        glb.light("point", power / (4 * np.pi), at=at, name=name)
    else:
        none = light.spot_size / 2
        full = np.arccos(np.cos(none) + light.spot_blend * (1 - np.cos(none)))
        glb.light("spot", power / (4 * np.pi), at=at, to=to, name=name,
                  cones=(min(full, none - 1e-4), none))


def _add_camera(glb: Glb, scene: Any, camera: Any, world: NDArray[np.float64], name: str) -> None:
    if camera.type != "PERSP":
        return
    width, height = (scene.render.resolution_x * scene.render.pixel_aspect_x,
                     scene.render.resolution_y * scene.render.pixel_aspect_y)
    across = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and width >= height)
    half = np.tan(camera.angle / 2) * (height / width if across else 1)
    place = world.copy()
    place[:3, :3] /= np.linalg.norm(place[:3, :3], axis=0)
    glb.camera(place, 2 * np.degrees(np.arctan(half)), name=name)


def _sky(world: Any) -> str:
    """A world of one color."""
    if world is None:
        return ""
    color = np.array(world.color)
    if world.use_nodes:
        node = next((node for node in world.node_tree.nodes if node.type == "BACKGROUND"), None)
        if node is None:
            return ""
        if node.inputs["Color"].links:
            warnings.warn("a world's picture is left out: environment= takes it", stacklevel=2)
            return ""
        color = np.array(node.inputs["Color"].default_value[:3]) * _number(node.inputs["Strength"])
    return ",".join(f"{value:.9g}" for value in color) if color.any() else ""
