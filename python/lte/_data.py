"""Generated scenes, and training data of them."""

from __future__ import annotations

import json
import pathlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal

from lte import _lte
from lte._arguments import Path, choice, path_text, seed_number, whole
from lte._scene import Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Configurations of data sets and of training: `configs / "train" / "homes_small.yaml"`.
configs = pathlib.Path(__file__).parent / "configs"


def generate_scene(generator: Literal["boxes", "homes", "wild"] = "homes", *,
                   seed: int = 1) -> Scene:
    """A procedural scene with furniture and lamps."""
    word = choice("generator", generator, "boxes", "homes", "wild")
    return Scene(_lte.generate_scene(word, seed_number(seed)))


class Home(Scene):
    """A furnished home with lamps and, mostly, daylight, made by homes()."""

    def __init__(self, config: str, seed: int, number: int) -> None:
        self._of = config, seed, number
        super().__init__(_lte.make_scene(config, [f"seed={seed}"], number))

    def bake(self, *, queries: int | None = None, rays: int | None = None,
             set: dict[str, object] | None = None) -> dict[str, NDArray[Any]]:
        """Points of the home with the light there, as arrays: what read_sample() reads of the file
        that `lte_datagen generate` makes of it.

        `queries` is points with ground truth, `rays` paths for each; these and `set` override keys
        of the config, such as {"views.count": 0}.
        """
        config, seed, number = self._of
        keys: dict[str, object] = {"seed": seed}
        if queries is not None:
            keys["query_points"] = whole("queries", queries, 1, 1 << 40)
        if rays is not None:
            keys["rays"] = whole("rays", rays, 1, 1 << 40)
        return dict(_lte.bake_sample(self._made, config, _overrides({**keys, **(set or {})}),
                                     number))


def homes(*, seed: int = 1, count: int = 1,
          config: Path = configs / "data" / "homes.yaml") -> Iterator[Home]:
    """The first homes of a data set of this seed: the scenes of `lte_datagen generate`."""
    file, of, number = path_text(config), seed_number(seed), whole("count", count, 0, 1 << 40)
    return (Home(file, of, i) for i in range(number))


def generate_dataset(config: Path, out: Path, *, set: dict[str, object] | None = None,
                     resume: bool = False) -> dict[str, int]:
    """Makes training data as `lte_datagen generate` does; `set` overrides keys of the config.

    The files are safetensors. Ctrl-C leaves whole scenes alone, and `resume` goes on.
    """
    return dict(_lte.generate_dataset(path_text(config), path_text(out), _overrides(set or {}),
                                      bool(resume)))


def read_sample(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of one scene of a data set, as docs/dataset.md has them.

    Raises lte.Error, which names the file, if it is missing, damaged, or no safetensors.
    """
    return dict(_lte.read_sample(path_text(path)))


def info(path: Path | None = None) -> dict[str, Any]:
    """What `lte info` prints: of this package its version, instruction set, formats, models and
    LibTorch's half; of a scene, a sample or a data set what it holds.
    """
    from lte._torch import Torch
    found = _lte.about(Torch().program) if path is None else _lte.describe(path_text(path))
    return dict(json.loads(found))


def _overrides(keys: dict[str, object]) -> list[str]:
    return [f"{key}={value}" for key, value in keys.items()]
