"""Light at points as rays gather it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from lte import _lte
from lte._arguments import depth_number, number, seed_number, whole
from lte._network import Integrator, Model, integrator_word, network_of
from lte._scene import Scene, made_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from lte._arrays import Floats


class Light(NamedTuple):
    """Irradiance at points, W/m²."""

    total: Floats  #: [N, 3], or [lights, N, 3] by lamp
    direct: Floats  #: the share that comes straight from lamps
    indirect: Floats  #: the rest
    stderr: Floats  #: [N, 3], standard error of the total over all lamps
    #: [N] of irradiance(): the root mean square error to expect, bias included; else None
    expected_error: Floats | None = None


def irradiance(scene: Scene, points: ArrayLike, normals: ArrayLike, *,
               integrator: Integrator = "gather", model: Model | None = None,
               spp: int | None = None, error: float | None = None, depth: int = 5,
               seed: int = 0) -> Light:
    """Irradiance at points, on the side of the normals: lte_probe's answers.

    Every call makes irradiance caches, a second or two, and many points take little longer than
    one. `spp` is rays a point, by default 256, of the integrator path 1024. `error` goes with path:
    the relative standard error that it traces to. `model` goes with network, by default lte.
    """
    made = made_of(scene)
    if error is not None and integrator != "path":
        raise ValueError('error goes with integrator="path"')
    from lte._arrays import surface
    at, side = surface(points, normals)
    found = _lte.probe(made, at, side, integrator_word(integrator), network_of(integrator, model),
                       0 if spp is None else whole("spp", spp, 1, 1 << 20),
                       0 if error is None else number("error", error, 1e-6, 1e6),
                       depth_number(depth), seed_number(seed))
    return Light(found["total"], found["direct"], found["total"] - found["direct"],
                 found["stderr"], found["expected_error"])
