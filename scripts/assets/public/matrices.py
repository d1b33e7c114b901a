"""4 x 4 matrices as rows, angles in degrees."""
import math

IDENTITY = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
Z_UP = ((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1))  # z up to y up


def product(*matrices):
    out = IDENTITY
    for m in matrices:
        out = tuple(tuple(sum(out[i][k] * m[k][j] for k in range(4)) for j in range(4))
                    for i in range(4))
    return out


def translation(x, y, z):
    return ((1, 0, 0, x), (0, 1, 0, y), (0, 0, 1, z), (0, 0, 0, 1))


def scaling(x, y, z):
    return ((x, 0, 0, 0), (0, y, 0, 0), (0, 0, z, 0), (0, 0, 0, 1))


def rotation(axis, degrees):
    """About an axis, right-handed."""
    length = math.sqrt(sum(v * v for v in axis))
    x, y, z = (v / length for v in axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    k = 1 - c
    return ((c + x * x * k, x * y * k - z * s, x * z * k + y * s, 0),
            (y * x * k + z * s, c + y * y * k, y * z * k - x * s, 0),
            (z * x * k - y * s, z * y * k + x * s, c + z * z * k, 0), (0, 0, 0, 1))


def apply(m, point):
    return tuple(sum(m[i][k] * point[k] for k in range(3)) + m[i][3] for i in range(3))


def mirrors(m):
    (a, b, c), (d, e, f), (g, h, i) = (row[:3] for row in m[:3])
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0


def moved(mesh, m):
    """A mesh under a matrix; what mirrors turns the triangles too, so that fronts stay fronts."""
    out = mesh.mapped(lambda x, y, z: apply(m, (x, y, z)))
    return out.flipped() if mirrors(m) else out
