"""Meshes by formula: boxes, rounded boxes, turned and extruded bodies, sheets with openings."""
import math


class Mesh:
    """Points in metres, texture coordinates, triangles; fronts are counter-clockwise."""
    def __init__(self):
        self.points, self.uvs, self.triangles = [], [], []

    def face(self, corners, uvs=None):
        """A convex polygon as a fan."""
        first = len(self.points)
        self.points += corners
        self.uvs += uvs or [(0.0, 0.0)] * len(corners)
        self.triangles += [(first, first + i, first + i + 1) for i in range(1, len(corners) - 1)]
        return self

    def grid(self, rows, uv=(1.0, 1.0)):
        """A sheet through rows of points, each as long as the next; uv counts repetitions."""
        first, width = len(self.points), len(rows[0])
        for i, row in enumerate(rows):
            self.points += row
            self.uvs += [(uv[0] * j / max(width - 1, 1), uv[1] * i / max(len(rows) - 1, 1))
                         for j in range(width)]
        for i in range(len(rows) - 1):
            for j in range(width - 1):
                a = first + i * width + j
                for triangle in ((a, a + 1, a + width + 1), (a, a + width + 1, a + width)):
                    corners = {tuple(round(v, 4) for v in self.points[c]) for c in triangle}
                    if len(corners) == 3:  # none at the poles
                        self.triangles.append(triangle)
        return self

    def __add__(self, other):
        out = Mesh()
        shift = len(self.points)
        out.points, out.uvs = self.points + other.points, self.uvs + other.uvs
        out.triangles = self.triangles + [tuple(c + shift for c in t) for t in other.triangles]
        return out

    def mapped(self, function):
        out = Mesh()
        out.points, out.uvs = [function(*p) for p in self.points], self.uvs
        out.triangles = list(self.triangles)
        return out

    def moved(self, x, y, z):
        return self.mapped(lambda px, py, pz: (px + x, py + y, pz + z))

    def scaled(self, x, y, z):
        return self.mapped(lambda px, py, pz: (px * x, py * y, pz * z))

    def turned(self, degrees):
        """About +y, counter-clockwise from above."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return self.mapped(lambda x, y, z: (c * x + s * z, y, c * z - s * x))

    def tipped(self, degrees):
        """About +z, from x to y."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return self.mapped(lambda x, y, z: (c * x - s * y, s * x + c * y, z))

    def pitched(self, degrees):
        """About +x, from y to z."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return self.mapped(lambda x, y, z: (x, c * y - s * z, s * y + c * z))

    def flipped(self):
        out = self.mapped(lambda x, y, z: (x, y, z))
        out.triangles = [t[::-1] for t in self.triangles]
        return out


def merged(meshes):
    out = Mesh()
    for mesh in meshes:
        out = out + mesh
    return out


def box(low, high, without=""):
    """Sides face outwards; `without` leaves out sides by name: "-x", "+y", ... joined by blanks."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    sides = {
        "-x": [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
        "+x": [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)],
        "-y": [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
        "+y": [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)],
        "-z": [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)],
        "+z": [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
    }
    out = Mesh()
    for name, corners in sides.items():
        if name not in without.split():
            out.face(corners, [(0, 1), (1, 1), (1, 0), (0, 0)])
    return out


def block(size, at=(0, 0, 0)):
    """A box by its size, standing with the middle of its lower side at a place."""
    (w, h, d), (x, y, z) = size, at
    return box((x - w / 2, y, z - d / 2), (x + w / 2, y + h, z + d / 2))


def rounded(size, radius, at=(0, 0, 0), steps=3):
    """`block` with round edges."""
    half = [s / 2 for s in size]
    middle = (at[0], at[1] + half[1], at[2])

    def nodes(h):
        ramp = [radius * k / steps for k in range(steps + 1)]
        return [-h + r for r in ramp] + [h - r for r in reversed(ramp)]

    def pulled(*p):
        core = [min(max(v, radius - h), h - radius) for v, h in zip(p, half)]
        d = [v - c for v, c in zip(p, core)]
        length = math.sqrt(sum(v * v for v in d)) or 1.0
        return tuple(m + c + radius * v / length for m, c, v in zip(middle, core, d))

    out = Mesh()
    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for sign in (-1, 1):
            rows = []
            for u in nodes(half[b]):
                row = []
                for v in nodes(half[a])[::sign]:
                    p = [0.0, 0.0, 0.0]
                    p[axis], p[a], p[b] = sign * half[axis], v, u
                    row.append(pulled(*p))
                rows.append(row)
            out.grid(rows)
    return out


def lathe(profile, segments=24, at=(0, 0, 0), turn=360.0):
    """A profile of (radius, height), upwards along the outside, turned about the y axis."""
    rows = []
    for radius, height in profile:
        angles = [math.radians(turn) * k / segments for k in range(segments + 1)]
        rows.append([(at[0] + radius * math.sin(a), at[1] + height, at[2] + radius * math.cos(a))
                     for a in angles])
    return Mesh().grid(rows)


