"""Takes the meshes, lamps and panes of a room out of Infinigen's .blend: modifiers and instances
applied, glass and lamp covers left out of the meshes, triangles decimated. Needs bpy."""
import bpy
import mathutils
import numpy as np
from mathutils.bvhtree import BVHTree

# Covers that only Cycles lets light through, by Infinigen's name for their shader.
COVER = "lamp_bulb"
NEAR = 4.0  # metres around the furnished room in which objects can matter


class Lamp:
    """A point light of Infinigen: a sphere of `radius` that sends out `watts`."""
    def __init__(self, light):
        self.center = np.array(light.matrix_world.translation)
        self.radius = light.data.shadow_soft_size
        self.watts = light.data.energy
        self.kelvin = 6500.0
        for node in light.data.node_tree.nodes if light.data.use_nodes else ():
            if node.type == "BLACKBODY":
                self.kelvin = node.inputs["Temperature"].default_value
        self.owner = light.parent.name if light.parent else ""


class Pane:
    """The glass of a window, seen from inside: positions [V, 3] in the world, triangles [T, 3]."""
    def __init__(self, window, positions, triangles):
        self.window, self.positions, self.triangles = window, positions, triangles


def room_part(name):
    """("dining-room_0/0", "wall") of "dining-room_0/0.wall"; None of anything else."""
    parts = name.split(".")
    parts_of_rooms = ("wall", "floor", "ceiling", "exterior")
    return (parts[0], parts[1]) if len(parts) > 1 and parts[1] in parts_of_rooms else None


def bounds(instance_object, matrix):
    corners = np.array([matrix @ mathutils.Vector(c) for c in instance_object.bound_box])
    return corners.min(0), corners.max(0)


def visible_instances():
    """(name, evaluated object, world matrix) of all meshes that Infinigen would render."""
    found = []
    for item in bpy.context.evaluated_depsgraph_get().object_instances:
        original = (item.parent or item.object).original
        if item.object.type == "MESH" and item.show_self and not original.hide_render:
            if len(item.object.data.polygons):
                found.append((original.name, item.object, item.matrix_world.copy()))
    return found


def furnished_room(instances):
    """The name and the bounds of the room that holds the most objects."""
    floors = {}
    for name, obj, matrix in instances:
        part = room_part(name)
        if part and part[1] == "floor":
            floors[part[0]] = bounds(obj, matrix)
    count = dict.fromkeys(floors, 0)
    for name, obj, matrix in instances:
        low, high = bounds(obj, matrix)
        center = (low + high) / 2
        for room, (room_low, room_high) in floors.items():
            inside = np.all(center[:2] > room_low[:2]) and np.all(center[:2] < room_high[:2])
            count[room] += bool(inside and not room_part(name) and "Factory" in name)
    best = max(sorted(count), key=count.get)
    return best, floors[best]


def is_glass(material):
    """Whether light is meant to pass through: a pane, or a lamp's cover."""
    if not material or not material.use_nodes:
        return False
    for node in material.node_tree.nodes:
        if node.type in ("BSDF_GLASS", "BSDF_REFRACTION", "BSDF_TRANSPARENT"):
            return True
        if node.type == "BSDF_PRINCIPLED":
            if node.inputs["Transmission Weight"].default_value > 0.5:
                return True
    return False


def keep_faces(mesh, keep):
    """Removes the faces of a bpy mesh whose entry of `keep` is False."""
    import bmesh
    work = bmesh.new()
    work.from_mesh(mesh)
    work.faces.ensure_lookup_table()
    doomed = [work.faces[i] for i in np.flatnonzero(~keep)]
    bmesh.ops.delete(work, geom=doomed, context="FACES")
    work.to_mesh(mesh)
    work.free()


