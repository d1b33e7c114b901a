"""Base colors of Infinigen's procedural materials, by Cycles: a texture where triangles are large,
a color a vertex where they are small, one color where the surface has one. Needs bpy."""
import bpy
import numpy as np

FINE = 3e-4  # square metres: triangles that are smaller on average get a color a vertex
TEXELS_A_METRE = 110
SIDES = (32, 512)
FLAT = 0.03  # sRGB units: what differs less, as a standard deviation, is one color
DARKEST, BRIGHTEST = 0.01, 0.9  # linear; base colors outside are no albedo of a real surface


class Surface:
    """The triangles of one material of an object, in the object's frame.

    positions [V, 3], triangles [T, 3]; color [3] linear; `uvs` [V, 2] with `image` [H, W, 3] sRGB
    in [0, 1], or `tints` [V, 3] linear, or neither.
    """
    def __init__(self, positions, triangles, color):
        self.positions, self.triangles, self.color = positions, triangles, color
        self.uvs = self.image = self.tints = None


def to_srgb(x):
    x = np.clip(x, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x**(1 / 2.4) - 0.055)


def to_linear(x):
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055)**2.4)


def emit_base_color(tree):
    """Replaces every BSDF of a node tree by an emission of its color, so that mixed and wrapped
    shaders (scratches, wear) emit the mixture of their base colors."""
    for node in list(tree.nodes):
        if not (node.type.startswith("BSDF_") or node.type == "SUBSURFACE_SCATTERING"):
            continue
        color = node.inputs.get("Base Color") or node.inputs.get("Color")
        if color is None:
            continue
        emission = tree.nodes.new("ShaderNodeEmission")
        emission.inputs["Color"].default_value = color.default_value
        for link in list(color.links):
            tree.links.new(link.from_socket, emission.inputs["Color"])
        for output in node.outputs:
            for link in list(output.links):
                tree.links.new(emission.outputs[0], link.to_socket)
        tree.nodes.remove(node)


def prepare():
    """Flattens all materials and sets Cycles up. Call once, after glass has been looked for."""
    for group in bpy.data.node_groups:
        if group.bl_idname == "ShaderNodeTree":
            emit_base_color(group)
    for material in bpy.data.materials:
        if material.use_nodes:
            emit_base_color(material.node_tree)
            for node in material.node_tree.nodes:
                if node.type == "OUTPUT_MATERIAL":
                    for name in ("Displacement", "Volume"):
                        for link in list(node.inputs[name].links):
                            material.node_tree.links.remove(link)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 4
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.bake.margin = 8
    scene.render.use_persistent_data = False
    for obj in scene.objects:
        obj.hide_render = True


def default_material():
    name = "no material"
    if name not in bpy.data.materials:
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (0.5, 0.5, 0.5, 1)
        emit_base_color(material.node_tree)
    return bpy.data.materials[name]


def select_alone(obj):
    for other in bpy.context.selected_objects:
        other.select_set(False)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


def run_bake(obj, **target):
    obj.hide_render = False
    select_alone(obj)
    bpy.ops.object.bake(type="EMIT", use_clear=True, **target)
    obj.hide_render = True


def unwrap(obj, side):
    """Gives obj a layout "bake" without overlaps and makes it the active one."""
    layer = obj.data.uv_layers.new(name="bake", do_init=False)
    obj.data.uv_layers.active = layer
    select_alone(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=2.0 / side)
    bpy.ops.object.mode_set(mode="OBJECT")
    uvs = np.zeros(2 * len(obj.data.loops), np.float32)
    obj.data.uv_layers["bake"].data.foreach_get("uv", uvs)
    return np.clip(uvs.reshape(-1, 2), 0, 1)