def cylinder(radius, height, at=(0, 0, 0), segments=20):
    return lathe([(0, 0), (radius, 0), (radius, height), (0, height)], segments, at)


def sphere(radius, at=(0, 0, 0), segments=24):
    """Around a place."""
    half = segments // 2
    angles = [math.pi * (k / half - 0.5) for k in range(half + 1)]
    return lathe([(radius * math.cos(a), radius * math.sin(a)) for a in angles], segments, at)


def torus(radius, tube, at=(0, 0, 0), segments=28):
    ring = [2 * math.pi * k / 12 for k in range(13)]
    return lathe([(radius + tube * math.cos(a), tube * math.sin(a)) for a in ring], segments, at)


def rod(start, end, radius, segments=10):
    """An open tube from place to place."""
    d = [b - a for a, b in zip(start, end)]
    length = math.sqrt(sum(v * v for v in d))
    w = [v / length for v in d]
    aside = (1.0, 0.0, 0.0) if abs(w[0]) < 0.9 else (0.0, 1.0, 0.0)
    u = [w[1] * aside[2] - w[2] * aside[1], w[2] * aside[0] - w[0] * aside[2],
         w[0] * aside[1] - w[1] * aside[0]]
    size = math.sqrt(sum(v * v for v in u))
    u = [v / size for v in u]
    v = [w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]]
    rows = []
    for end_point in (start, end):
        rows.append([tuple(end_point[k] + radius * (math.cos(a) * u[k] + math.sin(a) * v[k])
                           for k in range(3))
                     for a in (2 * math.pi * i / segments for i in range(segments + 1))])
    return Mesh().grid(rows)


def extruded(outline, height):
    """A body of constant outline, (x, z) counter-clockwise from above, on y = 0."""
    out = polygon(outline, height)
    for (x0, z0), (x1, z1) in zip(outline, outline[1:] + outline[:1]):
        out.face([(x0, 0, z0), (x1, 0, z1), (x1, height, z1), (x0, height, z0)])
    return out + polygon(outline, 0.0).flipped()


def polygon(outline, height, uv_m=1.0):
    """A flat polygon that faces up, (x, z) counter-clockwise from above; ears are cut."""
    out = Mesh()
    out.points = [(x, height, z) for x, z in outline]
    out.uvs = [(x / uv_m, z / uv_m) for x, z in outline]
    cross = lambda a, b, c: ((b[0] - a[0]) * -(c[1] - a[1]) + (b[1] - a[1]) * (c[0] - a[0]))
    rest = list(range(len(outline)))
    while len(rest) > 2:
        for i, corner in enumerate(rest):
            before, after = rest[i - 1], rest[(i + 1) % len(rest)]
            a, b, c = outline[before], outline[corner], outline[after]
            inside = [p for p in rest if p not in (before, corner, after) and min(
                cross(a, b, outline[p]), cross(b, c, outline[p]), cross(c, a, outline[p])) >= 0]
            if cross(a, b, c) > 0 and not inside:
                out.triangles.append((before, corner, after))
                rest.pop(i)
                break
        else:
            raise ValueError("not a simple polygon, counter-clockwise from above")
    return out


def sheet(start, end, height, openings=(), depth=0.0, base=0.0):
    """An upright sheet from (x, z) to (x, z) whose front is to the left on the way; openings are
    (from, to, sill, top) along it, with reveals `depth` deep behind."""
    dx, dz = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dz)
    dx, dz = dx / length, dz / length

    def place(s, y, back=0.0):  # the left of (dx, dz), seen from above, is (dz, -dx)
        return (start[0] + s * dx - back * dz, base + y, start[1] + s * dz + back * dx)

    out = Mesh()
    cuts = sorted({0.0, length, *(s for o in openings for s in o[:2])})
    for s0, s1 in zip(cuts, cuts[1:]):
        rows = [(0.0, height)]
        for a, b, low, top in openings:
            if a < (s0 + s1) / 2 < b:
                rows = [part for y0, y1 in rows for part in ((y0, min(y1, low)), (max(y0, top), y1))
                        if part[1] > part[0]]
        for y0, y1 in rows:
            out.face([place(s1, y0), place(s0, y0), place(s0, y1), place(s1, y1)],
                     [(s1, y0), (s0, y0), (s0, y1), (s1, y1)])
    if depth > 0:
        for a, b, low, top in openings:
            ring = [(a, low), (b, low), (b, top), (a, top)]
            for (s0, y0), (s1, y1) in zip(ring, ring[1:] + ring[:1]):
                if y0 == y1 == 0.0:
                    continue  # the floor is there already
                out.face([place(s0, y0, depth), place(s1, y1, depth), place(s1, y1), place(s0, y0)])
    return out


def wave_sheet(width, height, folds, depth, columns=48):
    """A curtain that hangs from y = height to 0, along x around the middle."""
    rows = []
    for i in range(5):
        y = height * (1 - i / 4)
        rows.append([(width * (j / columns - 0.5),
                      y, depth * (0.6 + 0.4 * i / 4) * math.sin(2 * math.pi * folds * j / columns))
                     for j in range(columns + 1)])
    return Mesh().grid(rows)
