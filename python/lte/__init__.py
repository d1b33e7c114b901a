"""Global illumination for scenes of triangles: pictures, and the light at points.

Units are those of the command-line tools: metres; radiance in W sr^-1 m^-2; irradiance in W/m²,
not divided by pi; colors are linear Rec.709. Every answer is a function of its arguments and its
seed, whatever the number of threads.

Light is gathered, path-traced, or what a network has learnt of it.
"""

from __future__ import annotations

import os
import pathlib
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from lte import _lte, trace
from lte._arguments import whole
from lte._data import (Home, configs, generate_dataset, generate_scene, homes, info, read_sample)
from lte._light import Light, irradiance
from lte._light_map import LightMap, bake
from lte._lte import Error
from lte._network import Embedding, Model
from lte._picture import Picture, render
from lte._scene import Camera, Lamp, Lamps, Scene, checked, load
from lte._training import Training, train

if TYPE_CHECKING:
    from lte._viewing import View

__version__: str = _lte.version()
__all__ = ["Camera", "Embedding", "Error", "Home", "Lamp", "Lamps", "Light", "LightMap", "Model",
           "Picture", "Scene", "Training", "bake", "configs", "from_blender", "from_mitsuba",
           "from_usd", "generate_dataset", "generate_scene", "homes", "info", "irradiance",
           "living_room", "load", "read_sample", "render", "set_threads", "set_verbose", "threads",
           "to_mitsuba", "trace", "train", "view"]

_folder = pathlib.Path(__file__).parent
#: A scene that comes with the package.
living_room = _folder / "scenes" / "living_room.glb"


def from_blender(depsgraph: Any = None, **options: Any) -> Scene:
    """The scene that is open in Blender, by default as the viewport shows it. Options as of load().

    For Blender's own Python, or bpy. Shaders that lte lacks are warnings.
    """
    from lte.bridges import blender_scene
    return blender_scene.load(depsgraph, **options)  # type: ignore[no-any-return]


def from_mitsuba(scene: Any, **options: Any) -> Scene:
    """A scene of Mitsuba 3, as a file, a dict, or loaded. The options are those of load().

    Needs Mitsuba, in an RGB variant; chooses scalar_rgb if none is set. Raises ValueError for a
    shape or lamp that lte lacks; materials that it lacks are warnings.
    """
    from lte.bridges import mitsuba_scene
    return mitsuba_scene.load(scene, **options)  # type: ignore[no-any-return]


def to_mitsuba(scene: Scene) -> dict[str, Any]:
    """The scene for mitsuba.load_dict(): shapes, lamps, sky, cameras; an integrator goes beside.

    Needs Mitsuba, in an RGB variant; chooses scalar_rgb if none is set. What Mitsuba has otherwise
    is a warning: normal maps, pictures of roughness, ranges of lamps. A metal's masking is
    Mitsuba's.
    """
    from lte.bridges import to_mitsuba as bridge
    return bridge.export(checked(scene))


def from_usd(stage: Any, **options: Any) -> Scene:
    """A stage of USD, as a file or opened, in metres and with Y up. Options as of load().

    Needs usd-core. Prims that lte lacks are warnings.
    """
    from lte.bridges import usd_stage
    return usd_stage.load(stage, **options)  # type: ignore[no-any-return]


def view(scene: Scene) -> View:
    """Serves the page of lte_view: `with lte.view(scene) as page: print(page.url)`."""
    from lte._viewing import View
    return View(checked(scene))


def set_threads(count: int) -> None:
    """Threads of all later calls; 0 for all processors."""
    _lte.set_threads(whole("count", count, 0, 1 << 20))


def threads() -> int:
    return int(_lte.threads())


def set_verbose(verbose: bool) -> None:
    """Whether notes go to standard error, beside warnings."""
    _lte.set_verbose(bool(verbose))


def _find_denoiser() -> None:
    """Has pictures denoised by PyPI's pyoidn where that is installed."""
    found = None if "LTE_OIDN" in os.environ else find_spec("pyoidn")
    for folder in (found and found.submodule_search_locations) or ():
        library = pathlib.Path(folder) / "oidn" / "lib"
        if library.is_dir():
            os.environ["LTE_OIDN"] = str(library)


_find_denoiser()
_lte.set_assets(str(_folder))
