#!/usr/bin/env python3
"""Bakes the indirect light of a scene's atlas with Blender's Cycles.

usage: cycles_light_map.py SCENE.glb --out FILE.exr --json FILE.json --size 512x512
           [--samples 64] [--seed 1] [--threads 2]

It needs PyPI's bpy and is run by lte_bench bake --cycles PYTHON. SCENE has the atlas on TEXCOORD_1.
The picture is irradiance E in W/m^2, row 0 at the top, as lightmap.exr has it; the JSON has the
seconds of the bake, by the clock and of processors, without Blender's start and import. Surfaces
reflect as lte has them: diffuse, with a path's hits bounded by lte's depth of five. A chart whose
back is lit is baked in front, as Cycles bakes no other side.
"""
import argparse
import json
import math
import os
import sys
import time

import bpy

INDIRECT_HITS = 4  # five, of which the last may only be a lamp


def parse_args():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--out", required=True)
    parser.add_argument("--json", required=True)
    parser.add_argument("--size", required=True)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


def set_up_cycles(args):
    render = bpy.context.scene.render
    render.engine = "CYCLES"
    render.threads_mode = "FIXED"
    render.threads = args.threads
    cycles = bpy.context.scene.cycles
    cycles.device = "CPU"
    cycles.samples = args.samples
    cycles.seed = args.seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = INDIRECT_HITS
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0  # no light is lost


def make_target(args, materials):
    """A float picture, the active image of every material, whose surfaces become diffuse."""
    width, height = map(int, args.size.split("x"))
    image = bpy.data.images.new("atlas", width, height, alpha=False, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    for material in materials:
        nodes = material.node_tree.nodes
        for node in nodes:
            if node.type == "BSDF_PRINCIPLED":
                node.inputs["Specular IOR Level"].default_value = 0
        target = nodes.new("ShaderNodeTexImage")
        target.image = image
        nodes.active = target
    return image


def main():
    args = parse_args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # lte's glTF has candela as W/sr, with no luminous efficacy between.
    bpy.ops.import_scene.gltf(filepath=args.scene, export_import_convert_lighting_mode="COMPAT")
    set_up_cycles(args)
    bpy.ops.object.select_all(action="DESELECT")
    objects = [item for item in bpy.data.objects if item.type == "MESH"]
    without = bpy.data.materials.new("none")
    without.use_nodes = True
    for item in objects:
        if not item.data.materials:
            item.data.materials.append(without)
        item.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    bpy.ops.object.join()  # or Cycles sets up the scene anew for each of them
    image = make_target(args, [m for m in bpy.data.materials if m.use_nodes])
    started, used = time.monotonic(), sum(os.times()[:2])
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"INDIRECT"}, uv_layer="UVMap.001", margin=4,
                        margin_type="EXTEND", use_clear=True)
    seconds = {"seconds": time.monotonic() - started,
               "processor_seconds": sum(os.times()[:2]) - used, "version": bpy.app.version_string}
    # The pass has E / pi.
    pixels = [0.0] * len(image.pixels)
    image.pixels.foreach_get(pixels)
    image.pixels.foreach_set([value * math.pi for value in pixels])
    image.filepath_raw = args.out
    image.file_format = "OPEN_EXR"
    image.save()
    with open(args.json, "w", encoding="utf-8") as file:
        json.dump(seconds, file)


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, OSError) as error:
        sys.exit(f"cycles_light_map.py: {error}")
