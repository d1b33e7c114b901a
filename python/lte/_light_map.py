"""Light maps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from lte import _lte
from lte._arguments import Path, choice, depth_number, number, path_text, seed_number, whole
from lte._network import Integrator, Model, integrator_word, network_of
from lte._scene import Scene, made_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lte._arrays import Floats


class LightMap:
    """Light on a scene's surfaces as a texture, which bake() has made."""

    #: What mask has: nothing, light of its own, light of neighbours, a place in the dark.
    OUTSIDE, LIT, FILLED, DARK = range(4)

    def __init__(self, made: _lte.LightMap) -> None:
        self._made = made
        self.irradiance: Floats = made.irradiance()  #: [H, W, 3], W/m²; row 0 is the top
        self.layers: dict[str, Floats] = made.layers()  #: that irradiance is the sum of
        self.mask: NDArray[np.uint8] = made.mask()  #: [H, W]
        self.expected_error: float = made.expected_error  #: relative
        self.texels_per_metre: float = made.texels_per_metre

    def save(self, folder: Path, *, format: str = "gltf", three: Path = "", bend: float = 0.1,
             max_triangles: int = 1_000_000) -> None:
        """Writes the folder that lte_bake writes. The format three needs three.js, a file.

        bend and max_triangles are of vertex-colors: triangles are cut until linear interpolation
        is off by less than that share of the light, or there are so many. There layers are vertex
        attributes, which vertex_light.json names.
        """
        self._made.save(path_text(folder), choice("format", format, *_lte.bake_formats()),
                        path_text(three), number("bend", bend, 1e-3, 10),
                        whole("max_triangles", max_triangles, 1, 1 << 28))


def bake(scene: Scene, *, texels_per_metre: float = 32, size: int | None = None,
         keep_uvs: bool = False, include: Literal["full", "indirect"] = "full",
         by_light: bool = False, integrator: Integrator = "gather", model: Model | None = None,
         quality: Literal["draft", "preview", "final"] = "preview", time: float | None = None,
         error: float | None = None, probes: str = "", depth: int = 5, seed: int = 0,
         keep_samples: bool = False, since: Path = "", change: float = 0.02,
         progress: bool = False) -> LightMap:
    """A light map, the one that lte_bake makes with flags of these names.

    `size` is the edge of the picture, in the place of texels_per_metre. `time` is in seconds.
    `by_light` makes a layer of each lamp. `probes` are "auto" or "8x4x8", and are saved beside.
    `model` goes with the integrator network, by default lte. `since` is a folder where a bake
    with `keep_samples` was saved: its atlas is taken, and what differs by less than `change`.
    `progress` shows how far it is on standard error, with the notes of lte_bake.
    """
    made = made_of(scene)
    if path_text(since) and size is not None:
        raise _lte.Error("size: since keeps its atlas")
    if not hasattr(_lte, "bake"):
        raise _lte.Error("bake: this package is built without xatlas")
    return LightMap(_lte.bake(
        made, bool(progress), number("texels_per_metre", texels_per_metre, 1e-6, 1e6),
        0 if size is None else whole("size", size, 16, 16384), bool(keep_uvs),
        choice("include", include, "full", "indirect"), bool(by_light), integrator_word(integrator),
        network_of(integrator, model), str(quality),
        0 if time is None else number("time", time, 1e-6, 1e9),
        0 if error is None else number("error", error, 1e-6, 1e6), str(probes), depth_number(depth),
        seed_number(seed), bool(keep_samples), path_text(since), number("change", change, 1e-4, 1)))