def drop_see_through(obj):
    """Leaves out panes of windows and doors, and the covers of lamps."""
    mesh = obj.data
    slots = np.zeros(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    opening = any(word in obj.name for word in ("Window", "Door"))
    drop = [m is not None and (COVER in m.name or (opening and is_glass(m)))
            for m in mesh.materials] or [False]
    keep = ~np.array(drop)[np.minimum(slots, len(drop) - 1)]
    if not keep.all():
        keep_faces(mesh, keep)


def pane_of(obj, inside):
    """The Pane of a window, of faces that look at the place `inside`; None of anything else."""
    glass = [is_glass(m) for m in obj.data.materials]
    if "Window" not in obj.name or not any(glass):
        return None
    obj.data.calc_loop_triangles()
    turn = np.array(obj.matrix_world)
    positions = np.array([v.co for v in obj.data.vertices]) @ turn[:3, :3].T + turn[:3, 3]
    kept = []
    for t in obj.data.loop_triangles:
        a, b, c = positions[list(t.vertices)]
        normal = np.cross(b - a, c - a)
        upright = abs(normal[2]) < np.abs(normal).max()  # no edge of the glass
        if glass[min(t.material_index, len(glass) - 1)] and upright and normal @ (inside - a) > 0:
            kept.append(t.vertices)
    if not kept:
        return None
    used, triangles = np.unique(np.array(kept), return_inverse=True)
    return Pane(obj.name, positions[used], triangles.reshape(-1, 3))


def loose_parts(mesh):
    """[faces] int: the connected part that each face belongs to."""
    parent = np.arange(len(mesh.vertices))

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b in (tuple(e.vertices) for e in mesh.edges):
        parent[root(a)] = root(b)
    return np.array([root(p.vertices[0]) for p in mesh.polygons])


def directions(count):
    """[count, 3] unit vectors, evenly over the sphere."""
    i = np.arange(count) + 0.5
    z, phi = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], 1)


def free_lamp(obj, lamp, least=0.08):
    """Removes parts of the lamp's own object, the one that hides it most first, until `least` of
    its rays leave it: bulbs and sockets around the sphere, whose light only Cycles lets out."""
    mesh = obj.data
    to_local = obj.matrix_world.inverted()
    for _ in range(8):
        if not len(mesh.polygons):
            return
        tree = BVHTree.FromPolygons([v.co[:] for v in mesh.vertices],
                                    [p.vertices[:] for p in mesh.polygons])
        hits = []
        rays = directions(256)
        for d in rays:
            start = to_local @ mathutils.Vector(lamp.center + 0.5 * lamp.radius * d)
            index = tree.ray_cast(start, to_local.to_3x3() @ mathutils.Vector(d))[2]
            if index is not None:
                hits.append(index)
        if 1 - len(hits) / len(rays) >= least:
            return
        parts = loose_parts(mesh)
        ids, counts = np.unique(parts[hits], return_counts=True)
        keep_faces(mesh, parts != ids[counts.argmax()])


def decimate(obj, cap):
    """Triangulates obj and reduces it to about `cap` triangles, in place."""
    mesh = obj.data
    triangles = sum(len(p.vertices) - 2 for p in mesh.polygons)
    if triangles > cap:
        modifier = obj.modifiers.new("decimate", "DECIMATE")
        modifier.ratio = cap / triangles
        modifier.use_collapse_triangulate = True
    obj.modifiers.new("triangulate", "TRIANGULATE")
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    reduced = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True,
                                              depsgraph=bpy.context.evaluated_depsgraph_get())
    obj.modifiers.clear()
    obj.data = reduced
    if mesh.users == 0:
        bpy.data.meshes.remove(mesh)


def take_out(cap):
    """Replaces the scene's objects by plain meshes of at most `cap` triangles near the furnished
    room.

    @return (name of the room, (low, high) of its floor, [bpy objects], [Lamp], [Pane])
    """
    instances = visible_instances()
    room, (low, high) = furnished_room(instances)
    lamps = [Lamp(o) for o in bpy.data.objects if o.type == "LIGHT" and o.data.type == "POINT"
             and not o.hide_render]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    taken = []
    for name, obj, matrix in sorted(instances, key=lambda i: i[0]):
        obj_low, obj_high = bounds(obj, matrix)
        if np.any(obj_low[:2] > high[:2] + NEAR) or np.any(obj_high[:2] < low[:2] - NEAR):
            continue
        mesh = bpy.data.meshes.new_from_object(obj, preserve_all_data_layers=True,
                                               depsgraph=depsgraph)
        if len(mesh.polygons):
            taken.append((name, mesh, matrix))
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    made = []
    for name, mesh, matrix in taken:
        obj = bpy.data.objects.new(name, mesh)
        obj.matrix_world = matrix
        bpy.context.scene.collection.objects.link(obj)
        made.append(obj)
    bpy.context.view_layer.update()
    panes = [pane_of(obj, (low + high) / 2 + [0, 0, 1]) for obj in made]
    for obj, (name, _, _) in zip(made, taken):
        drop_see_through(obj)
        for lamp in lamps:
            if lamp.owner == name:
                free_lamp(obj, lamp)
        decimate(obj, cap)
    objects = [o for o in made if len(o.data.polygons)]
    return room, (low, high), objects, lamps, [p for p in panes if p]
