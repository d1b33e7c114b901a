"""What light from a room can reach, and a camera in the room that sees its furniture. mathutils and
NumPy; coordinates are Blender's, z up."""
import math

import mathutils
import numpy as np
from mathutils.bvhtree import BVHTree

EYE = 1.5  # metres above the floor
CLEAR = 0.35  # metres around a camera without geometry
YFOV = math.radians(58)
SHELL = ("wall", "floor", "ceiling", "exterior")


class World:
    """The triangles of all objects, which of them each belongs to, and rays among them."""
    def __init__(self, meshes):
        """meshes: [(name, positions [V, 3] in the world, triangles [T, 3])]"""
        self.names = [name for name, _, _ in meshes]
        vertices, faces, owners, offset = [], [], [], 0
        for i, (_, positions, triangles) in enumerate(meshes):
            vertices.append(positions)
            faces.append(triangles + offset)
            owners.append(np.full(len(triangles), i))
            offset += len(positions)
        self.owners = np.concatenate(owners)
        self.tree = BVHTree.FromPolygons(np.concatenate(vertices).tolist(),
                                         np.concatenate(faces).tolist())

    def cast(self, origin, direction):
        """(point, normal, owner) or None"""
        point, normal, face, _ = self.tree.ray_cast(mathutils.Vector(origin),
                                                    mathutils.Vector(direction))
        return None if face is None else (point, normal, self.owners[face])


def places(world, room, bounds, count, height, clear, rng):
    """Up to `count` points above the floor of the room, `clear` metres from everything."""
    low, high = bounds
    found = []
    for _ in range(60 * count):
        x, y = rng.uniform(low[:2], high[:2])
        z = low[2] + (height if height else rng.uniform(0.3, 2.2))
        down = world.cast((x, y, z), (0, 0, -1))
        if down is None or world.names[down[2]].split(".")[0] != room:
            continue
        if world.tree.find_nearest(mathutils.Vector((x, y, z)), clear)[0] is None:
            found.append((x, y, z))
        if len(found) == count:
            break
    return found


def random_direction(rng):
    z, phi = rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return mathutils.Vector((r * math.cos(phi), r * math.sin(phi), z))


def reached(world, room, bounds, rng, rays=60000, bounces=3):
    """[objects] int: how often paths from inside the room meet each object."""
    hits = np.zeros(len(world.names), np.int64)
    starts = places(world, room, bounds, 200, None, 0.05, rng)
    if not starts:
        raise RuntimeError(f"{room}: no free place above the floor")
    for i in range(rays):
        origin, direction = mathutils.Vector(starts[i % len(starts)]), random_direction(rng)
        for _ in range(bounces):
            hit = world.cast(origin, direction)
            if hit is None:
                break
            point, normal, owner = hit
            hits[owner] += 1
            if normal.dot(direction) > 0:
                normal = -normal
            origin = point + 1e-4 * normal
            direction = (normal + random_direction(rng)).normalized()
    return hits


def grid_directions(yaw, pitch, columns, rows):
    """Directions of a grid of pixels of a 4:3 picture."""
    forward = np.array([math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch),
                        math.sin(pitch)])
    right = np.array([math.sin(yaw), -math.cos(yaw), 0.0])
    up = np.cross(right, forward)
    t = math.tan(YFOV / 2)
    for v in (np.arange(rows) + 0.5) / rows * 2 - 1:
        for u in (np.arange(columns) + 0.5) / columns * 2 - 1:
            d = forward + t * 4 / 3 * u * right - t * v * up
            yield d / np.linalg.norm(d)


def score(world, eye, yaw, pitch):
    """How much furniture a view shows: the sum over objects of the root of their pixels, less what
    stands right before the camera or leads outside."""
    pixels, close, total = {}, 0, 0
    for d in grid_directions(yaw, pitch, 12, 9):
        total += 1
        hit = world.cast(eye, d)
        if hit is None or (hit[0] - mathutils.Vector(eye)).length < 0.9:
            close += 1
            continue
        name = world.names[hit[2]]
        if not any(name.split(".")[1:2] == [part] for part in SHELL):
            pixels[name] = pixels.get(name, 0) + 1
    furniture = sum(math.sqrt(n) for n in pixels.values())
    return furniture - 40 * max(0, close / total - 0.03)


def best_camera(world, room, bounds, rng):
    """(eye [3], yaw, pitch) of the best of some hundred views from eye height."""
    best = None
    for clear in (CLEAR, 0.2, 0.1):
        for eye in places(world, room, bounds, 60, EYE, clear, rng):
            for yaw in np.arange(16) * math.pi / 8:
                value = score(world, eye, yaw, math.radians(-12))
                if best is None or value > best[0]:
                    best = (value, eye, yaw)
        if best:
            return np.array(best[1]), best[2], math.radians(-12)
    raise RuntimeError(f"{room}: no free place at eye height")
