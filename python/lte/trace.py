"""Light by path tracing alone, without bias."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lte import _lte
from lte._arguments import depth_number, seed_number, whole
from lte._light import Light
from lte._scene import Scene, made_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["irradiance"]


def irradiance(scene: Scene, points: ArrayLike, normals: ArrayLike, *, rays: int = 1024,
               depth: int = 5, seed: int = 0, by_light: bool = False) -> Light:
    """Irradiance at points, on the side of the normals. `by_light`: [lights, N, 3] by lamp.

    Light is linear: what lamps give, dimmed, is the sum of what each gives times its gain.
    """
    made = made_of(scene)
    from lte._arrays import surface
    at, side = surface(points, normals)
    found = _lte.trace(made, at, side, whole("rays", rays, 2, 1 << 20), depth_number(depth),
                       seed_number(seed), bool(by_light))
    return Light(found["direct"] + found["indirect"], found["direct"], found["indirect"],
                 found["stderr"])
