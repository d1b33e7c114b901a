"""What Cycles shows of a folder that lte_bake --format blender has written, or of an unlit GLB.

usage: python blender_picture.py FOLDER|FILE.glb VIEW.json OUT.exr    by a Python that has bpy

VIEW.json has origin, target and vfov of a camera, width and height. Prints a line of facts of what
was imported.
"""
import json
import pathlib
import runpy
import sys

import bpy
import mathutils


def import_folder(folder):
    """By the folder's own script."""
    sys.argv = [str(folder / "import.py")]
    runpy.run_path(sys.argv[0])
    (image, ) = [image for image in bpy.data.images if image.name.endswith(".exr")]
    width, height = image.size
    # Blender's rows run upwards.
    first = (height - 1) * width * 4
    return {"size": [width, height], "top_left": list(image.pixels[first:first + 3]),
            "color_space": image.colorspace_settings.name}


def import_unlit(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    return {}


def add_camera(view):
    """glTF's y is Blender's z."""
    def turned(v):
        return mathutils.Vector((v[0], -v[2], v[1]))
    camera = bpy.data.objects.new("view", bpy.data.cameras.new("view"))
    bpy.context.collection.objects.link(camera)
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = view["vfov"] * 3.141592653589793 / 180
    camera.location = turned(view["origin"])
    forward = turned(view["target"]) - turned(view["origin"])
    camera.rotation_euler = forward.to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = camera


def main():
    source, view, out = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    view = json.loads(view.read_text())
    facts = import_folder(source) if source.is_dir() else import_unlit(source)
    facts["uv_layers"] = sorted({len(mesh.uv_layers) for mesh in bpy.data.meshes})
    facts["meshes"] = len(bpy.data.meshes)
    print("facts:", json.dumps(facts))
    add_camera(view)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 16
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    scene.render.resolution_x, scene.render.resolution_y = view["width"], view["height"]
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)


main()