def bake_texture(obj, side):
    """(uvs [loops, 2], image [side, side, 3] linear, bottom row first)"""
    uvs = unwrap(obj, side)
    image = bpy.data.images.new("bake", side, side, alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    for material in obj.data.materials:
        material.use_nodes = True
        nodes = material.node_tree.nodes
        node = nodes.get("bake target") or nodes.new("ShaderNodeTexImage")
        node.name, node.image = "bake target", image
        nodes.active = node
    run_bake(obj, target="IMAGE_TEXTURES")
    pixels = np.array(image.pixels[:], np.float32).reshape(side, side, 4)
    bpy.data.images.remove(image)
    covered = pixels[..., 3] > 0.5
    texels = np.clip(pixels[..., :3], DARKEST, BRIGHTEST)
    if covered.any():
        texels[~covered] = texels[covered].mean(0)
    return uvs, texels


def bake_vertices(obj):
    """[loops, 3] linear"""
    attribute = obj.data.color_attributes.new("bake", "FLOAT_COLOR", "CORNER")
    obj.data.color_attributes.active_color = attribute
    run_bake(obj, target="VERTEX_COLORS")
    colors = np.zeros(4 * len(obj.data.loops), np.float32)
    obj.data.color_attributes["bake"].data.foreach_get("color", colors)
    return np.clip(colors.reshape(-1, 4)[:, :3], DARKEST, BRIGHTEST)


def texel_colors(uvs, image, triangles):
    """[T, 4, 3]: the texture at four places of each triangle."""
    weights = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]], np.float32)
    weights /= weights.sum(1, keepdims=True)
    places = np.einsum("kc,tcd->tkd", weights, uvs[triangles])
    side = len(image)
    x, y = np.moveaxis(np.clip((places * side).astype(int), 0, side - 1), -1, 0)
    return image[y, x]


def compact(loops, vertex, *attributes):
    """Loops of equal vertex and attributes become one vertex.

    @return (the first loop of each new vertex, new indices of `loops`)
    """
    key = np.concatenate([vertex[loops][:, None].astype(np.float64)] +
                         [np.round(a[loops] * 65535.0) for a in attributes], 1)
    _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return loops[first], inverse.reshape(-1)


def bake_object(obj):
    """[Surface] of a triangulated object whose scene went through `prepare`."""
    mesh = obj.data
    if not len(mesh.materials):
        mesh.materials.append(default_material())
    for i, material in enumerate(mesh.materials):
        if material is None:
            mesh.materials[i] = default_material()
    count = len(mesh.polygons)
    positions = np.zeros(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    positions = positions.reshape(-1, 3)
    vertex = np.zeros(3 * count, np.int32)
    mesh.loops.foreach_get("vertex_index", vertex)
    slots = np.zeros(count, np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    slots = np.minimum(slots, len(mesh.materials) - 1)
    corners = positions[vertex.reshape(-1, 3)] @ np.array(obj.matrix_world.to_3x3()).T
    areas = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    loops = np.arange(3 * count).reshape(-1, 3)
    uvs = image = None
    if areas.sum() / count > FINE:
        side = 2**int(np.ceil(np.log2(TEXELS_A_METRE * np.sqrt(areas.sum()) + 1)))
        uvs, image = bake_texture(obj, int(np.clip(side, *SIDES)))
        samples = texel_colors(uvs, image, loops)
    else:
        tints = bake_vertices(obj)
        samples = tints[loops]
    surfaces = []
    for slot in np.unique(slots):
        mine = np.flatnonzero(slots == slot)
        weights = np.repeat(areas[mine] + 1e-12, samples.shape[1])
        colors = samples[mine].reshape(-1, 3)
        mean = np.average(colors, 0, weights)
        spread = np.sqrt(np.average((to_srgb(colors) - to_srgb(mean))**2, 0, weights).max())
        mine = loops[mine].reshape(-1)
        extra = () if spread < FLAT else (uvs, ) if image is not None else (tints, )
        first, indices = compact(mine, vertex, *extra)
        surface = Surface(positions[vertex[first]], indices.reshape(-1, 3), mean)
        if extra and image is not None:
            surface.uvs, surface.image = uvs[first], to_srgb(image)
        elif extra:
            surface.tints = tints[first]
        surfaces.append(surface)
    return surfaces
