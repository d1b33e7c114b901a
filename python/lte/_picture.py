"""Pictures."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal

from lte import _lte
from lte._arguments import Path, depth_number, number, path_text, seed_number, whole
from lte._network import Integrator, Model, integrator_word, network_of
from lte._scene import Camera, Scene, made_of

if TYPE_CHECKING:
    from lte._arrays import Floats


class Picture:
    """A picture that render() has made, with its layers. `np.asarray(picture)` is its color."""

    def __init__(self, made: _lte.Picture) -> None:
        self._made = made
        self.color: Floats = made.color()  #: [H, W, 3] linear; of output "depth" [H, W], metres
        self.layers: dict[str, Floats] = made.layers()  #: albedo, normal, depth, emission, ...
        self.camera: dict[str, Any] = json.loads(made.camera)  #: as in a camera file
        self.passes: int = made.passes  #: that were made
        self.denoiser: str = made.denoiser  #: what took noise away, or ""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        return self.color.astype(dtype or self.color.dtype, copy=bool(copy))

    def exposure(self, ev: float = 0) -> float:
        """The factor that save() shows light by, chosen by the picture."""
        return self._made.exposure(None, number("ev", ev, -100, 100))

    def save(self, path: Path, *, exposure: float | None = None, ev: float = 0,
             tone: str = "linear") -> None:
        """Writes a .png, exposed, or an .exr with all layers: the file that lte_render writes."""
        factor = None if exposure is None else number("exposure", exposure, 1e-30, 1e30)
        self._made.save(path_text(path), factor, number("ev", ev, -100, 100), str(tone))


def render(scene: Scene, *, size: tuple[int, int] = (512, 512), camera: str | int | Camera = "",
           integrator: Integrator = "gather", model: Model | None = None,
           quality: Literal["draft", "preview", "final"] = "final", time: float | None = None,
           spp: int | None = None, output: str = "full", depth: int = 5, seed: int = 0,
           denoise: bool = True) -> Picture:
    """A picture, the one that lte_render makes with flags of these names.

    `camera` is a Camera, or the name or number of one of the scene's, "auto", or a camera file; by
    default the scene's first, else the automatic one. `time` is in seconds. `spp` goes with the
    integrator path, `model` with network, by default lte.
    """
    made = made_of(scene)
    try:
        width, height = size
    except (TypeError, ValueError):
        raise ValueError(f"size: expected (width, height), got {size!r}") from None
    if spp is not None and integrator != "path":
        raise ValueError('spp goes with integrator="path": the others take quality or time')
    if isinstance(camera, Camera):
        word, given = "", _camera(camera)
    else:
        word, given = str(camera), None
    return Picture(_lte.render(
        made, whole("size: width", width, 1, 65536), whole("size: height", height, 1, 65536), word,
        given, integrator_word(integrator), network_of(integrator, model), str(quality),
        0 if time is None else number("time", time, 1e-6, 1e9),
        0 if spp is None else whole("spp", spp, 1, 1 << 20), str(output), depth_number(depth),
        seed_number(seed), bool(denoise)))


def _camera(camera: Camera) -> tuple[Any, ...]:
    def triple(name: str, values: Any) -> tuple[float, float, float]:
        try:
            x, y, z = (float(value) for value in values)
        except (TypeError, ValueError):
            raise ValueError(f"camera: {name}: expected three numbers, got {values!r}") from None
        return x, y, z

    up = None if camera.up is None else triple("up", camera.up)
    return (triple("origin", camera.origin), triple("target", camera.target), up,
            number("camera: vfov", camera.vfov, 0, 180))
