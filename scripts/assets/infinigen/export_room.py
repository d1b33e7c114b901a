#!/usr/bin/env python3
"""Exports the furnished room of an Infinigen .blend, and what can be reached from it by light, as
a .glb. Called by make_rooms.py.

usage: export_room.py SCENE.blend OUT.glb --room NAME --seed N --triangles N [--daylight]

By daylight lamps are out, and panes shine as if an overcast sky stood behind frosted glass.
"""
import argparse
import importlib.metadata
import pathlib
import sys
import time

import bpy
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import bake_colors  # noqa: E402
import blend_meshes  # noqa: E402
import room_view  # noqa: E402
import write_glb  # noqa: E402

MESH_CAP = 12000  # triangles
SKY_RADIANCE, SKY_KELVIN = 15.0, 7500.0  # of a pane, W/(m² sr)
LEAST_HITS = 30  # of some 150,000: what paths from the room meet less often, beyond it, is left out


def world_mesh(obj):
    """(name, positions in the world, triangles) of a triangulated object."""
    positions = np.zeros(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", positions)
    matrix = np.array(obj.matrix_world)
    triangles = np.zeros(3 * len(obj.data.polygons), np.int32)
    obj.data.polygons.foreach_get("vertices", triangles)
    return (obj.name, positions.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3],
            triangles.reshape(-1, 3))


def cap_for(counts, budget):
    """The largest cap a mesh with which meshes of `counts` triangles stay within the budget."""
    low, high = 100, MESH_CAP
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if np.minimum(counts, middle).sum() <= budget else (low,
                                                                                       middle - 1)
    return low


def keep_reached(objects, room, bounds, rng):
    """The objects that paths from the room meet; of other rooms and of doors, those met often."""
    world = room_view.World([world_mesh(o) for o in objects])
    hits = room_view.reached(world, room, bounds, rng)
    kept = []
    for obj, count in zip(objects, hits):
        name = obj.name.split(".")[0]
        own = name == room or not (blend_meshes.room_part(obj.name) or "Door" in obj.name)
        if count >= (1 if own else LEAST_HITS):
            kept.append(obj)
        else:
            bpy.data.objects.remove(obj)
    return kept


def add_objects(glb, objects, origin, say):
    """Bakes and adds all objects; `origin` becomes the origin of the file."""
    bake_colors.prepare()
    for obj in objects:
        began = time.time()
        matrix = np.array(obj.matrix_world)
        matrix[:3, 3] -= origin
        surfaces = bake_colors.bake_object(obj)
        glb.add_object(obj.name, surfaces, matrix)
        kinds = "".join("t" if s.image is not None else "v" if s.tints is not None else "c"
                        for s in surfaces)
        say(f"{obj.name}: {len(obj.data.polygons)} triangles, {kinds}, {time.time() - began:.1f} s")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("blend", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--room", required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--triangles", type=int, default=200000)
    parser.add_argument("--daylight", action="store_true")
    args = parser.parse_args()
    start = time.time()

    def say(text):
        print(f"[{time.time() - start:6.1f} s] {text}", flush=True)

    bpy.ops.wm.open_mainfile(filepath=str(args.blend))
    bpy.context.scene.render.threads_mode, bpy.context.scene.render.threads = "FIXED", 1
    # By daylight the same room is seen from elsewhere.
    rng = np.random.default_rng((args.seed, 1) if args.daylight else args.seed)
    room, bounds, objects, lamps, panes = blend_meshes.take_out(MESH_CAP)
    say(f"{room}: {len(objects)} objects, {len(lamps)} lamps, {len(panes)} panes")
    objects = keep_reached(objects, room, bounds, rng)
    counts = np.array([len(o.data.polygons) for o in objects])
    cap = cap_for(counts, args.triangles)
    for obj, count in zip(objects, counts):
        if count > cap:
            blend_meshes.decimate(obj, cap)
    total = sum(len(o.data.polygons) for o in objects)
    say(f"{len(objects)} objects reached, at most {cap} triangles each, {total} in all")
    world = room_view.World([world_mesh(o) for o in objects])
    eye, yaw, pitch = room_view.best_camera(world, room, bounds, rng)
    say(f"camera at {eye}, yaw {np.degrees(yaw):.0f} degrees")
    low, high = bounds
    origin = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    inside = [lamp for lamp in lamps if np.all(lamp.center[:2] > low[:2] - 0.1)
              and np.all(lamp.center[:2] < high[:2] + 0.1)] if not args.daylight else []
    names = {obj.name for obj in objects}
    panes = [pane for pane in panes if pane.window in names] if args.daylight else []
    glb = write_glb.Glb({
        "source": f"Infinigen {importlib.metadata.version('infinigen')}, Blender "
                  f"{bpy.app.version_string}", "room": args.room, "seed": args.seed,
        "triangles": total, "lamps": len(inside), "panes": len(panes),
        "license": "generated by Infinigen (BSD-3-Clause), Princeton University"})
    glb.add_camera(eye - origin, yaw, pitch, room_view.YFOV)
    for i, lamp in enumerate(inside):
        glb.add_lamp(f"lamp {i}", lamp.center - origin, lamp.radius, lamp.watts, lamp.kelvin)
    for i, pane in enumerate(panes):
        glb.add_pane(f"pane {i}", pane.positions - origin, pane.triangles, SKY_RADIANCE, SKY_KELVIN)
    add_objects(glb, objects, origin, say)
    glb.save(args.out)
    say(f"{args.out.name}: {args.out.stat().st_size / 1e6:.1f} MB, {total} triangles, "
        f"{len(inside)} lamps, {len(panes)} panes")


if __name__ == "__main__":
    main()
