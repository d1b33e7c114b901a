"""Opens scene.glb in Blender with the light map as its light.

usage: blender --python import.py    or, where bpy is a module, python import.py -- out.blend
"""
import pathlib
import sys

import bpy

FOLDER = pathlib.Path(__file__).resolve().parent


def add_light(material, image, uv_map):
    """Material: base color times E / pi, besides what it emits itself."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    place = nodes.new("ShaderNodeUVMap")
    place.uv_map = uv_map
    light = nodes.new("ShaderNodeTexImage")
    light.image, light.extension = image, "EXTEND"
    links.new(place.outputs["UV"], light.inputs["Vector"])
    product = nodes.new("ShaderNodeVectorMath")
    product.operation = "MULTIPLY"
    links.new(light.outputs["Color"], product.inputs[0])
    color = shader.inputs["Base Color"]
    if color.is_linked:
        links.new(color.links[0].from_socket, product.inputs[1])
    else:
        product.inputs[1].default_value = color.default_value[:3]
    reflected = nodes.new("ShaderNodeEmission")
    links.new(product.outputs["Vector"], reflected.inputs["Color"])
    emitted = nodes.new("ShaderNodeEmission")
    for ours, theirs in (("Color", "Emission Color"), ("Strength", "Emission Strength")):
        socket = shader.inputs[theirs]
        if socket.is_linked:
            links.new(socket.links[0].from_socket, emitted.inputs[ours])
        else:
            emitted.inputs[ours].default_value = socket.default_value
    both = nodes.new("ShaderNodeAddShader")
    links.new(reflected.outputs[0], both.inputs[0])
    links.new(emitted.outputs[0], both.inputs[1])
    links.new(both.outputs[0], output.inputs["Surface"])


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(FOLDER / "scene.glb"))
    image = bpy.data.images.load(str(FOLDER / "lightmap.exr"))
    image.colorspace_settings.name = "Linear Rec.709"
    for mesh in bpy.data.meshes:
        for material in mesh.materials:
            if not any(node.type == "EMISSION" for node in material.node_tree.nodes):
                add_light(material, image, mesh.uv_layers[1].name)
    # Light is in the map already.
    bpy.context.scene.cycles.max_bounces = 0
    if "--" in sys.argv:
        bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])


main()
