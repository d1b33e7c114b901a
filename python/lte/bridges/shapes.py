"""Triangles of shapes that other programs know as formulas: positions, corners, uv."""

import numpy as np
from numpy.typing import NDArray

Mesh = tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]


def grid(columns: int, rows: int) -> Mesh:
    """The unit square of u and v, at z 0."""
    v, u = np.mgrid[0:rows + 1, 0:columns + 1].reshape(2, -1) / [[rows], [columns]]
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1)
    quads = np.stack([first, first + 1, first + columns + 2, first + columns + 1], 1)
    return np.stack([u, v, 0 * u], 1), quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), \
        np.stack([u, v], 1)


def rectangle() -> Mesh:
    """[-1, 1] in x and y, facing +Z."""
    at, corners, uv = grid(1, 1)
    return at * 2 - [1, 1, 0], corners, uv


def disk(parts: int = 256) -> Mesh:
    """Of radius 1, facing +Z; its area is that of the disk."""
    angle = np.arange(parts) * 2 * np.pi / parts
    radius = np.sqrt(2 * np.pi / parts / np.sin(2 * np.pi / parts))
    rim = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    turn = np.arange(parts)
    corners = np.stack([0 * turn + parts, turn, (turn + 1) % parts], 1)
    at = np.vstack([rim, [[0, 0, 0]]])
    return at, corners, np.vstack([np.stack([0 * angle + 1, angle / (2 * np.pi)], 1), [[0, 0]]])


def sphere(parts: int = 128) -> Mesh:
    """Of radius 1, facing out, its poles at +Z and -Z; its area is that of the sphere."""
    _, corners, uv = grid(parts, parts // 2)
    phi, theta = 2 * np.pi * uv[:, 0], np.pi * uv[:, 1]
    at = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 1)
    corners = corners[:, ::-1]
    a, b, c = (at[corners[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return at * np.sqrt(4 * np.pi / area), corners, uv


def cylinder(parts: int = 256) -> Mesh:
    """Of radius 1 about Z from 0 to 1, without ends, facing out."""
    _, corners, uv = grid(parts, 1)
    phi = 2 * np.pi * uv[:, 0]
    radius = np.pi / parts / np.sin(np.pi / parts)
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), uv[:, 1]], 1), corners, uv


def cube() -> Mesh:
    """[-1, 1] along each axis, facing out."""
    at, corners, uv = rectangle()
    face = at + [0, 0, 1]
    turns = [np.roll(face, k, 1) * s for k in range(3) for s in (1, -1)]
    flips = [corners, corners[:, ::-1]] * 3
    return (np.vstack(turns), np.vstack([4 * i + f for i, f in enumerate(flips)]),
            np.vstack([uv] * 6))


def placed(mesh: Mesh, matrix: NDArray[np.float64]) -> Mesh:
    """By a [4, 4] matrix; what mirrors keeps its front."""
    at, corners, uv = mesh
    if np.linalg.det(matrix[:3, :3]) < 0:
        corners = corners[:, ::-1]
    return at @ matrix[:3, :3].T + matrix[:3, 3], corners, uv
